"""What is planted in a simulated study: how each outcome depends on the condition, and how much it varies."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from studykit.participant.movement import LARGEST_ERROR_M


class _Planted(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Response(_Planted):
    """One outcome: a value for light, easy dances without smooth joins, and what each other level adds."""

    base: float = Field(description="value in the condition light-easy-off")
    intense: float = Field(default=0.0, description="added in intense dances")
    hard: float = Field(default=0.0, description="added in hard dances")
    on: float = Field(default=0.0, description="added where joins are smooth")
    person_sd: float = Field(ge=0.0, description="standard deviation between people")
    trial_sd: float = Field(ge=0.0, description="standard deviation between one person's trials")

    def expected(self, condition: str) -> float:
        """Give the value of the average person in a condition.

        Parameters
        ----------
        condition : str
            Name of the condition, such as "intense-hard-on".

        Returns
        -------
        float

        Examples
        --------
        >>> Response(base=0.3, intense=0.5, person_sd=0.1, trial_sd=0.1).expected("intense-easy-on")
        0.8
        """
        levels = condition.split("-")
        return self.base + sum(
            added
            for level, added in (("intense", self.intense), ("hard", self.hard), ("on", self.on))
            if level in levels
        )

    def draw(self, condition: str, person: float, rng: np.random.Generator) -> float:
        """Draw the value of one trial.

        Parameters
        ----------
        condition : str
            Name of the condition.
        person : float
            How many standard deviations this person differs from the average one.
        rng : numpy.random.Generator
            Differences between trials; one number is used, whatever the condition.

        Returns
        -------
        float
        """
        return self.expected(condition) + self.person_sd * person + self.trial_sd * float(rng.normal())


class Enjoyment(_Planted):
    """The enjoyment scale, asked once: it has no conditions."""

    item_mean: float = Field(ge=1.0, le=7.0, description="mean over items and people aimed at, 1 to 7")
    person_sd: float = Field(ge=0.0, description="standard deviation between people")
    item_sd: float = Field(ge=0.0, description="standard deviation between one person's items")


class Effects(_Planted):
    """Everything that is planted in a simulated study; an analysis must never read it."""

    name: str = Field(description="what this set of effects is called")
    effort: Response = Field(description="share of the heart-rate reserve that a dance asks for, 0 to 1")
    movement_error: Response = Field(description="mean distance of a dancer's joints from the guide, m")
    smoothness: Response = Field(description="rating of smoothness before rounding, 1 to 7")
    enjoyment: Enjoyment

    @field_validator("movement_error")
    @classmethod
    def _can_be_danced(cls, error: Response) -> Response:
        largest_m = error.base + sum(max(added, 0.0) for added in (error.intense, error.hard, error.on))
        if largest_m > LARGEST_ERROR_M:
            raise ValueError(
                f"{largest_m:.3f} m in one condition: a dancer can be {LARGEST_ERROR_M} m off on average"
            )
        return error


PAPER = Effects(
    name="paper",
    effort=Response(base=0.30, intense=0.52, hard=0.06, person_sd=0.04, trial_sd=0.035),
    movement_error=Response(
        base=0.055, intense=0.012, hard=0.044, on=-0.008, person_sd=0.009, trial_sd=0.006
    ),
    smoothness=Response(base=3.9, on=1.1, person_sd=0.8, trial_sd=0.9),
    enjoyment=Enjoyment(item_mean=5.95, person_sd=0.6, item_sd=0.8),
)
"""Effects in the direction and of about the size that the published study reports."""

NONE = Effects(
    name="none",
    effort=Response(base=0.59, person_sd=0.04, trial_sd=0.035),
    movement_error=Response(base=0.079, person_sd=0.009, trial_sd=0.006),
    smoothness=Response(base=4.45, person_sd=0.8, trial_sd=0.9),
    enjoyment=Enjoyment(item_mean=4.0, person_sd=0.6, item_sd=0.8),
)
"""The same people and the same chance, but no condition differs from another."""

PLANTED: dict[str, Effects] = {effects.name: effects for effects in (PAPER, NONE)}
"""The sets of effects that have a name."""
