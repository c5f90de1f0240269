"""Choosing which dances of a library are shown to dancers, who say what is light, intense, easy and hard."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from studykit.choreography.dance_library import CHAIN_SEGMENTS, DanceLibrary, distances, mean_of_pairs
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_value
from studykit.core.seeding import stream
from studykit.motion.blending import joined
from studykit.motion.motion import Motion

if TYPE_CHECKING:
    import pandas as pd

PLAN_COLUMNS: Final = ("rater", "order", "window", "segments", "library")
SCALES: Final[Mapping[str, tuple[str, str]]] = {
    "intensity": ("light", "intense"),
    "variety": ("easy", "hard"),
}
"""What is asked about each window, and the two answers: less, then more."""

_STRATA = (4, 2)  # quarters of linear energy, halves of variety
_CANDIDATES = 4  # drawn for each window that is shown
_LEAST_CANDIDATES = 400


def rating_plan(
    library: DanceLibrary, *, windows: int = 60, raters: Sequence[str] = ("A", "B", "C"), seed: int = 0
) -> pd.DataFrame:
    """Choose which dances of 32 s are shown to whom, and in which order.

    Parameters
    ----------
    library : DanceLibrary
        Eight segments or more.
    windows : int
        How many are rated, by everybody; 8 or more.
    raters : sequence of str
        Their names or signs, each once.
    seed : int
        Repeats the plan.

    Returns
    -------
    DataFrame
        One row a rater and window, in the order of showing: `rater`; `order` from 1; `window` from 1;
        `segments`, a tuple of eight rows of the library; `library`, which one, see `segments_digest`. No row
        says what was measured on a window, nor do the numbers of windows.

    Raises
    ------
    InputError
        If the library has fewer than eight segments, fewer than eight windows are asked for, or the raters'
        names are missing, not printable or not distinct.

    Notes
    -----
    A window is a chain of eight segments of one genre, of which two to eight are different: people do repeat
    figures, and repetition is what makes a dance easy. Of four times as many random chains as are wanted (400
    or more), as many are taken from each quarter of linear energy and, within it, from each half of variety.

    Windows are dealt into as many blocks as there are raters, each block a fair sample of all. Every rater
    begins with another block and goes on in a circle; within a block, everybody has a random order of their
    own. So each window is shown once in each part of a session.
    """
    import pandas as pd

    _check(library, windows, raters)
    rng = stream(seed, "rating plan")
    chains, strata = _stratified(library, windows, rng)
    numbers = rng.permutation(windows) + 1
    # Windows in random order within each stratum, the strata one after the other, are dealt like cards.
    dealt = np.lexsort((rng.random(windows), strata))
    blocks = [dealt[first :: len(raters)] for first in range(len(raters))]
    rows, own = [], segments_digest(library)
    for first, rater in enumerate(raters):
        turns = [blocks[(first + turn) % len(raters)] for turn in range(len(raters))]
        shown = np.concatenate([rng.permutation(block) for block in turns])
        rows += [
            (rater, order, int(numbers[one]), tuple(int(segment) for segment in chains[one]), own)
            for order, one in enumerate(shown, start=1)
        ]
    return pd.DataFrame(rows, columns=list(PLAN_COLUMNS))


def segments_digest(library: DanceLibrary) -> str:
    """Tell one set of segments from another, whatever they were calibrated on: 12 hexadecimal digits."""
    table = library.segments[["take", "start_s", "mirrored"]]
    return sha256_of_value(table.astype({"take": str}).to_numpy(dtype=object).tolist())[:12]


def window_motion(library: DanceLibrary, segments: Sequence[int]) -> Motion:
    """Give the movement of one window, its segments joined without a jump.

    Parameters
    ----------
    library : DanceLibrary
        That of the plan.
    segments : sequence of int
        Rows of the library, as in the plan's column `segments`.

    Raises
    ------
    InputError
        If the library has no such segment.
    """
    require_window(library, segments)
    return joined([library.motion(segment) for segment in segments])


def window_measures(library: DanceLibrary, chains: Integers) -> dict[str, Floats]:
    """Measure windows: how much energy and variety each holds.

    Parameters
    ----------
    library : DanceLibrary
        That of the plan.
    chains : ndarray, shape (window, 8)
        Rows of the library.

    Returns
    -------
    dict of str to ndarray, shape (window,)
        `linear_energy` and `rotational_energy`, J per kg, sums over the segments; `variety`, the mean
        distance of their pairs (`euclidean_z`).
    """
    between = distances(library, "euclidean_z").between
    linear, rotational = (
        np.asarray(energies).sum(axis=1)[chains].sum(axis=1)
        for energies in (library.linear_energies, library.rotational_energies)
    )
    variety = np.array([mean_of_pairs(between(chain, chain)) for chain in chains])
    return {"linear_energy": linear, "rotational_energy": rotational, "variety": variety}


def require_window(library: DanceLibrary, segments: Sequence[int]) -> None:
    """Refuse a window whose segments a library does not have.

    Raises
    ------
    InputError
        Names the library and the segments.
    """
    if not segments or min(segments) < 0 or max(segments) >= len(library):
        raise InputError(
            f"the library has no segments {list(segments)}",
            where=library.name,
            remedy="give the library that the plan was made for",
        )


def _stratified(library: DanceLibrary, windows: int, rng: np.random.Generator) -> tuple[Integers, Integers]:
    """Draw chains, alike many from each stratum, shapes (window, 8) and (window,)."""
    chains = _random_chains(library, rng, max(_LEAST_CANDIDATES, _CANDIDATES * windows))
    measured = window_measures(library, chains)
    strata = _ranked(measured["linear_energy"], _STRATA[0]) * _STRATA[1]
    for stratum in set(strata):
        own = np.flatnonzero(strata == stratum)
        strata[own] += _ranked(measured["variety"][own], _STRATA[1])
    kinds = _STRATA[0] * _STRATA[1]
    quotas = np.full(kinds, windows // kinds)
    quotas[rng.permutation(kinds)[: windows % kinds]] += 1
    chosen = np.concatenate(
        [
            rng.choice(np.flatnonzero(strata == kind), size=quota, replace=False)
            for kind, quota in enumerate(quotas)
        ]
    )
    return chains[chosen], strata[chosen]


def _random_chains(library: DanceLibrary, rng: np.random.Generator, count: int) -> Integers:
    genres = library.segments["genre"].to_numpy()
    rows = [np.flatnonzero(genres == genre) for genre in sorted(set(genres))]
    rows = [own for own in rows if len(own) >= CHAIN_SEGMENTS] or [np.arange(len(library))]
    sizes = np.array([len(own) for own in rows], dtype=np.float64)
    chains = []
    for pick in rng.choice(len(rows), size=count, p=sizes / sizes.sum()):
        different = rng.choice(rows[pick], size=rng.integers(2, CHAIN_SEGMENTS + 1), replace=False)
        again = rng.choice(different, size=CHAIN_SEGMENTS - len(different))
        chains.append(rng.permutation(np.concatenate((different, again))))
    return np.array(chains, dtype=np.int64)


def _ranked(values: Floats, parts: int) -> Integers:
    """Tell for each value in which of so many equally large parts it lies: 0 the lowest."""
    ranks = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return np.asarray(ranks * parts // len(values), dtype=np.int64)


def _check(library: DanceLibrary, windows: int, raters: Sequence[str]) -> None:
    if len(library) < CHAIN_SEGMENTS:
        raise InputError(
            f"{len(library)} segments are too few for a window",
            where=library.name,
            remedy=f"give at least {CHAIN_SEGMENTS} segments (32 s)",
        )
    least = _STRATA[0] * _STRATA[1]
    if windows < least:
        raise InputError(
            f"{windows} windows are asked for", where="windows", remedy=f"ask for {least} or more"
        )
    if isinstance(raters, str) or not raters or len(set(raters)) < len(raters):
        raise InputError(
            "raters cannot be told apart", where="raters", remedy="give each a name of their own"
        )
    for rater in raters:
        if not rater.strip() or not rater.isprintable():
            raise InputError(f"{rater!r} is no name", where="raters", remedy="use letters and digits")
