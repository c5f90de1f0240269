"""How the paper is read: studykit's reading, and the printed one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from studykit.choreography.rjmcmc.schedule import Schedule
from studykit.motion.blending import Blend

Metric = Literal["euclidean_z", "cosine"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Preset:
    """One reading of the paper's formulas and search.

    Parameters
    ----------
    name : str
        What dances are marked with.
    variety : {"euclidean_z", "cosine"}
        Metric between segments: Eq. 5 as printed is "cosine".
    transition : {"mean_of_costs", "printed"}
        Form of Eq. 4.
    intensity : {"log", "absolute"}
        Scale of Eq. 9 and 12.
    moves : {"anywhere", "at_end"}
        Where a new segment is inserted.
    acceptance : {"exact", "metropolis"}
        "exact" keeps the search reversible; "metropolis" is Eq. 13 alone.
    copies : bool
        Whether segments already in the dance are proposed again where the variety asked for needs repetition,
        and never where it does not.
    schedule : Schedule
        Temperatures and tolerances over the iterations.
    chains : int
        Searches from different beginnings, of which the best is taken.
    reorders : bool
        Whether the segments found are put into the best order at the end.
    blend : {"offset", "bridge"}
        How segments are joined; see `motion.blending.joined`.
    is_reached : bool
        Whether its targets can be reached: a dance that misses them is then an error, not a result.
    """

    name: str
    variety: Metric
    transition: Literal["mean_of_costs", "printed"]
    intensity: Literal["log", "absolute"]
    moves: Literal["anywhere", "at_end"]
    acceptance: Literal["exact", "metropolis"]
    copies: bool
    schedule: Schedule
    chains: int
    reorders: bool
    blend: Blend
    is_reached: bool


STUDYKIT = Preset(
    name="studykit",
    variety="euclidean_z",
    transition="mean_of_costs",
    intensity="log",
    moves="anywhere",
    acceptance="exact",
    copies=True,
    schedule=Schedule.geometric(iterations=8_000, start=0.3, end=0.002, start_width=6.0),
    chains=8,
    reorders=True,
    blend="offset",
    is_reached=True,
)
"""The reading whose targets are reached."""

PAPER = Preset(
    name="paper",
    variety="cosine",
    transition="printed",
    intensity="absolute",
    moves="at_end",
    acceptance="metropolis",
    copies=False,
    schedule=Schedule.paper(),
    chains=1,
    reorders=False,
    blend="bridge",
    is_reached=False,
)
"""The printed formulas, constants and search, but for a bound on the length, without which it diverges."""

PRESETS = {preset.name: preset for preset in (STUDYKIT, PAPER)}
