"""The whole study on paper, as an experimenter writes it in one file."""

from __future__ import annotations

from itertools import product
from math import ceil, floor
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from studykit.core.errors import InputError, nearest
from studykit.core.provenance import sha256_of_value
from studykit.protocol.analysis_plan import (
    AnalysisPlan,
    CorrelationPlan,
    CurvePlan,
    EquivalencePlan,
    TestPlan,
)
from studykit.protocol.condition import Condition, Intensity, Transition, Variety
from studykit.protocol.part import Part, refuse_repeats

Compared = TestPlan | CorrelationPlan | EquivalencePlan | CurvePlan

Blinded = Literal["nobody", "participant", "participant and analyst"]
"""Who does not know which condition is danced."""

SEGMENT_S = 4.0
"""Length of one piece of the dance library, in seconds; every dance is a whole number of them."""


class Study(Part):
    """Name and size of the study."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$", description="short name, used in file names")
    title: str = Field(min_length=1, description="what the study is about, in one line")
    participants: int = Field(ge=1, le=999, description="how many people take part")
    seed: int = Field(ge=0, description="any whole number; draws lots for who gets which order")
    blinded: Blinded | None = Field(
        default=None,
        description='who does not know which condition is danced: "nobody", "participant" or "participant '
        'and analyst"',
    )


class Conditions(Part):
    """The three factors and their levels; every combination is one condition, that is, one dance."""

    intensity: tuple[Intensity, ...] = Field(min_length=1, description="how much energy a dance has")
    variety: tuple[Variety, ...] = Field(
        min_length=1, description="how much its parts differ from each other"
    )
    transition: tuple[Transition, ...] = Field(
        min_length=1, description='whether its parts are joined smoothly ("on") or left to chance ("off")'
    )

    @field_validator("intensity", "variety", "transition")
    @classmethod
    def _no_repeats(cls, levels: tuple[str, ...]) -> tuple[str, ...]:
        refuse_repeats(levels, what="level")
        return levels


class Order(Part):
    """In which order each participant dances the conditions."""

    design: Literal["williams"] = Field(
        description='"williams": a square in which every condition follows every other equally often'
    )
    labels: tuple[str, ...] = Field(
        min_length=2,
        description="the conditions that stand for 1, 2, 3 ... of the square; "
        "in this order the extra rows are balanced too",
    )
    extra_rows: tuple[int, ...] = Field(
        description="rows of the square used once more if the participants do not fill whole squares"
    )


class IntensityTargets(Part):
    """Energy aimed at: a percentile of the energy of random dances from the same library."""

    light: float = Field(ge=0.0, le=100.0, description="percentile for light dances")
    intense: float = Field(ge=0.0, le=100.0, description="percentile for intense dances")
    tolerance: float = Field(
        gt=0.0,
        le=1.0,
        description="how sharply the search aims, as a share of the target; dances found are within 0.05",
    )

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        _refuse_disorder("light", self.light, "intense", self.intense)
        return self


class VarietyTargets(Part):
    """Variety aimed at: a share of the median distance between unrelated pieces of the library."""

    easy: float = Field(gt=0.0, le=2.0, description="easy dances return to a few figures")
    hard: float = Field(gt=0.0, le=2.0, description="hard dances hardly repeat anything")
    tolerance: float = Field(gt=0.0, le=1.0, description="share of the gap between easy and hard")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        _refuse_disorder("easy", self.easy, "hard", self.hard)
        return self


class Weights(Part):
    """How much each goal counts while a dance is searched for (lambda of Eq. 1)."""

    duration: float = Field(ge=0.0, description="to last as long as asked")
    transition: float = Field(ge=0.0, description='to join smoothly; 0 in conditions with transition "off"')
    variety: float = Field(ge=0.0, description="to repeat as much or as little as asked")
    linear: float = Field(ge=0.0, description="to have the energy asked for, in moving through space")
    rotational: float = Field(ge=0.0, description="to have the energy asked for, in turning the limbs")


class SparePlan(Part):
    """Joints that every dance of the study spares."""

    joints: tuple[str, ...] = Field(
        min_length=1, description='joints by name, such as "right_elbow"; all beyond them are spared too'
    )
    weight: float = Field(
        ge=0.0, le=1.0, description="0 to 1: how much these joints may do, as a share (a of Eq. 11)"
    )
    speed_percentile: float = Field(
        gt=0.0, le=100.0, description="they stay below this percentile of what they do in the library"
    )
    cost_weight: float = Field(ge=0.0, description="how much it counts that they do little")


class DancePlan(Part):
    """What the dances aim at."""

    duration_s: float = Field(
        gt=0.0, le=600.0, description="length of every dance in seconds, a multiple of 4"
    )
    preset: Literal["studykit", "paper"] = Field(
        description='how goals are measured: "studykit", or "paper" for the literal published formulas'
    )
    intensity: IntensityTargets
    variety: VarietyTargets
    weights: Weights
    spare: SparePlan | None = None

    @field_validator("duration_s")
    @classmethod
    def _whole_segments(cls, duration_s: float) -> float:
        if duration_s % SEGMENT_S:
            below, above = floor(duration_s / SEGMENT_S) * SEGMENT_S, ceil(duration_s / SEGMENT_S) * SEGMENT_S
            raise InputError(
                f"a dance of {duration_s:g} s is not made of whole pieces of {SEGMENT_S:g} s",
                remedy=f"write {below:.1f} or {above:.1f}" if below else f"write {above:.1f}",
            )
        return duration_s


class SessionPlan(Part):
    """What happens during a visit and how long it takes; watching and dancing last as long as the dance."""

    calibrate_s: float = Field(
        ge=0.0, description="seconds of standing still while the camera learns the body"
    )
    baseline_s: float = Field(ge=0.0, description="seconds of sitting, for the resting heart rate")
    train_s: float = Field(ge=0.0, description="seconds to get to know the system")
    rest_s: float = Field(ge=0.0, description="seconds of rest after each condition")
    watch_repetitions: int = Field(
        ge=0, le=20, description="how often a dance is watched before it is danced"
    )
    perform_repetitions: int = Field(ge=1, le=20, description="how often it is danced")


class HeartRatePlan(Part):
    """How the heart rate is judged."""

    maximum: Literal["tanaka", "fox"] = Field(
        description='highest heart rate for an age: "tanaka" 208 - 0.7 age, "fox" 220 - age'
    )
    vigorous_fraction: float = Field(
        gt=0.0, le=1.0, description="exercise is vigorous at or above this share of the maximum"
    )
    window: Literal["perform", "perform+30"] = Field(
        description='what is averaged: "perform", or "perform+30" for 30 s longer, as the heart lags behind'
    )
    longest_gap_s: float = Field(
        gt=0.0, description="seconds; where the belt was silent for longer, the silence counts for nothing"
    )


class MovementPlan(Part):
    """How a dancer is compared with the guide."""

    band_s: float = Field(
        gt=0.0, le=10.0, description="seconds by which a dancer may be early or late and still be matched"
    )


class Smoothness(Part):
    """The question about smoothness, asked after every condition."""

    after: Literal["condition"] = Field(description="when it is asked")
    scale: tuple[Literal[1], Literal[7]] = Field(description="1 strongly disagree ... 7 strongly agree")
    text: str = Field(min_length=1, description="the sentence that is rated")


class Paces(Part):
    """The 18 items of the Physical Activity Enjoyment Scale, asked at the end."""

    after: Literal["session"] = Field(description="when it is asked")
    scale: tuple[Literal[1], Literal[7]] = Field(description="1 left pole ... 7 right pole")


class Questionnaires(Part):
    """What people are asked."""

    smoothness: Smoothness
    paces: Paces


class StudyProtocol(Part):
    """The protocol of a study: everything that defines it, from the conditions to the tests.

    Read one from a file with :func:`studykit.io.protocol_file.read_protocol`; two protocols with equal
    content have the same `sha256`.
    """

    study: Study
    conditions: Conditions
    order: Order
    dance: DancePlan
    session: SessionPlan
    heart_rate: HeartRatePlan
    movement: MovementPlan
    questionnaires: Questionnaires
    analysis: AnalysisPlan

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._check_labels()
        self._check_extra_rows()
        for kind in ("tests", "correlations", "equivalences", "curves"):
            self._check_plan(kind, getattr(self.analysis, kind) or ())
        return self

    def _check_labels(self) -> None:
        factors = self.conditions
        expected = [
            f"{intensity}-{variety}-{transition}"
            for intensity, variety, transition in product(
                factors.intensity, factors.variety, factors.transition
            )
        ]
        refuse_repeats(self.order.labels, what="condition", where="order.labels")
        for name in self.order.labels:
            if name not in expected:
                raise InputError(
                    f'"{name}" is no combination of the levels in [conditions]',
                    where="order.labels",
                    remedy=nearest(
                        name, [label for label in expected if label not in self.order.labels] or expected
                    ),
                )
        for name in expected:
            if name not in self.order.labels:
                raise InputError(
                    f'the condition "{name}" is missing', where="order.labels", remedy=f'add "{name}"'
                )

    def _check_extra_rows(self) -> None:
        rows, extra = len(self.order.labels), self.order.extra_rows
        refuse_repeats(map(str, extra), what="row", where="order.extra_rows")
        for row in extra:
            if not 1 <= row <= rows:
                raise InputError(
                    f"the square has no row {row}",
                    where="order.extra_rows",
                    remedy=f"use rows from 1 to {rows}",
                )
        left = self.study.participants % rows
        if left > len(extra):
            below = self.study.participants - left
            whole = f"{below} or {below + rows}" if below else f"{rows}"
            raise InputError(
                f"{self.study.participants} participants leave {left} after whole squares of {rows}, "
                f"but only {len(extra)} rows are named for them",
                where="order.extra_rows",
                remedy=f"name {left} rows, or set participants to {whole}",
            )

    def _check_plan(self, kind: str, plans: tuple[Compared, ...]) -> None:
        for number, plan in enumerate(plans):
            for name in plan.conditions:
                if name not in self.order.labels:
                    raise InputError(
                        f'"{name}" is no condition of this study',
                        where=f"analysis.{kind}.{number}.conditions",
                        remedy=nearest(name, self.order.labels),
                    )

    def conditions_list(self) -> tuple[str, ...]:
        """Give the names of all conditions, in the order of the square's numbers."""
        return self.order.labels

    def condition(self, name: str) -> Condition:
        """Give one condition of this study by its name.

        Raises
        ------
        InputError
            If the study has no such condition.
        """
        if name not in self.order.labels:
            raise InputError(
                f'"{name}" is no condition of this study', remedy=nearest(name, self.order.labels)
            )
        return Condition.parse(name)

    def with_participants(self, participants: int) -> StudyProtocol:
        """Give the same study for another number of people.

        Parameters
        ----------
        participants : int
            How many, 1 or more. Where the extra rows do not suffice, the remaining rows follow in order.

        Returns
        -------
        StudyProtocol
        """
        rows = range(1, len(self.order.labels) + 1)
        missing = [row for row in rows if row not in self.order.extra_rows]
        short = max(0, participants % len(rows) - len(self.order.extra_rows))
        values = self.model_dump(mode="json")
        values["study"]["participants"] = participants
        values["order"]["extra_rows"] = [*self.order.extra_rows, *missing[:short]]
        return StudyProtocol.model_validate(values)

    @property
    def sha256(self) -> str:
        """Digest of the content, the same for equal protocols however their files are laid out."""
        return sha256_of_value(self.model_dump(mode="json", exclude_none=True))


def _refuse_disorder(low_name: str, low: float, high_name: str, high: float) -> None:
    if low >= high:
        raise InputError(
            f"{low_name} ({low:g}) is not below {high_name} ({high:g})",
            where=high_name,
            remedy=f"give {high_name} the larger number",
        )
