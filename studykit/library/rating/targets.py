"""Turning dancers' words into targets: what they call light, intense, easy and hard, in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from studykit.analysis.agreement import Agreement, krippendorff_alpha
from studykit.choreography.dance_library import DanceLibrary
from studykit.core.arrays import Booleans, Floats
from studykit.core.errors import InputError
from studykit.library.rating.plan import SCALES, require_window, segments_digest, window_measures

if TYPE_CHECKING:
    import pandas as pd

LEAST_WINDOWS: Final = 5
"""Windows that a class needs for its mean to be a target."""

_MEASURES = {"intensity": ("linear_energy", "rotational_energy"), "variety": ("variety",)}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RatedTargets:
    """What dancers call light, intense, easy and hard, in numbers.

    Parameters
    ----------
    linear_energy, rotational_energy : dict of str to float, J per kg
        Mean over the windows (32 s) that most raters called "light" and "intense".
    variety : dict of str to float
        Mean distance of segments (`euclidean_z`) in the windows that most called "easy" and "hard".
    spreads : dict of str to float
        Standard deviation of `linear_energy`, `rotational_energy` and `variety` over all rated windows.
    counts : dict of str to int
        Windows in each class, and those left out because as many raters said the one as the other:
        `undecided_intensity`, `undecided_variety`.
    agreement : dict of str to Agreement
        How far the raters agree about "intensity" and about "variety".
    library_sha256 : str
        The library that was rated.
    """

    linear_energy: Mapping[str, float]
    rotational_energy: Mapping[str, float]
    variety: Mapping[str, float]
    spreads: Mapping[str, float]
    counts: Mapping[str, int]
    agreement: Mapping[str, Agreement]
    library_sha256: str

    def as_dict(self) -> dict[str, Any]:
        """Give all numbers as plain values that JSON can hold; `from_dict` reads them again."""
        agreement = {
            scale: asdict(one) | {"interval": list(one.interval)} for scale, one in self.agreement.items()
        }
        own: dict[str, Any] = {name: getattr(self, name) for name in self.__slots__ if name != "agreement"}
        return {name: dict(value) if isinstance(value, Mapping) else value for name, value in own.items()} | {
            "agreement": agreement
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> RatedTargets:
        """Read what `as_dict` gave.

        Raises
        ------
        InputError
            If something is missing or of another kind.
        """
        try:
            agreement = {
                scale: Agreement(
                    **(one | {"interval": (float(one["interval"][0]), float(one["interval"][1]))})
                )
                for scale, one in values["agreement"].items()
            }
            numbers = {
                name: {key: float(number) for key, number in values[name].items()}
                for name in ("linear_energy", "rotational_energy", "variety", "spreads")
            }
            counts = {key: int(number) for key, number in values["counts"].items()}
            return cls(
                **numbers, counts=counts, agreement=agreement, library_sha256=str(values["library_sha256"])
            )
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            raise InputError(
                f"these are no rated targets ({type(error).__name__}: {error})",
                where="rated targets",
                remedy="save them again",
            ) from error


def rated_targets(ratings: pd.DataFrame, plan: pd.DataFrame, library: DanceLibrary) -> RatedTargets:
    """Turn the raters' words into targets: what the dances they called light, intense, easy or hard ask.

    Parameters
    ----------
    ratings : DataFrame
        One row an answer: `rater`, `window`, `intensity`, `variety`; see `RatingSheet.ratings`.
    plan : DataFrame
        The plan that was rated.
    library : DanceLibrary
        The library that the plan was made for.

    Raises
    ------
    InputError
        If a window is not in the plan, the library has other segments than were rated, fewer than two people
        rated, a class has fewer than five windows, or the windows called intense (hard) have on average less
        of it than those called light (easy).

    Notes
    -----
    The class of a window is what most of its raters said. The interval of the agreement does not depend on
    the order of the ratings.
    """
    chains = {
        int(window): tuple(segments)
        for window, segments in zip(plan["window"], plan["segments"], strict=True)
    }
    strangers = sorted(set(ratings["window"]) - set(chains))
    if strangers:
        raise InputError(
            f"window {strangers[0]} is not in the plan",
            where="ratings",
            remedy="give the plan that these ratings belong to",
        )
    if set(plan["library"]) != {segments_digest(library)}:
        raise InputError(
            "these ratings are about other segments than the library has now",
            where=library.name,
            remedy="rate it again, or give the library as it was",
        )
    windows = sorted(set(ratings["window"]))
    for window in windows:
        require_window(library, chains[window])
    tables = {scale: _coded(ratings, scale, windows) for scale in SCALES}
    agreement = {scale: krippendorff_alpha(table) for scale, table in tables.items()}
    measured = window_measures(library, np.array([chains[window] for window in windows], dtype=np.int64))
    means: dict[str, dict[str, float]] = {}
    counts: dict[str, int] = {}
    for scale, (less, more) in SCALES.items():
        share = np.nanmean(tables[scale], axis=0)
        classes = {less: share < 0.5, more: share > 0.5}
        counts |= {label: int(own.sum()) for label, own in classes.items()}
        counts[f"undecided_{scale}"] = int((share == 0.5).sum())
        means |= {name: _class_means(measured[name], classes, name) for name in _MEASURES[scale]}
    return RatedTargets(
        **means,
        spreads={name: float(values.std(ddof=1)) for name, values in measured.items()},
        counts=counts,
        agreement=agreement,
        library_sha256=library.sha256,
    )


def _class_means(values: Floats, classes: Mapping[str, Booleans], name: str) -> dict[str, float]:
    """Give the mean of each class, the lesser first; refuse small classes and those the wrong way round."""
    for label, own in classes.items():
        if own.sum() < LEAST_WINDOWS:
            raise InputError(
                f'most raters called {own.sum()} windows "{label}"; a target needs {LEAST_WINDOWS}',
                where="ratings",
                remedy="rate more windows",
            )
    means = {label: float(values[own].mean()) for label, own in classes.items()}
    less, more = means
    if means[more] <= means[less]:
        raise InputError(
            f'windows called "{more}" have no more {name.replace("_", " ")} than those called "{less}"',
            where="ratings",
            remedy="see that the raters meant the words alike, or rate more windows",
        )
    return means


def _coded(ratings: pd.DataFrame, scale: str, windows: Sequence[int]) -> Floats:
    """Give the answers as 0 (less) and 1 (more), shape (rater, window); NaN where there is none."""
    codes = {word: code for code, word in enumerate(SCALES[scale])}
    raters = sorted(set(ratings["rater"]))
    table = np.full((len(raters), len(windows)), np.nan)
    places = {window: column for column, window in enumerate(windows)}
    rows = {rater: row for row, rater in enumerate(raters)}
    for rater, window, word in zip(ratings["rater"], ratings["window"], ratings[scale], strict=True):
        if word not in codes:
            raise InputError(
                f'"{word}" is no answer about {scale}', where="ratings", remedy=f"use {' or '.join(codes)}"
            )
        table[rows[rater], places[window]] = codes[word]
    return table
