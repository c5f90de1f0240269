"""Figures of cleaning: glitches stand where they are, and takes are counted right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from studykit.core.errors import InputError
from studykit.figures import cleaning, yield_by_take
from studykit.figures.style import SYNTHETIC, in_style
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

GLITCH = 200


def take(*, frames: int = 400, glitch: bool = True) -> Motion:
    times = np.arange(frames)[:, None, None] / 30.0
    turns = np.random.default_rng(1).normal(scale=0.3, size=(1, 24, 3)) * np.sin(3.0 * times)
    if glitch:
        turns[GLITCH, NEUTRAL_BODY.index("left_shoulder")] += [0.0, 2.5, 0.0]
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(turns),
        root_positions=np.tile([0.0, 1.0, 0.0], (frames, 1)),
        frame_rate_hz=30.0,
    )


def stretches(figure, gid: str) -> list[tuple[float, float]]:
    (bars,) = (one for one in figure.axes[-1].collections if one.get_gid() == gid)
    return [(float(path.vertices[:, 0].min()), float(path.vertices[:, 0].max())) for path in bars.get_paths()]


def test_a_glitch_is_flagged_where_it_is_and_parts_the_segments() -> None:
    figure = cleaning(take(), take="arm/01")
    (flagged,) = stretches(figure, "flagged robust")
    assert flagged[0] <= GLITCH / 30.0 < flagged[1]
    kept = stretches(figure, "kept robust")
    assert len(kept) == 2  # 6.6 s before, 6.6 s behind: one of 4 s each
    assert all(end < flagged[0] or start > flagged[1] for start, end in kept)
    assert any("Robust rule: 2 of 3 segments" in text.get_text() for text in figure.axes[-1].texts)
    for axes in figure.axes[:2]:
        (over,) = (one for one in axes.collections if one.get_gid() == "over")
        assert np.all(np.abs(over.get_offsets()[:, 0] - GLITCH / 30.0) < 0.1)
        assert any(text.get_text().startswith("left ") for text in axes.texts)


def test_without_a_glitch_nothing_is_over_the_robust_limits() -> None:
    figure = cleaning(take(glitch=False))
    assert stretches(figure, "flagged robust") == []
    assert len(stretches(figure, "kept robust")) == 3
    for axes in figure.axes[:2]:
        (over,) = (one for one in axes.collections if one.get_gid() == "over")
        assert len(over.get_offsets()) == 0


def test_speed_is_read_off_in_metres_a_second() -> None:
    # A left forearm that turns at 2 rad/s: its hand goes at 2 times its distance from the elbow.
    turns = np.zeros((200, 24, 3))
    turns[:, NEUTRAL_BODY.index("left_elbow"), 1] = 2.0 * np.arange(200) / 30.0
    spinning = replace(
        take(frames=200, glitch=False), rotations=rotation.exp(turns), root_positions=np.zeros((200, 3))
    )
    figure = cleaning(spinning)
    (line,) = (one for one in figure.axes[0].lines if one.get_gid() == "worst joint")
    reach = NEUTRAL_BODY.offsets[[20, 22]].sum(axis=0)
    assert line.get_ydata()[100] == pytest.approx(2.0 * np.hypot(reach[0], reach[2]), rel=1e-3)


def test_another_frame_rate_shows_the_same_time() -> None:
    doubled = replace(take(frames=800, glitch=False), frame_rate_hz=60.0)
    assert cleaning(doubled).axes[0].get_xlim() == pytest.approx((0.0, 800 / 60.0), abs=0.05)


def test_a_pelvis_that_jumps_is_seen_though_no_joint_does() -> None:
    still = take(glitch=False)
    way = np.array(still.root_positions)
    way[GLITCH] += [2.0, 0.0, 0.0]
    figure = cleaning(replace(still, root_positions=way))
    assert len(stretches(figure, "flagged robust")) == 1
    (pelvis,) = (one for one in figure.axes[0].lines if one.get_gid() == "pelvis")
    assert max(pelvis.get_ydata()) == pytest.approx(60.0)


def test_a_take_of_three_seconds_has_nothing_to_clean() -> None:
    with pytest.raises(InputError, match=r"short: the take lasts 3\.00 s"):
        cleaning(take(frames=90, glitch=False), take="short")


def takes(count: int) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "take": [f"take/{number:03d}" for number in range(count)],
            "segments_possible": 10,
            "segments_kept": [(number * 7) % 11 for number in range(count)],
            "segments_paper": 1,
        }
    )


def test_the_worst_takes_come_first_and_no_more_than_fit() -> None:
    table = takes(60)
    figure = yield_by_take(table, rows=12)
    (axes,) = figure.axes
    widths = [bar.get_width() for bar in axes.patches]
    assert widths == sorted(widths)
    assert widths == pytest.approx(sorted(10.0 * table["segments_kept"])[:12])
    kept = int(table["segments_kept"].sum())
    assert (
        axes.get_title(loc="left")
        == f"The 12 worst of 60 takes; {kept} of 600 segments of all takes are kept"
    )
    assert axes.texts[0].get_text() == "0 / 10"


def test_a_table_without_a_segment_is_said() -> None:
    with pytest.raises(InputError, match="no take has a segment"):
        yield_by_take(takes(3).assign(segments_possible=0))


def test_overlapping_segments_may_be_more_than_fit_side_by_side() -> None:
    (axes,) = yield_by_take(takes(3).assign(segments_kept=25)).axes
    assert axes.get_xlim()[1] == pytest.approx(250.0)


def test_synthetic_takes_say_so_and_no_word_leaves_the_sheet() -> None:
    for figure in (cleaning(take(), take="x", synthetic=True), yield_by_take(takes(45), synthetic=True)):
        assert figure.get_suptitle() == SYNTHETIC
        figure.file_bytes("svg")
        with in_style():
            inches = figure.get_tightbbox()
        assert min(inches.x0, inches.y0) >= 0.0
        assert inches.x1 <= figure.get_figwidth()
        assert inches.y1 <= figure.get_figheight()
