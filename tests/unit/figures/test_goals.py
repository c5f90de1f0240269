from __future__ import annotations

from collections.abc import Callable

import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import asked_and_achieved, targets_and_achieved
from studykit.figures.style import SYNTHETIC, in_style


def test_every_dance_stands_where_it_came(made_dances: Callable[..., pd.DataFrame]) -> None:
    dances = made_dances()
    figure = asked_and_achieved(dances, body_mass_kg=100.0)
    for axes, goal, factor in zip(
        figure.axes, ("linear_energy", "rotational_energy", "variety"), (100.0, 100.0, 1.0), strict=True
    ):
        drawn = {c.get_gid(): float(c.get_offsets()[0, 0]) for c in axes.collections if c.get_gid()}
        for _, dance in dances.iterrows():
            assert drawn[f"dance {dance['condition']}"] == pytest.approx(factor * dance[f"{goal}_achieved"])


def test_synthetic_movement_says_so(made_dances: Callable[..., pd.DataFrame]) -> None:
    assert asked_and_achieved(made_dances(is_synthetic=True)).get_suptitle() == SYNTHETIC
    assert asked_and_achieved(made_dances(is_synthetic=False)).get_suptitle() == ""


def test_no_dance_is_said(made_dances: Callable[..., pd.DataFrame]) -> None:
    with pytest.raises(InputError, match="no dance to show"):
        asked_and_achieved(made_dances().iloc[:0])


@pytest.mark.parametrize("dots_per_inch", [50, 72, 100, 200, 300])
def test_no_word_leaves_the_sheet(made_dances: Callable[..., pd.DataFrame], dots_per_inch: int) -> None:
    figure = asked_and_achieved(made_dances())
    figure.file_bytes("svg")
    figure.set_dpi(dots_per_inch)
    with in_style():
        inches = figure.get_tightbbox()
    assert min(inches.x0, inches.y0) >= 0.0
    assert inches.x1 <= figure.get_figwidth()
    assert inches.y1 <= figure.get_figheight()


def test_dances_stand_where_they_came_with_what_they_miss(made_dance) -> None:
    dances = [made_dance(), made_dance(condition="intense-hard-off")]
    figure = targets_and_achieved(dances, body_mass_kg=100.0)
    for axes, goal, factor, miss in zip(
        figure.axes,
        ("linear_energy", "rotational_energy", "variety"),
        (100.0, 100.0, 1.0),
        ("+25.0 %", "−20.0 %", "+2.0 %"),
        strict=True,
    ):
        drawn = {c.get_gid(): float(c.get_offsets()[0, 0]) for c in axes.collections if c.get_gid()}
        (asked,) = (c for c in axes.collections if c.get_gid() == "asked")
        for row, dance in enumerate(dances):
            wanted, achieved, shown = (
                factor * getattr(getattr(dance, kind), goal)
                for kind in ("asked", "achieved", "achieved_blended")
            )
            assert drawn[f"dance {dance.condition}"] == pytest.approx(achieved)
            assert drawn["shown"] == pytest.approx(shown)
            assert asked.get_segments()[row][:, 0] == pytest.approx(wanted)
        # Wrong: what segments miss by themselves (+12.5 and -12 %), before the joins.
        assert [text.get_text() for text in axes.texts if text.get_gid() == "miss"] == [miss, miss]


def test_blocks_have_rows_of_their_own_in_energy_a_second(made_dance) -> None:
    dance = made_dance("ABCC", blocks=2)
    first, axes, _ = targets_and_achieved([dance], body_mass_kg=1.0).axes
    dots = [c for c in axes.collections if str(c.get_gid()).startswith("dance ")]
    drawn = [float(dot.get_offsets()[0, 0]) for dot in dots]
    asked = [dance.achieved, *(block.achieved for block in dance.blocks)]
    assert drawn == pytest.approx([part.rotational_energy / part.duration_s for part in asked])
    labels = [text.get_text() for text in first.get_yticklabels()]
    assert labels == ["Light – Easy,\ntransition on", "0–8 s", "8–16 s"]
    assert "J/s" in axes.get_xlabel()


def test_a_single_miss_does_not_fill_the_panel(made_dance) -> None:
    dance = made_dance()
    near = targets_and_achieved([made_dance(asked=dance.achieved)], body_mass_kg=1.0).axes[2]
    low, high = near.get_xlim()
    assert high - low >= 0.19 * dance.achieved.variety
    with pytest.raises(InputError, match="no dance to show"):
        targets_and_achieved([])
