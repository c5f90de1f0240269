"""The dance library as choreography sees it: arrays, one row a segment."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from studykit.choreography.reduction import Reduced
from studykit.core.arrays import Booleans, Floats, Integers, frozen
from studykit.core.errors import InputError
from studykit.motion.features import KINETIC, FeatureScaler
from studykit.motion.motion import Motion
from studykit.motion.segmentation import FRAME_RATE_HZ, SEGMENT_S
from studykit.motion.skeleton import NEUTRAL_BODY

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

CHAIN_SEGMENTS = 8
"""Segments in each of the random chains that a library is calibrated on: windows of 32 s, as in the paper."""

MOVEMENT_S = SEGMENT_S - 0.02
"""Segments of one take that start less than this apart overlap; 120 frames at 30.03 Hz last 3.996 s."""

DENSE_LIMIT = 4096
"""Up to this many segments all distances are kept (134 MB); beyond, they are computed when asked for."""

_ALL_AT_ONCE = (
    "linear_energies", "rotational_energies", "first_poses", "last_poses", "peak_speeds", "peak_angles",
)  # fmt: skip
_STILL_RAD_S = 1e-3
_AGAIN = "build it again"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Calibration:
    """What is light, intense, varied and smooth, measured on random chains of the library's own segments.

    Parameters
    ----------
    chain_linear_energies, chain_rotational_energies : array_like, shape (chain,), J per kg
        Sums over the poses of random chains of eight segments of one genre (32 s).
    chain_varieties : array_like, shape (chain,)
        Mean pairwise distance of the same chains (`euclidean_z`).
    chain_cosine_varieties : array_like, shape (chain,)
        Eq. 5 of the same chains (`cosine`).
    join_displacements : array_like, shape (join,), m
        Eq. 3 of random joins.
    window_linear_energies, window_rotational_energies, window_varieties : array_like, shape (window,)
        The same of windows of 32 s that were danced in one go; none where takes are shorter.
    median_distance : float
        Median distance between segments of different takes: the unit of variety targets.
    rated : mapping or None
        What raters call light, intense, easy and hard: `linear_energy`, `rotational_energy` and `variety`,
        each by level. Where it is there, it takes the place of percentiles and shares.
    """

    chain_linear_energies: Floats
    chain_rotational_energies: Floats
    chain_varieties: Floats
    chain_cosine_varieties: Floats
    join_displacements: Floats
    window_linear_energies: Floats
    window_rotational_energies: Floats
    window_varieties: Floats
    median_distance: float
    rated: Mapping[str, Mapping[str, float]] | None = None

    def __post_init__(self) -> None:
        for name in self.array_names():
            object.__setattr__(self, name, frozen(getattr(self, name), shape=(None,), name=name))

    @staticmethod
    def array_names() -> tuple[str, ...]:
        """Name the fields that are arrays."""
        return (
            "chain_linear_energies",
            "chain_rotational_energies",
            "chain_varieties",
            "chain_cosine_varieties",
            "join_displacements",
            "window_linear_energies",
            "window_rotational_energies",
            "window_varieties",
        )

    def energy_targets(self, percentile: float) -> tuple[float, float]:
        """Give the linear and rotational energy that this share (%) of the chains stays below, J per kg."""
        return (
            float(np.percentile(self.chain_linear_energies, percentile)),
            float(np.percentile(self.chain_rotational_energies, percentile)),
        )

    def energies_of(self, level: str, percentile: float) -> tuple[float, float]:
        """Give what "light" or "intense" means here: the raters' word, or else a percentile; J per kg."""
        if self.rated is not None:
            return self.rated["linear_energy"][level], self.rated["rotational_energy"][level]
        return self.energy_targets(percentile)

    def variety_of(self, level: str, share: float) -> float:
        """Give what "easy" or "hard" means here: the raters' word, or else a share of the median distance."""
        return self.rated["variety"][level] if self.rated is not None else share * self.median_distance

    @property
    def transition_tolerance_m(self) -> float:
        """Displacement of a join that counts as smooth: the 3rd percentile of random joins, m."""
        return float(np.percentile(self.join_displacements, 3.0))


