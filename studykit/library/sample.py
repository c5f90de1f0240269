"""The library that needs no data: synthetic takes of graded intensity, as many as asked for."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.core.seeding import stream
from studykit.io.datasets.take import Take, TakeSource
from studykit.library import store, synthesis
from studykit.library.build import write_library
from studykit.motion.motion import Motion

DATA_SET: Final = "studykit-synthetic"
"""Name of the data set; says that nobody danced it."""
LICENCE: Final = "CC0-1.0"
"""What studykit makes up is free for any use."""
PHRASES: Final = 10
"""Segments in a whole take of 40 s."""
LEAST_ENERGY: Final = 0.07
"""Linear energy of a segment of the easiest take, J per kg of body mass, summed over its poses."""
ENERGY_RANGE: Final = 8.0
"""How many times more the hardest take asks for; both ends are met in recorded salsa."""

_SPREAD = 0.15  # of the logarithm of the energy among the segments of a take
_GOLDEN = 0.6180339887498949  # steps by this share of the range fill it evenly, however many takes there are


def takes(count_segments: int, seed: int) -> Iterator[Take]:
    """Make up takes, one after the other, until they hold as many segments as asked for.

    Parameters
    ----------
    count_segments : int
        Segments of 4 s wanted, 1 or more.
    seed : int
        The same seed gives the same takes; a larger count only adds takes behind.

    Yields
    ------
    Take
        40 s of one style at one tempo and intensity; the last may be shorter.

    Raises
    ------
    InputError
        If fewer than one segment is asked for.

    Examples
    --------
    >>> [(take.name, round(take.motion.duration_s, 3)) for take in takes(12, seed=1)]
    [('synthetic-00000', 40.0), ('synthetic-00001', 8.0)]
    """
    if count_segments < 1:
        raise InputError(
            f"{count_segments} segments are asked for", where="segments", remedy="ask for 1 or more"
        )
    for first in range(0, count_segments, PHRASES):
        yield _take(first // PHRASES, seed, min(PHRASES, count_segments - first))


def _take(number: int, seed: int, phrases: int) -> Take:
    """Make up one take from its number and seed alone; a shorter one is the beginning of the whole."""
    style = synthesis.STYLES[number % len(synthesis.STYLES)]
    start = stream(seed, "synthetic", "intensity").random()
    grade = (start + _GOLDEN * number) % 1.0
    rng = stream(seed, "synthetic", "take", number)
    energies = LEAST_ENERGY * ENERGY_RANGE**grade * rng.lognormal(0.0, _SPREAD, PHRASES)
    whole = synthesis.dance(synthesis.figures(style, PHRASES, rng), energies)
    frames = round(phrases * synthesis.PHRASE_S * whole.frame_rate_hz)
    return Take(
        name=f"synthetic-{number:05d}",
        motion=Motion(
            skeleton=whole.skeleton,
            rotations=whole.rotations[:frames],
            root_positions=whole.root_positions[:frames],
            frame_rate_hz=whole.frame_rate_hz,
        ),
        source=TakeSource(
            data_set=DATA_SET,
            performer="nobody (synthetic)",
            genre=style.name,
            licence=LICENCE,
            is_synthetic=True,
            sha256=sha256_of_value({"data_set": DATA_SET, "seed": seed, "take": number, "phrases": phrases}),
        ),
    )


def make_sample(
    out: str | Path, *, segments: int = 240, seed: int = 0, progress: Progress = silent
) -> DanceLibrary:
    """Make up a whole library, or open it if this very one is there already.

    Parameters
    ----------
    out : str or Path
        The folder to make.
    segments : int
        How many segments of 4 s.
    seed : int
        Repeats the library.
    progress : Progress
        Told of each take.

    Raises
    ------
    InputError
        If something else is in the folder, or it cannot be written.
    """
    folder = Path(out)
    if (folder / "manifest.json").exists():
        there = store.read_manifest(folder)
        if (there["name"], there["segments"], there["seed"]) == (DATA_SET, segments, seed):
            return store.open_library(folder)
    made = progress(takes(segments, seed), label="Making up takes", total=-(-segments // PHRASES))
    return write_library(made, folder, name=DATA_SET, seed=seed)
