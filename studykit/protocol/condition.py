"""One condition of the study: how intense, how varied and whether its joins are smooth."""

from __future__ import annotations

from itertools import product
from typing import Literal, get_args

from studykit.core.errors import InputError, nearest
from studykit.protocol.part import Part

Intensity = Literal["light", "intense"]
Variety = Literal["easy", "hard"]
Transition = Literal["on", "off"]

FACTORS: tuple[str, ...] = ("intensity", "variety", "transition")
"""The three factors of the design, in the order in which a condition's name gives their levels."""


class Condition(Part):
    """One combination of the three factors, written like ``light-easy-on``.

    Parameters
    ----------
    intensity : {"light", "intense"}
        How much energy the dance has.
    variety : {"easy", "hard"}
        How much the parts of the dance differ from each other.
    transition : {"on", "off"}
        Whether the dance was made to join its parts smoothly.

    Examples
    --------
    >>> Condition.parse("light-hard-off").variety
    'hard'
    >>> str(Condition(intensity="intense", variety="easy", transition="on"))
    'intense-easy-on'
    """

    intensity: Intensity
    variety: Variety
    transition: Transition

    @classmethod
    def parse(cls, name: str) -> Condition:
        """Read a condition from its name.

        Parameters
        ----------
        name : str
            Three levels joined by hyphens.

        Raises
        ------
        InputError
            If no condition has this name; it says which one is spelt most like it.
        """
        if name not in ALL_CONDITIONS:
            raise InputError(f'"{name}" is no condition', remedy=nearest(name, ALL_CONDITIONS))
        return cls.model_validate(dict(zip(FACTORS, name.split("-"), strict=True)))

    def __str__(self) -> str:
        return f"{self.intensity}-{self.variety}-{self.transition}"


ALL_CONDITIONS: tuple[str, ...] = tuple(
    "-".join(levels) for levels in product(get_args(Intensity), get_args(Variety), get_args(Transition))
)
"""The names of all eight conditions."""
