"""Finding out what is light, intense, varied and smooth in a library (section 5.6 of the paper)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from studykit.choreography.dance_library import (
    CHAIN_SEGMENTS,
    Calibration,
    DanceLibrary,
    Rows,
    SegmentDistances,
    mean_of_pairs,
)
from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.motion.features import KINETIC, FeatureScaler

CHAINS = 1000
"""Windows measured, as in the paper; chains of segments of one genre, since few takes last 32 s."""

_CHUNK = 256
_MEDIAN_POSES = 250_000


UNCALIBRATED = Calibration(**{name: np.zeros(0) for name in Calibration.array_names()}, median_distance=1.0)
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
    linear, rotational = (
        np.asarray(energies).sum(axis=1)[chains].sum(axis=1)
        for energies in (library.linear_energies, library.rotational_energies)
    )
    return Calibration(
        chain_linear_energies=linear,
        chain_rotational_energies=rotational,
        chain_varieties=np.array([mean_of_pairs(euclidean.between(chain, chain)) for chain in chains]),
        chain_cosine_varieties=np.array([mean_of_pairs(cosine.between(chain, chain)) for chain in chains]),
        join_displacements=np.array(
            [library.displacement(a, b) for chain in chains for a, b in pairwise(chain)]
        ),
        median_distance=_median_distance(library, euclidean, rng),
    )


def _random_chains(
    library: DanceLibrary, rng: np.random.Generator
) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
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
