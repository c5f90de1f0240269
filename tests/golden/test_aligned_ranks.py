"""The aligned rank transform against R's aov with the right error terms (aligned_ranks.R)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from studykit.analysis import aligned_ranks as own
from studykit.analysis.aligned_ranks import aligned_ranks, contrasts_of_aligned_ranks

GOLDEN: dict[str, Any] = json.loads(Path(__file__).with_name("aligned_ranks.json").read_text())
DATA = ("ratings", "numbers")


def matches(name: str) -> None:
    """Check every effect of the data of that name."""
    expected = GOLDEN[name]
    found = aligned_ranks(pd.DataFrame(expected["data"]), "value", expected["factors"])
    assert [effect.effect for effect in found] == list(expected["effects"])
    for effect in found:
        golden = expected["effects"][effect.effect]
        assert effect.df == tuple(golden["df"])
        assert effect.f == pytest.approx(golden["f"], rel=1e-8)
        assert effect.p == pytest.approx(golden["p"], abs=1e-10)
        assert effect.partial_eta_squared == pytest.approx(golden["partial_eta_squared"], abs=1e-10)


@pytest.mark.parametrize("name", DATA)
def test_every_effect_has_the_f_the_degrees_of_freedom_and_the_p_of_aov(name: str) -> None:
    matches(name)


@pytest.mark.parametrize("name", DATA)
def test_contrasts_are_those_of_art_c(name: str) -> None:
    expected = GOLDEN[name]
    found = contrasts_of_aligned_ranks(
        pd.DataFrame(expected["data"]), "value", expected["factors"], of=expected["of"]
    )
    for contrast, golden in zip(found, expected["contrasts"], strict=True):
        assert (contrast.a, contrast.b, contrast.df) == (golden["a"], golden["b"], golden["df"])
        assert contrast.t == pytest.approx(golden["t"], rel=1e-8)
        assert contrast.p == pytest.approx(golden["p"], abs=1e-10)


def test_one_error_for_all_effects_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: Error(participant) alone pools everything within participants into one error.
    right = own._tested

    def pooled(cells: Any, effect: Any, contrasts: Any) -> Any:
        everything = np.column_stack((contrasts, np.eye(len(contrasts))[:, : -contrasts.shape[1]]))
        return right(cells, effect, everything)

    monkeypatch.setattr(own, "_tested", pooled)
    with pytest.raises(AssertionError):
        matches("ratings")


def test_ranks_that_are_not_aligned_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # Wrong on purpose: plain ranks carry one effect into another's test.
    monkeypatch.setattr(own, "align", lambda values, effect: values)
    monkeypatch.setattr(own, "_refuse_misaligned", lambda aligned, others: None)
    with pytest.raises(AssertionError):
        matches("numbers")
