"""Takes: one dancer's recording each, on their way into a library."""

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
    partners : tuple of str
        Names of the takes danced together with this one, on the same time line.
    notes : str
        What had to be mended to read it.
    """

    data_set: str
    performer: str
    genre: str
    licence: str
    is_synthetic: bool
    sha256: str
    partners: tuple[str, ...] = ()
    notes: str = ""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Take:
    """One recording: its name within the data set, the movement on studykit's body, and its source."""

    name: str
    motion: Motion
    source: TakeSource
