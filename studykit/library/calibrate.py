"""Finding out what is light, intense, varied and smooth in a library (section 5.6 of the paper)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance_library import (
    CHAIN_SEGMENTS,
    MOVEMENT_S,
    Calibration,
    DanceLibrary,
    Rows,
    SegmentDistances,
    mean_of_pairs,
)
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.motion import kinematics
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.energy import linear_energy
from studykit.motion.features import KINETIC, FeatureScaler
from studykit.motion.segmentation import FRAME_RATE_HZ, SEGMENT_S

if TYPE_CHECKING:
    import pandas as pd

CHAINS = 1000
"""Windows measured, as in the paper; chains of segments of one genre, since few takes last 32 s."""

_CHUNK = 256
_UNIT_SEGMENTS = 400
_MEDIAN_POSES = 250_000


_NOTHING: dict[str, Any] = {name: np.zeros(0) for name in Calibration.array_names()}
UNCALIBRATED = Calibration(**_NOTHING, median_distance=1.0)
"""Stands in for the calibration of a library that is being built."""


def fit_scaler(features: Rows) -> FeatureScaler:
    """Find the scale of each feature channel over all poses of a library.

    Parameters
    ----------
    features : Rows, shape (segment, 120, 97)
        Raw features, possibly on disk; read in pieces, so that the cost is linear and the memory constant.

    Notes
    -----
    Medians come from at most 250,000 evenly spaced poses; means and deviations from all.
    """
    frames = features.shape[1]
    poses = len(features) * frames
    every = max(1, poses // _MEDIAN_POSES)
    sample = np.concatenate(
        [
            piece.reshape(-1, piece.shape[-1])[-start * frames % every :: every, :KINETIC]
            for start, piece in _pieces(features)
        ]
    ).astype(np.float64)
    alive = np.any(sample > 0.0, axis=0)
    knees = np.ones(KINETIC)
    knees[alive] = np.nanmedian(np.where(sample > 0.0, sample, np.nan)[:, alive], axis=0)
    scaler = FeatureScaler(kinetic_medians=knees, means=np.zeros(97), deviations=np.ones(97))

    total, squares = np.zeros(97), np.zeros(97)
    # Sums about a first guess of the mean keep their digits.
    guess = scaler.logarithmic(features[:1].astype(np.float64)).mean(axis=(0, 1))
    for _, piece in _pieces(features):
        values = scaler.logarithmic(piece.astype(np.float64)) - guess
        total += values.sum(axis=(0, 1))
        squares += np.einsum("sfc,sfc->c", values, values)
    means = total / poses
    deviations = np.sqrt(np.maximum(squares / poses - means**2, 0.0))
    return FeatureScaler(kinetic_medians=knees, means=guess + means, deviations=deviations)


def _pieces(features: Rows) -> Iterator[tuple[int, Any]]:
    for start in range(0, len(features), _CHUNK):
        yield start, features[start : start + _CHUNK]


def calibrate(library: DanceLibrary, rng: np.random.Generator, *, progress: Progress = silent) -> Calibration:
    """Measure random chains, joins and pairs of a library's segments.

    Raises
    ------
    InputError
        If the library has fewer than eight segments, or only one take.
    """
    single = side_by_side(library)
    takes = library.segments["take"].nunique()
    if len(single) < CHAIN_SEGMENTS or takes < 2:
        raise InputError(
            f"{len(single)} segments of {takes} takes are too few to calibrate",
            where=library.name,
            remedy=f"give at least {CHAIN_SEGMENTS} segments (32 s) from two takes",
        )
    chains = _random_chains(library, single, rng)
    euclidean, cosine = (SegmentDistances(library, metric) for metric in ("euclidean_z", "cosine"))
    windows = _windows(library, single, rng)
    return Calibration(
        chain_linear_energies=_sums(library.linear_energies, chains),
        chain_rotational_energies=_sums(library.rotational_energies, chains),
        chain_varieties=_varieties(progress(chains, label="Measuring variety", total=len(chains)), euclidean),
        chain_cosine_varieties=_varieties(chains, cosine),
        join_displacements=np.array(
            [library.displacement(a, b) for chain in chains for a, b in pairwise(chain)]
        ),
        median_distance=_median_distance(library, single, euclidean, rng),
        window_linear_energies=_sums(library.linear_energies, windows),
        window_rotational_energies=_sums(library.rotational_energies, windows),
        window_varieties=_varieties(windows, euclidean),
    )


def genres_beside(library: DanceLibrary) -> dict[str, int]:
    """Name the genres that no chain comes from, since they have fewer than eight segments, and how many."""
    counts = library.segments["genre"].iloc[side_by_side(library)].value_counts().sort_index()
    small = {str(genre): int(count) for genre, count in counts.items() if count < CHAIN_SEGMENTS}
    return small if len(small) < len(counts) else {}


def _sums(energies: Floats, chains: Integers) -> Floats:
    return np.asarray(np.asarray(energies).sum(axis=1)[chains].sum(axis=1))


def _varieties(chains: Iterable[Any], distances: SegmentDistances) -> Floats:
    return np.array([mean_of_pairs(distances.between(chain, chain)) for chain in chains])


def side_by_side(library: DanceLibrary) -> Integers:
    """Give the rows of segments that are neither mirrored nor overlap another: every movement once."""
    table = library.segments
    plain = table[~table["mirrored"].to_numpy(dtype=np.bool_)]
    rows = []
    for _, own in plain.groupby("take", sort=False):
        last_s = -np.inf
        for row, start_s in zip(own.index, own["start_s"], strict=True):
            if start_s - last_s >= MOVEMENT_S:
                rows.append(row)
                last_s = start_s
    return np.sort(np.array(rows, dtype=np.int64))


def _windows(library: DanceLibrary, single: Integers, rng: np.random.Generator) -> Integers:
    """Eight segments that follow each other in one take, shape (window, 8); at most 1,000 of them."""
    found: list[Any] = []
    for _, own in library.segments.loc[single].groupby("take", sort=False):
        follows = np.abs(np.diff(own["start_s"].to_numpy()) - SEGMENT_S) < SEGMENT_S - MOVEMENT_S
        rows = own.index.to_numpy()
        found += [
            rows[first : first + CHAIN_SEGMENTS]
            for first in range(len(rows) - CHAIN_SEGMENTS + 1)
            if follows[first : first + CHAIN_SEGMENTS - 1].all()
        ]
    windows = np.array(found, dtype=np.int64).reshape(-1, CHAIN_SEGMENTS)
    if len(windows) > CHAINS:
        windows = windows[np.sort(rng.choice(len(windows), size=CHAINS, replace=False))]
    return windows


def _random_chains(library: DanceLibrary, single: Integers, rng: np.random.Generator) -> Integers:
    """Segments of one genre in random order, shape (chain, 8); genres by their number of segments."""
    genres = library.segments["genre"].to_numpy()[single]
    rows = {genre: single[genres == genre] for genre in sorted(set(genres))}
    rows = {genre: own for genre, own in rows.items() if len(own) >= CHAIN_SEGMENTS} or {"all": single}
    sizes = np.array([len(own) for own in rows.values()], dtype=np.float64)
    picks = rng.choice(len(rows), size=CHAINS, p=sizes / sizes.sum())
    lists = list(rows.values())
    return np.array([rng.choice(lists[pick], size=CHAIN_SEGMENTS, replace=False) for pick in picks])


def _median_distance(
    library: DanceLibrary, single: Integers, distances: SegmentDistances, rng: np.random.Generator
) -> float:
    """Draw pairs of segments of different takes, each segment by chance alone."""
    order = single[np.argsort(library.segments["take"].to_numpy()[single], kind="stable")]
    _, firsts, sizes = np.unique(
        library.segments["take"].to_numpy()[order].astype(str), return_index=True, return_counts=True
    )
    own = np.repeat(np.arange(len(sizes)), sizes)
    picks = rng.integers(len(order), size=2 * CHAINS)
    # The second segment is counted from the end of the first one's take on, round the circle of all others.
    steps = (rng.random(len(picks)) * (len(order) - sizes[own[picks]])).astype(np.int64)
    others = (firsts[own[picks]] + sizes[own[picks]] + steps) % len(order)
    values = [distances.between([a], [b])[0, 0] for a, b in zip(order[picks], order[others], strict=True)]
    return float(np.median(values))


def unit_readings(library: DanceLibrary, rng: np.random.Generator) -> pd.DataFrame:
    """Measure the mean energies of 32 s under every reading of the paper's unit.

    The paper's energies do not say whether masses are shares or kilograms, whether joints are seen from the
    pelvis or in the room, and whether positions were standardised first; only one reading comes near both.

    Parameters
    ----------
    library : DanceLibrary
        At most 400 of its segments are measured.
    rng : Generator
        Draws them.

    Returns
    -------
    DataFrame
        `reading, linear_energy, rotational_energy`.
    """
    import pandas as pd

    count = min(len(library), _UNIT_SEGMENTS)
    rows = np.sort(rng.choice(len(library), size=count, replace=False))
    motions = [library.motion(int(row)) for row in rows]
    centred = np.array([kinematics.centred_positions(one.skeleton, one.rotations) for one in motions])
    spread = np.maximum(centred.std(axis=(0, 1)), 1e-9)
    roots = np.array([one.root_positions for one in motions])[:, :, None]
    positions = {
        "from the pelvis": centred,
        "in the room": centred + roots,
        "from the pelvis, standardised": np.where(spread > 1e-6, centred / spread, 0.0),
    }
    turning = float(library.rotational_energies[rows].sum() / count) * CHAIN_SEGMENTS
    table = [
        {
            "reading": f"joints {place}, {unit}",
            "linear_energy": scale
            * CHAIN_SEGMENTS
            * float(np.mean([linear_energy(one, FRAME_RATE_HZ).sum() for one in where])),
            "rotational_energy": scale * turning,
        }
        for place, where in positions.items()
        for unit, scale in (
            (f"mass in kg ({DEFAULT_BODY_MASS_KG:g})", DEFAULT_BODY_MASS_KG),
            ("mass as a share", 1.0),
        )
    ]
    return pd.DataFrame(table)
