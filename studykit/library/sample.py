"""The library that needs no data: synthetic takes of graded intensity, as many as asked for."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Final

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.core.seeding import stream
from studykit.io.bvh import bvh_text
from studykit.io.datasets.recipe import FILE_NAME
from studykit.io.datasets.take import Take, TakeSource
from studykit.library import synthesis
from studykit.library.build import build_from
from studykit.library.measure import Settings
from studykit.library.origin import Origin

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

RECIPE: Final = 1
"""Raised when the same seed would give another movement."""

_SPREAD = 0.15  # of the logarithm of the energy among the segments of a take
_GOLDEN = 0.6180339887498949  # steps by this share of the range fill it evenly, however many takes there are


@dataclass(frozen=True, kw_only=True, slots=True)
class SyntheticTake:
    """One take that is made up when it is read.

    Parameters
    ----------
    number : int
        Which one; the style goes round with it.
    seed : int
        The same seed gives the same takes.
    phrases : int
        Segments in it, up to 10; a shorter take is the beginning of the whole.
    """

    number: int
    seed: int
    phrases: int = PHRASES

    @property
    def name(self) -> str:
        """Its name, with its number."""
        return f"synthetic-{self.number:05d}"

    @property
    def data_set(self) -> str:
        """The name that says that nobody danced it."""
        return DATA_SET

    def digest(self) -> str:
        """Digest the recipe by which it is made up."""
        return sha256_of_value({"data_set": DATA_SET, "version": RECIPE} | asdict(self))

    def takes(self) -> list[Take]:
        """Make it up: 40 s of one style at one tempo and intensity, or the beginning of that."""
        return [_take(self)]


def synthetic_takes(count_segments: int, seed: int) -> list[SyntheticTake]:
    """Name the takes that hold as many segments as asked for; a larger count only adds takes behind.

    Parameters
    ----------
    count_segments : int
        Segments of 4 s wanted, 1 or more.
    seed : int
        The same seed gives the same takes.

    Raises
    ------
    InputError
        If fewer than one segment is asked for.

    Examples
    --------
    >>> [(take.name, take.phrases) for take in synthetic_takes(12, seed=1)]
    [('synthetic-00000', 10), ('synthetic-00001', 2)]
    """
    if count_segments < 1:
        raise InputError(
            f"{count_segments} segments are asked for", where="segments", remedy="ask for 1 or more"
        )
    return [
        SyntheticTake(number=first // PHRASES, seed=seed, phrases=min(PHRASES, count_segments - first))
        for first in range(0, count_segments, PHRASES)
    ]


def make_takes(out: str | Path, *, segments: int = 240, seed: int = 0) -> Path:
    """Write synthetic takes as BVH files with a recipe beside them: something to try a build on.

    Parameters
    ----------
    out : str or Path
        The folder to make.
    segments : int
        How many segments of 4 s they hold.
    seed : int
        Repeats the takes.

    Raises
    ------
    InputError
        If something is in the folder already, or it cannot be written.
    """
    folder = Path(out)
    sources = synthetic_takes(segments, seed)
    recipe = (
        f'data_set = "{DATA_SET}"\nlicence = "{LICENCE}"\nformat = "bvh"\nskeleton = "smpl"\nunits_m = 0.01\n'
        "# Nobody danced these takes: studykit made them up.\nis_synthetic = true\n"
    )
    for style in synthesis.STYLES:
        recipe += (
            f'\n[[takes]]\nmatch = "{style.name}/*.bvh"\ngenre = "{style.name}"\n'
            f'performer = "nobody (synthetic)"\n'
        )
    try:
        folder.mkdir(parents=True)
        for source in sources:
            take = source.takes()[0]
            path = folder / take.source.genre / f"{take.name}.bvh"
            path.parent.mkdir(exist_ok=True)
            path.write_text(bvh_text(take.motion), encoding="utf-8")
        (folder / FILE_NAME).write_text(recipe, encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written ({reason})", where=folder, remedy="choose another folder"
        ) from error
    return folder


def _take(source: SyntheticTake) -> Take:
    style = synthesis.STYLES[source.number % len(synthesis.STYLES)]
    start = stream(source.seed, "synthetic", "intensity").random()
    grade = (start + _GOLDEN * source.number) % 1.0
    rng = stream(source.seed, "synthetic", "take", source.number)
    energies = LEAST_ENERGY * ENERGY_RANGE**grade * rng.lognormal(0.0, _SPREAD, PHRASES)
    whole = synthesis.dance(synthesis.figures(style, PHRASES, rng), energies)
    frames = round(source.phrases * synthesis.PHRASE_S * whole.frame_rate_hz)
    return Take(
        name=source.name,
        motion=replace(
            whole, rotations=whole.rotations[:frames], root_positions=whole.root_positions[:frames]
        ),
        source=TakeSource(
            data_set=DATA_SET,
            performer="nobody (synthetic)",
            genre=style.name,
            licence=LICENCE,
            is_synthetic=True,
            sha256=source.digest(),
        ),
    )


def make_sample(
    out: str | Path,
    *,
    segments: int = 240,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress = silent,
) -> DanceLibrary:
    """Make up a whole library, or bring one that is there to this size.

    Parameters
    ----------
    out : str or Path
        The folder to make.
    segments : int
        How many segments of 4 s.
    seed : int
        Repeats the library.
    workers : int, optional
        Processes; if not given, what joblib's `parallel_config` says.
    progress : Progress
        Told of each take.

    Raises
    ------
    InputError
        If something else is in the folder, or it cannot be written.
    """
    return build_from(
        synthetic_takes(segments, seed),
        out,
        Origin(
            name=DATA_SET,
            data_sets=(DATA_SET,),
            citations={DATA_SET: ""},
            synthetic={"count_segments": segments, "seed": seed},
        ),
        settings=Settings(seed=seed),
        workers=workers,
        progress=progress,
    )
