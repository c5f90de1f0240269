"""A small model of one outcome: enough to make up studies that could have been."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.protocol.study_protocol import StudyProtocol

if TYPE_CHECKING:
    import pandas as pd

_ROUNDING_VARIANCE = 1.0 / 12.0


@dataclass(frozen=True, kw_only=True, slots=True)
class OutcomeModel:
    """How an outcome depends on condition, person and order, and how much of it gets lost.

    Parameters
    ----------
    outcome : str
        A column of trials.csv.
    means : mapping
        Condition to its mean over people, in the outcome's unit.
    between_sd, within_sd : float
        Standard deviation between people, and between one person's trials of the same condition.
    period_slope : float
        What each further period adds.
    carry_over : float
        Share of the difference of a condition from the mean of all that is still there in the next period.
    lost : float
        Share of trials without a value, 0 to 1.
    scale : tuple of int or None
        Lowest and highest tick of a rating; values are rounded to whole ticks. None for a measured number.

    Raises
    ------
    ValueError
        If a number is not finite, a spread negative, or a share out of its range.

    Notes
    -----
    y = mean(condition) + slope (period - 1) + carry_over (mean(previous) - mean of all) + person + error,
    with normal person and error; the first period has no carry-over.
    """

    outcome: str
    means: Mapping[str, float]
    between_sd: float
    within_sd: float
    period_slope: float = 0.0
    carry_over: float = 0.0
    lost: float = 0.0
    scale: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        numbers = (*self.means.values(), self.between_sd, self.within_sd, self.period_slope, self.carry_over)
        if not all(map(math.isfinite, numbers)):
            raise ValueError("all numbers of a model must be finite")
        if self.between_sd < 0.0 or self.within_sd < 0.0:
            raise ValueError("a standard deviation cannot be negative")
        if not 0.0 <= self.lost < 1.0:
            raise ValueError(f"lost is {self.lost}, expected 0 to below 1")

    def draw(
        self, orders: Integers, conditions: Sequence[str], *, studies: int, rng: np.random.Generator
    ) -> Floats:
        """Make up the values of studies in which people dance in given orders.

        Parameters
        ----------
        orders : ndarray, shape (person, period)
            Which condition each person dances when, as a place in `conditions`.
        conditions : sequence of str
            Their names.
        studies : int
            How many studies.
        rng : numpy.random.Generator
            People, errors and losses.

        Returns
        -------
        ndarray, shape (study, person, condition)
            NaN where a trial was lost; conditions in the order of `conditions`.

        Raises
        ------
        InputError
            If the model has no mean for a condition.
        """
        unknown = [name for name in conditions if name not in self.means]
        if unknown:
            raise InputError(
                f"the model of {self.outcome} has no mean for {', '.join(unknown)}",
                remedy="give one for every condition of the study",
            )
        means = np.array([self.means[name] for name in conditions])
        people, periods = orders.shape
        expected = means[orders] + self.period_slope * np.arange(periods)
        expected[:, 1:] += self.carry_over * (means - means.mean())[orders[:, :-1]]
        values = (
            expected
            + self.between_sd * rng.normal(size=(studies, people, 1))
            + self.within_sd * rng.normal(size=(studies, people, periods))
        )
        if self.scale is not None:
            values = np.clip(np.round(values), *self.scale)
        if self.lost:
            values[rng.random(values.shape) < self.lost] = np.nan
        by_condition: Floats = np.empty_like(values)
        np.put_along_axis(by_condition, np.broadcast_to(orders, values.shape), values, axis=2)
        return by_condition


def model_of(
    trials: pd.DataFrame,
    outcome: str,
    *,
    scale: tuple[int, int] | None = None,
    with_order: bool = False,
) -> OutcomeModel:
    """Estimate the model of an outcome from the trials of a pilot, real or simulated.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, columns of `tables.TRIALS`; only valid trials count.
    outcome : str
        The column.
    scale : tuple of int, optional
        Lowest and highest tick, if it is a rating.
    with_order : bool
        Estimate period and carry-over too; small pilots know little about them.

    Returns
    -------
    OutcomeModel
        Means are those of least squares over conditions and people (and order); the spread between people is
        that of their means, less what trials add to it.

    Raises
    ------
    InputError
        If there are fewer than two people with two values, or a condition without any.
    """
    kept = trials[trials["is_valid"] & trials[outcome].notna()]
    conditions = sorted(trials["condition"].unique())
    missing = [name for name in conditions if name not in set(kept["condition"])]
    if missing:
        raise InputError(
            f"nobody has a value of {outcome} in {', '.join(missing)}",
            remedy="give a pilot of all conditions",
        )
    design = _design(kept, outcome, conditions, with_order=with_order)
    y = kept[outcome].to_numpy(np.float64)
    _, who = np.unique(kept["participant"].to_numpy(), return_inverse=True)
    each = np.bincount(who)
    y_of_person = np.bincount(who, y) / each
    design_of_person = np.stack([np.bincount(who, column) for column in design.T], axis=1) / each[:, None]
    within_design = design - design_of_person[who]
    coefficients, _, rank, _ = np.linalg.lstsq(within_design, y - y_of_person[who], rcond=None)
    freedom = len(y) - int(rank) - len(each)
    if freedom < 1 or len(each) < 2:
        raise InputError(
            f"{len(each)} people with {len(y)} values of {outcome} tell no spread",
            remedy="give a pilot of two people or more who danced all conditions",
        )
    errors = y - y_of_person[who] - within_design @ coefficients
    within = float(np.sum(errors**2)) / freedom
    persons = y_of_person - design_of_person @ coefficients
    between = max(0.0, float(persons.var(ddof=1)) - within * float(np.mean(1.0 / each)))
    slope, carry = coefficients[-2:] if with_order else (0.0, 0.0)
    means = coefficients[: len(conditions)] + persons.mean()
    return OutcomeModel(
        outcome=outcome,
        means={name: float(mean) for name, mean in zip(conditions, means, strict=True)},
        between_sd=math.sqrt(between),
        within_sd=math.sqrt(max(0.0, within - (_ROUNDING_VARIANCE if scale else 0.0))),
        period_slope=float(slope),
        carry_over=float(carry),
        lost=1.0 - len(kept) / len(trials),
        scale=scale,
    )


def models_of(
    protocol: StudyProtocol, trials: pd.DataFrame, *, with_order: bool = False
) -> tuple[OutcomeModel, ...]:
    """Estimate the model of every outcome that the protocol's tests compare and the trials hold.

    Parameters
    ----------
    protocol : StudyProtocol
        Gives the tests, and the scale of ratings.
    trials : DataFrame
        Of a pilot, real or simulated; see `model_of`.
    with_order : bool
        Estimate period and carry-over too.

    Raises
    ------
    InputError
        As `model_of`, or if the trials hold none of the outcomes.
    """
    outcomes = dict.fromkeys(test.outcome for test in protocol.analysis.tests)
    scales = {"smoothness_rating": protocol.questionnaires.smoothness.scale}
    held = [name for name in outcomes if name in trials.columns and trials[name].notna().any()]
    if not held:
        raise InputError(
            f"the pilot holds none of {', '.join(outcomes) or 'the outcomes of declared tests'}",
            remedy="give trials in which they were measured",
        )
    return tuple(model_of(trials, name, scale=scales.get(name), with_order=with_order) for name in held)


def _design(kept: pd.DataFrame, outcome: str, conditions: Sequence[str], *, with_order: bool) -> Floats:
    """Give one column a condition, then period and what the previous condition leaves, if asked."""
    design = (kept["condition"].to_numpy()[:, None] == np.array(conditions)).astype(np.float64)
    if not with_order:
        return np.asarray(design)
    means = kept.groupby("condition")[outcome].mean()
    before = kept["previous_condition"].map(means - means.mean()).fillna(0.0).to_numpy(np.float64)
    return np.column_stack([design, kept["period"].to_numpy(np.float64) - 1.0, before])
