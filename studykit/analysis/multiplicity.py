"""Correct p values where several tests could each be wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from studykit.core.arrays import Floats


def _adjusted(p: Sequence[float] | Floats, method: str) -> Floats:
    import pingouin

    values = np.asarray(p, dtype=np.float64)
    if not values.size:
        return values
    return np.asarray(pingouin.multicomp(values, method=method)[1], dtype=np.float64)


def holm(p: Sequence[float] | Floats) -> Floats:
    """Correct p values for testing several pairs, stepwise (Holm 1979), shape (test,).

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03]).round(2).tolist()
    [0.03, 0.06, 0.06]
    """
    return _adjusted(p, "holm")


def bonferroni(p: Sequence[float] | Floats) -> Floats:
    """Correct p values for testing several pairs by their number, shape (test,)."""
    return _adjusted(p, "bonf")
