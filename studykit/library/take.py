"""Takes: one recording each, on their way into a library."""

from __future__ import annotations

from dataclasses import dataclass

from studykit.motion.motion import Motion


@dataclass(frozen=True, kw_only=True, slots=True)
class TakeSource:
    """Where a take comes from and what may be done with it.

    Parameters
    ----------
    data_set : str
        Name of the data set.
    performer : str
        Who danced.
    genre : str
        What was danced.
    licence : str
        The terms of use.
    is_synthetic : bool
        Whether studykit made the movement up.
    sha256 : str
        Digest of the file, or of the recipe of a synthetic take.
    """

    data_set: str
    performer: str
    genre: str
    licence: str
    is_synthetic: bool
    sha256: str


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Take:
    """One recording: its name within the data set, the movement and its source."""

    name: str
    motion: Motion
    source: TakeSource