class Rows(Protocol):
    """An array with one row a segment, in memory or on disk; rows are read when asked for."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the whole."""
        ...

    def __len__(self) -> int: ...

    def __getitem__(self, rows: Any, /) -> Any:
        """Read one row (an integer) or several (a slice or integers)."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DanceLibrary:
    """Segments of four seconds with all that is measured on them.

    Large arrays may be mapped from disk; rows are read when used.

    Parameters
    ----------
    name : str
        What the library is called.
    segments : DataFrame
        One row a segment: `id, take, data_set, performer, genre, licence, start_s, is_synthetic, mirrored,
        partners, take_sha256, linear_energy, rotational_energy`.
    rotations : Rows, shape (segment, 120, 24, 4)
        Parent-relative unit quaternions; the first pose faces +Z.
    root_positions : Rows, shape (segment, 120, 3), m
        From the place where the segment begins; the floor is at 0.
    features : Rows, shape (segment, 120, 97)
        Raw features; see `standardised`.
    linear_energies, rotational_energies : ndarray, shape (segment, 24), J per kg
        Per joint, summed over the poses (119 differences).
    first_poses, last_poses : ndarray, shape (segment, 24, 3), m
        Pelvis-centred boundary poses, each turned to its own facing.
    peak_speeds : ndarray, shape (segment, 24), rad/s
        How fast each joint turns relative to its parent at most (119 differences).
    peak_angles : ndarray, shape (segment, 24), rad
        How far each joint turns from its rest pose at most; 0 for the pelvis, which turns with the dancer.
    successors : ndarray, shape (segment, neighbour)
        The segments that begin nearest to where each ends (Eq. 3), nearest first.
    scaler : FeatureScaler
        Makes features comparable.
    calibration : Calibration
        What is light, intense, varied and smooth here.
    sha256 : str
        Digest of everything above.
    reduced : Reduced or None
        Nearly the same distances from far fewer numbers, where not all distances can be kept.

    Raises
    ------
    InputError
        If an energy, a boundary pose or a peak is not a finite number, or a successor is no segment.
    """

    name: str
    segments: pd.DataFrame
    rotations: Rows
    root_positions: Rows
    features: Rows
    linear_energies: Floats
    rotational_energies: Floats
    first_poses: Floats
    last_poses: Floats
    peak_speeds: Floats
    peak_angles: Floats
    successors: NDArray[np.int32]
    scaler: FeatureScaler
    calibration: Calibration
    sha256: str
    reduced: Reduced | None = None

    def __post_init__(self) -> None:
        for name in _ALL_AT_ONCE:
            self._require_numbers(name, getattr(self, name), range(len(self)))
        if np.any((self.successors < 0) | (self.successors >= len(self))):
            raise InputError("a successor is no segment", where=self.name, remedy=_AGAIN)

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def is_synthetic(self) -> bool:
        """Whether any segment was made up by studykit rather than danced by a person."""
        return bool(self.segments["is_synthetic"].any())

    @property
    def movements(self) -> tuple[Integers, Floats]:
        """Number of the take and start (s) of every segment, each shape (segment,): see `same_movement`."""
        takes = self.segments["take"].factorize()[0].astype(np.int64)
        return takes, self.segments["start_s"].to_numpy(dtype=np.float64)

    def same_movement(self, first: Any, second: Any) -> Booleans:
        """Tell which segments show the same movement: of one take less than `MOVEMENT_S` apart.

        A segment and its mirror image have the same take and start, so they are the same movement.

        Parameters
        ----------
        first, second : int or ndarray
            Numbers of segments; they are broadcast.
        """
        takes, starts_s = self.movements
        is_near = np.abs(starts_s[first] - starts_s[second]) < MOVEMENT_S
        return np.asarray((takes[first] == takes[second]) & is_near)

    def speed_limits(self, percentile: float = 50.0) -> Floats:
        """Give how fast each joint turns at most in this share (%) of the segments, shape (24,), rad/s.

        Segments in which a joint does not turn at all say nothing of it; a joint that never turns has no
        limit (infinite).
        """
        peaks = np.where(self.peak_speeds > _STILL_RAD_S, self.peak_speeds, np.nan)
        is_moved = ~np.all(np.isnan(peaks), axis=0)
        limits = np.full(peaks.shape[1], np.inf)
        limits[is_moved] = np.nanpercentile(peaks[:, is_moved], percentile, axis=0)
        return limits

    def share_below(self, joint: str, speed_rad_s: float) -> float:
        """Give the share (0 to 1) of the segments in which a joint keeps a limit: see `speed_limits`."""
        peaks = self.peak_speeds[:, NEUTRAL_BODY.index(joint)]
        moved = peaks[peaks > _STILL_RAD_S]
        return float((moved <= speed_rad_s).mean()) if len(moved) else 1.0

    def find(
        self,
        *,
        linear_energy: tuple[float, float] = (-np.inf, np.inf),
        rotational_energy: tuple[float, float] = (-np.inf, np.inf),
        **columns: str | bool | Collection[str],
    ) -> Integers:
        """Find segments by what the table of segments says; no array is read.

        Parameters
        ----------
        linear_energy, rotational_energy : (float, float), J per kg
            Lowest and highest, summed over the poses.
        **columns : str, bool or several str
            What other columns must say, such as `genre=["salsa", "indian"]` or `mirrored=False`.

        Returns
        -------
        ndarray, shape (match,)
            Numbers of the segments.

        Raises
        ------
        InputError
            If the table has no such column.
        """
        table = self.segments
        unknown = [name for name in columns if name not in table]
        if unknown:
            remedy = f"choose from {', '.join(map(str, table))}"
            raise InputError(f"segments have no {unknown[0]!r}", where=self.name, remedy=remedy)
        good = table["linear_energy"].between(*linear_energy)
        good &= table["rotational_energy"].between(*rotational_energy)
        for name, value in columns.items():
            good &= table[name].isin([value] if isinstance(value, str | bool) else list(value))
        return np.flatnonzero(good.to_numpy())

    def motion(self, segment: int) -> Motion:
        """Give one segment as a motion."""
        rotations, root_positions = self.rotations[segment], self.root_positions[segment]
        self._require_numbers("rotations", rotations[None], [segment])
        self._require_numbers("root_positions", root_positions[None], [segment])
        return Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotations,
            root_positions=root_positions,
            frame_rate_hz=FRAME_RATE_HZ,
        )

    def standardised(self, rows: slice | Integers) -> np.ndarray[Any, np.dtype[np.float32]]:
        """Give feature vectors made comparable across channels, shape (row, 11640)."""
        features = np.asarray(self.features[rows])
        self._require_numbers("features", features, rows)
        values = self.scaler.standardised(features).astype(np.float32)
        return values.reshape(len(values), int(np.prod(self.features.shape[1:])))

    def _require_numbers(self, name: str, values: Any, rows: Any) -> None:
        """Refuse what is not a finite number; names the segment."""
        bad = np.flatnonzero(~np.isfinite(values).all(axis=tuple(range(1, np.ndim(values)))))
        if len(bad):
            segment = np.arange(len(self))[rows][bad[0]]
            problem = f"segment {segment} has {name} that are no numbers"
            raise InputError(problem, where=self.name, remedy=_AGAIN)

    def displacement(self, before: int, after: int) -> float:
        """Give how far the joints jump where one segment follows another (Eq. 3), m."""
        return float(np.linalg.norm(self.first_poses[after] - self.last_poses[before], axis=-1).mean())


class SegmentDistances:
    """How different segments are from one another, in one of the two readings of Eq. 5.

    Parameters
    ----------
    library : DanceLibrary
        Whose segments.
    metric : {"euclidean_z", "cosine"}
        Euclidean distance of standardised features; or one minus the cosine, with the kinetic and the
        geometric block weighted alike.
    """

    def __init__(self, library: DanceLibrary, metric: str) -> None:
        self._library = library
        self._metric = metric
        self._dense: Floats | None = None
        if len(library) <= DENSE_LIMIT:
            everything = slice(None)
            between = self._measured(everything, everything)
            self._dense = 0.5 * (between + between.T)  # products are not the same to the last digit
            np.fill_diagonal(self._dense, 0.0)

    def between(self, rows: Sequence[int], columns: Sequence[int]) -> Floats:
        """Give the distance of every segment of `rows` to every one of `columns`, shape (row, column)."""
        first, second = np.array(rows), np.array(columns)
        if self._dense is not None:
            return np.asarray(self._dense[first[:, None], second])
        return np.where(first[:, None] == second, 0.0, self._measured(first, second))

    @property
    def table(self) -> Floats | None:
        """All distances, shape (segment, segment), where the library is small enough to keep them."""
        return self._dense

    @property
    def is_reduced(self) -> bool:
        """Whether a search is guided by reduced distances."""
        return self._dense is None and self._metric == "euclidean_z" and self._library.reduced is not None

    def guide(self, one: int, other: int) -> float:
        """Give the distance of two segments as a search sees it: reduced where not all are kept."""
        reduced = self._library.reduced
        if self._dense is None and self._metric == "euclidean_z" and reduced is not None:
            return float(reduced.between(one, other)[0, 0])
        return float(self.between((one,), (other,))[0, 0])

    def exact(self, rows: Sequence[int]) -> Floats:
        """Give the distances of a few segments from all their features in double precision."""
        numbers, places = np.unique(np.array(rows), return_inverse=True)
        vectors = self._vectors(numbers).astype(np.float64)
        if self._metric == "cosine":
            vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)
            between = 1.0 - vectors @ vectors.T
            np.fill_diagonal(between, 0.0)
        else:
            between = np.array([np.linalg.norm(vectors - vector, axis=1) for vector in vectors])
        return np.asarray(between[np.ix_(places, places)])

    def _measured(self, rows: Any, columns: Any) -> Floats:
        first = self._vectors(rows)
        second = first if rows is columns else self._vectors(columns)
        products = np.asarray(first @ second.T, dtype=np.float64)
        if self._metric == "cosine":
            return 1.0 - products
        squares = [np.einsum("ij,ij->i", v, v, dtype=np.float64) for v in (first, second)]
        return np.asarray(np.sqrt(np.maximum(squares[0][:, None] + squares[1] - 2.0 * products, 0.0)))

    def _vectors(self, rows: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
        vectors = self._library.standardised(rows)
        if self._metric == "euclidean_z":
            return vectors
        channels = self._library.features.shape[-1]
        weights = np.full(channels, np.sqrt(0.5 / (channels - KINETIC)), dtype=np.float32)
        weights[:KINETIC] = np.sqrt(0.5 / KINETIC)
        weighted = vectors.reshape(len(vectors), -1, channels) * weights
        flat = weighted.reshape(len(vectors), -1)
        return np.asarray(flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9))


@lru_cache(maxsize=4)
def distances(library: DanceLibrary, metric: str) -> SegmentDistances:
    """Give the distances of a library, kept for the dances that follow."""
    return SegmentDistances(library, metric)


def mean_of_pairs(between: Floats) -> float:
    """Give the mean over all pairs of a square of distances: phi of Eq. 5; 0 where there is no pair."""
    count = len(between)
    return float(between.sum() / (count * (count - 1))) if count > 1 else 0.0
