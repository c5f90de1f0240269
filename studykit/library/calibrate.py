"""Finding out what is light, intense, varied and smooth in a library (section 5.6 of the paper)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance_library import (
    CHAIN_SEGMENTS,
    Calibration,
    DanceLibrary,
    Rows,
    SegmentDistances,
    mean_of_pairs,
)
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.motion import kinematics
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.energy import linear_energy
from studykit.motion.features import KINETIC, FeatureScaler
from studykit.motion.segmentation import FRAME_RATE_HZ, SEGMENT_FRAMES

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


def calibrate(library: DanceLibrary, rng: np.random.Generator) -> Calibration:
    """Measure random chains, joins and pairs of a library's segments.

    Raises
    ------
    InputError
        If the library has fewer than eight segments, or only one take.
    """
    if len(library) < CHAIN_SEGMENTS or library.segments["take"].nunique() < 2:
        raise InputError(
            f"{len(library)} segments of {library.segments['take'].nunique()} takes are too few to calibrate",
            where=library.name,
            remedy=f"give at least {CHAIN_SEGMENTS} segments (32 s) from two takes",
        )
    chains = _random_chains(library, rng)
    euclidean, cosine = (SegmentDistances(library, metric) for metric in ("euclidean_z", "cosine"))
    windows = _windows(library, rng)
    return Calibration(
        chain_linear_energies=_sums(library.linear_energies, chains),
        chain_rotational_energies=_sums(library.rotational_energies, chains),
        chain_varieties=_varieties(chains, euclidean),
        chain_cosine_varieties=_varieties(chains, cosine),
        join_displacements=np.array(
            [library.displacement(a, b) for chain in chains for a, b in pairwise(chain)]
        ),
        median_distance=_median_distance(library, euclidean, rng),
        window_linear_energies=_sums(library.linear_energies, windows),
        window_rotational_energies=_sums(library.rotational_energies, windows),
        window_varieties=_varieties(windows, euclidean),
    )


def _sums(energies: Floats, chains: Integers) -> Floats:
    return np.asarray(np.asarray(energies).sum(axis=1)[chains].sum(axis=1))


def _varieties(chains: Integers, distances: SegmentDistances) -> Floats:
    return np.array([mean_of_pairs(distances.between(chain, chain)) for chain in chains])


def _windows(library: DanceLibrary, rng: np.random.Generator) -> Integers:
    """Eight segments that follow each other in one take, shape (window, 8); at most 1,000 of them."""
    table = library.segments
    plain = table[~table["mirrored"].to_numpy(dtype=np.bool_)]
    found = []
    for _, own in plain.groupby("take", sort=False):
        frames = np.round(own["start_s"].to_numpy() * FRAME_RATE_HZ).astype(np.int64)
        row_at = dict(zip(frames.tolist(), own.index.tolist(), strict=True))
        for start in row_at:
            followers = [row_at.get(start + step * SEGMENT_FRAMES, -1) for step in range(CHAIN_SEGMENTS)]
            if -1 not in followers:
                found.append(followers)
    windows = np.array(found, dtype=np.int64).reshape(-1, CHAIN_SEGMENTS)
    if len(windows) > CHAINS:
        windows = windows[np.sort(rng.choice(len(windows), size=CHAINS, replace=False))]
    return windows


def _random_chains(library: DanceLibrary, rng: np.random.Generator) -> Integers:
    """Segments of one genre in random order, shape (chain, 8); genres by their number of segments."""
    genres = library.segments["genre"].to_numpy()
    rows = {genre: np.flatnonzero(genres == genre) for genre in sorted(set(genres))}
    rows = {genre: own for genre, own in rows.items() if len(own) >= CHAIN_SEGMENTS} or {
        "all": np.arange(len(library))
    }
    sizes = np.array([len(own) for own in rows.values()], dtype=np.float64)
    picks = rng.choice(len(rows), size=CHAINS, p=sizes / sizes.sum())
    lists = list(rows.values())
    return np.array([rng.choice(lists[pick], size=CHAIN_SEGMENTS, replace=False) for pick in picks])


def _median_distance(library: DanceLibrary, distances: SegmentDistances, rng: np.random.Generator) -> float:
    takes = library.segments["take"].to_numpy()
    pairs = rng.integers(len(library), size=(8 * CHAINS, 2))
    pairs = pairs[takes[pairs[:, 0]] != takes[pairs[:, 1]]][: 2 * CHAINS]
    values: Floats = np.array([distances.between([a], [b])[0, 0] for a, b in pairs])
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
