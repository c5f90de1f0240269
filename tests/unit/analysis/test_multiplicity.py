from __future__ import annotations

from studykit.analysis.multiplicity import bonferroni, holm


def test_correcting_nothing_gives_nothing() -> None:
    assert holm([]).tolist() == bonferroni([]).tolist() == []
