"""How much people enjoyed themselves, from the Physical Activity Enjoyment Scale (PACES)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.protocol.questionnaire import HIGHEST, LOWEST, PACES, PACES_NAME, Item

FIVE_ITEMS: tuple[Item, ...] = tuple(item for item in PACES if item.number in {1, 3, 6, 10, 12})
"""The five items that exergame studies of older adults used (Graves et al. 2010)."""

# Up to two of the 18 answers may be left out; of a short form, none.
_ITEMS_PER_MISSING_ANSWER = 9


@dataclass(frozen=True, kw_only=True, slots=True)
class Enjoyment:
    """Somebody's enjoyment in the four ways in which studies print it; higher is more.

    Parameters
    ----------
    total : float
        Sum over the items, pleasant pole high: 18 to 126 for 18 items.
    percent_of_maximum : float
        100 total / highest total. The lowest possible is 14.3 %.
    percent_of_range : float
        100 (total - lowest) / (highest - lowest), 0 to 100 %.
    item_mean : float
        1 to 7.
    answered : int
        Items answered; those left out (two of 18 at most) take the mean of the others.
    version : str
        Which form of the scale.
    """

    total: float
    percent_of_maximum: float
    percent_of_range: float
    item_mean: float
    answered: int
    version: str


def keyed(answers: Mapping[str, float | None], *, items: tuple[Item, ...] = PACES) -> Floats:
    """Turn answers round where the pleasant pole is the left one, so that 7 is always the most pleasant.

    Parameters
    ----------
    answers : mapping of str to float or None
        The answer to each item, 1 to 7, under its name (``item_01``); None, NaN or no entry if left out.
    items : tuple of Item
        The items of the form.

    Returns
    -------
    ndarray, shape (item,)
        NaN where an answer was left out.

    Raises
    ------
    InputError
        If an answer is not a whole number from 1 to 7; it names the item.
    """
    turned = np.full(len(items), np.nan)
    for place, item in enumerate(items):
        answer = answers.get(item.name)
        if answer is None or np.isnan(answer):
            continue
        if answer != int(answer) or not LOWEST <= answer <= HIGHEST:
            raise InputError(
                f"the answer is {answer:g}",
                where=item.name,
                remedy=f"give a whole number from {LOWEST} to {HIGHEST}",
            )
        turned[place] = item.keyed(int(answer))
    return turned


def score(answers: Mapping[str, float | None], *, items: tuple[Item, ...] = PACES) -> Enjoyment | None:
    """Sum somebody's answers to the enjoyment scale.

    Parameters
    ----------
    answers : mapping of str to float or None
        See `keyed`.
    items : tuple of Item
        The items of the form: all 18, or `FIVE_ITEMS`.

    Returns
    -------
    Enjoyment or None
        None if more than two of 18 answers (any of five) were left out.

    Notes
    -----
    Kendzierski & DeCarlo 1991 (doi 10.1123/jsep.13.1.50). Both percentages are given because papers print
    either without saying which.

    Examples
    --------
    Ticking the middle throughout:

    >>> score({f"item_{number:02d}": 4 for number in range(1, 19)}).total
    72.0
    """
    turned = keyed(answers, items=items)
    answered = int(np.isfinite(turned).sum())
    if len(items) - answered > len(items) // _ITEMS_PER_MISSING_ANSWER:
        return None
    mean = float(np.nanmean(turned))
    return Enjoyment(
        total=mean * len(items),
        percent_of_maximum=100.0 * mean / HIGHEST,
        percent_of_range=100.0 * (mean - LOWEST) / (HIGHEST - LOWEST),
        item_mean=mean,
        answered=answered,
        version=PACES_NAME if items == PACES else f"{len(items)} items of {PACES_NAME}",
    )


def cronbach_alpha(keyed_answers: Floats) -> float | None:
    """Tell how consistently the items of a scale measure one thing (Cronbach's alpha).

    Parameters
    ----------
    keyed_answers : array_like, shape (person, item)
        Answers with the pleasant pole high (`keyed`); people who left one out are not used.

    Returns
    -------
    float or None
        1 at best. None with fewer than two people or items, or if all people have the same total.

    Notes
    -----
    k / (k - 1) (1 - sum of the items' variances / variance of the total).
    """
    values = np.asarray(keyed_answers, dtype=np.float64)
    if values.ndim != 2:
        raise ValueError(f"keyed_answers has the shape {values.shape}, expected (person, item)")
    values = values[np.isfinite(values).all(axis=1)]
    people, items = values.shape
    if people < 2 or items < 2:
        return None
    of_total = values.sum(axis=1).var(ddof=1)
    if of_total == 0.0:
        return None
    return float(items / (items - 1) * (1.0 - values.var(axis=0, ddof=1).sum() / of_total))
