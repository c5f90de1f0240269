"""Figures of a library: what is drawn is what was measured, and goals stand where they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.path import Path

from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.targets import goals
from studykit.core.errors import InputError
from studykit.figures import energy_distribution, joint_intensity, target_space, variety_distribution
from studykit.figures.canvas import PaperFigure
from studykit.figures.style import SYNTHETIC, in_style
from studykit.motion.skeleton import JOINT_NAMES
from studykit.protocol.study_protocol import StudyProtocol


@pytest.fixture(scope="module")
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    return made_library(40)


@pytest.fixture(scope="module")
def asked(small_protocol: StudyProtocol, library: DanceLibrary) -> dict[str, Goal]:
    return goals(small_protocol, library)  # of 4 s


def line_at(axes: Axes, gid: str) -> float:
    (line,) = (one for one in axes.lines if one.get_gid() == gid)
    return float(line.get_xdata()[0])


def shares_drawn(axes: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Give the heights of the bars of the segments, and their edges."""
    bars = [patch for patch in axes.patches if patch.get_gid() == "segments"]
    edges = [bar.get_x() for bar in bars] + [bars[-1].get_x() + bars[-1].get_width()]
    return np.array([bar.get_height() for bar in bars]), np.array(edges)


def test_segments_are_shown_as_if_danced_for_32_s(library, asked) -> None:
    figure = energy_distribution(library, goals=asked, body_mass_kg=100.0)
    for axes, energies in zip(
        figure.axes, (library.linear_energies, library.rotational_energies), strict=True
    ):
        heights, edges = shares_drawn(axes)
        counts, _ = np.histogram(100.0 * 8.0 * energies.sum(axis=1), edges)
        assert heights == pytest.approx(100.0 * counts / 40.0)
        assert heights.sum() == pytest.approx(100.0)


def test_goals_stand_where_they_are_asked_for_32_s(library, asked, small_protocol) -> None:
    figure = energy_distribution(library, goals=asked)
    for level in ("light", "intense"):
        percentile = getattr(small_protocol.dance.intensity, level)
        for axes, energy in zip(figure.axes, library.calibration.energy_targets(percentile), strict=True):
            assert line_at(axes, f"goal {level}") == pytest.approx(73.5 * energy)
    assert [line_at(axes, "paper light") for axes in figure.axes] == [56.5, 31.8]
    assert [line_at(axes, "paper intense") for axes in figure.axes] == [147.2, 106.5]
    without = energy_distribution(library)
    assert not [line for line in without.axes[0].lines if str(line.get_gid()).startswith("goal")]


def test_variety_and_its_targets_are_distances(library, asked, small_protocol) -> None:
    longer = small_protocol.model_copy(
        update={"dance": small_protocol.dance.model_copy(update={"duration_s": 8.0})}
    )
    figure = variety_distribution(library, goals=goals(longer, library))
    (axes,) = figure.axes
    easy = small_protocol.dance.variety.easy * library.calibration.median_distance
    assert line_at(axes, "goal easy") == pytest.approx(easy)
    assert (line_at(axes, "paper easy"), line_at(axes, "paper hard")) == (67.4, 143.1)
    low, high = axes.get_xlim()
    assert low == 0.0
    assert high > 143.1
    # A goal in the unit of the cosine has no place on an axis of distances, and one of 4 s asks for none.
    cosine = {
        name: replace(goal, preset=replace(goal.preset, variety="cosine"))
        for name, goal in goals(longer, library).items()
    }
    for without in (cosine, asked):
        drawn = variety_distribution(library, goals=without).axes[0].lines
        assert not [line for line in drawn if str(line.get_gid()).startswith("goal")]


def test_no_dance_leaves_the_outline(library, asked) -> None:
    figure = target_space(library, goals=asked, body_mass_kg=1.0)
    (axes,) = figure.axes
    (outline,) = (line.get_xydata() for line in axes.lines if line.get_gid() == "outline")
    energies = np.stack(
        [one.sum(axis=1) for one in (library.linear_energies, library.rotational_energies)], 1
    )
    rng = np.random.default_rng(0)
    dances = energies[rng.integers(40, size=(300, 8))].sum(axis=1)
    hull = Path(outline)
    assert hull.contains_points(dances).all()
    # The outline is no wider than it must be: its corners are dances of one segment.
    assert outline.max(axis=0) == pytest.approx(8.0 * energies.max(axis=0))
    assert outline.min(axis=0) == pytest.approx(8.0 * energies.min(axis=0))
    # Wrong: a segment for 4 s against dances of 32 s.
    assert not Path(outline / 8.0).contains_points(dances).any()
    drawn = {one.get_gid(): one.get_offsets() for one in axes.collections if one.get_gid()}
    assert drawn["paper intense"].tolist() == [[147.2, 106.5]]
    assert len(drawn["segments"]) == 40
    assert len(drawn["chains"]) == 200
    light = next(goal for name, goal in asked.items() if name.startswith("light"))
    assert tuple(drawn["goal light"][0]) == pytest.approx(
        (8 * light.measures.linear_energy, 8 * light.measures.rotational_energy)
    )


def with_windows(library: DanceLibrary) -> DanceLibrary:
    calibration = replace(
        library.calibration,
        window_linear_energies=[1.5, 2.5, 2.5],
        window_rotational_energies=[0.5, 1.5, 2.5],
        window_varieties=[90.0, 100.0, 130.0],
    )
    return replace(library, calibration=calibration)


def test_what_was_danced_in_one_go_is_shown_where_there_is_any(library) -> None:
    words = "32 s danced in one go"
    for draw in (energy_distribution, variety_distribution, target_space):
        for own, expected in ((library, False), (with_windows(library), True)):
            (legend,) = draw(own).legends
            assert (words in [text.get_text() for text in legend.get_texts()]) is expected
    few = energy_distribution(with_windows(library), body_mass_kg=2.0).axes[1].lines
    assert [list(line.get_xdata()) for line in few if line.get_gid() == "windows"] == [[1.0, 3.0, 5.0]]
    (axes,) = target_space(with_windows(library), body_mass_kg=2.0).axes
    (windows,) = (one for one in axes.collections if one.get_gid() == "windows")
    assert windows.get_offsets().tolist() == [[3.0, 1.0], [5.0, 3.0], [5.0, 5.0]]


def test_many_dances_are_shown_as_an_outline(library) -> None:
    calibration = replace(library.calibration, window_varieties=np.linspace(80.0, 160.0, 200))
    (axes,) = variety_distribution(replace(library, calibration=calibration)).axes
    assert [patch.get_gid() for patch in axes.patches] == ["chains", "windows"]


def test_two_segments_have_an_outline_too(made_library) -> None:
    (axes,) = target_space(made_library(2)).axes
    assert any(line.get_gid() == "outline" for line in axes.lines)


def test_the_shares_of_all_joints_make_a_whole(library) -> None:
    figure = joint_intensity(library)
    bars = [axes for axes in figure.axes if axes.patches and axes.get_xlabel()]
    for axes, energies in zip(bars, (library.linear_energies, library.rotational_energies), strict=True):
        widths = {bar.get_gid(): bar.get_width() for bar in axes.patches}
        assert set(widths) == set(JOINT_NAMES)
        assert sum(widths.values()) == pytest.approx(100.0)
        whole = energies.sum()
        for joint, name in enumerate(JOINT_NAMES):
            assert widths[name] == pytest.approx(100.0 * energies[:, joint].sum() / whole)


def test_the_dancers_left_is_on_the_right_of_the_body(library) -> None:
    alone = np.zeros((40, 24))
    alone[:, JOINT_NAMES.index("left_knee")] = 1.0
    figure = joint_intensity(replace(library, linear_energies=alone))
    (joints,) = (one for one in figure.axes[0].collections if one.get_gid() == "joints")
    largest = int(np.argmax(joints.get_sizes()))
    assert largest == JOINT_NAMES.index("left_knee")
    assert joints.get_offsets()[largest, 0] > 0.03


FIGURES = (energy_distribution, variety_distribution, target_space, joint_intensity)


@pytest.mark.parametrize("draw", FIGURES)
def test_synthetic_movement_says_so(draw: Callable[..., PaperFigure], library) -> None:
    assert draw(library).get_suptitle() == SYNTHETIC
    danced = replace(library, segments=library.segments.assign(is_synthetic=False))
    assert draw(danced).get_suptitle() == ""


@pytest.mark.parametrize("draw", FIGURES)
def test_an_empty_library_has_no_figure(draw: Callable[..., PaperFigure], library) -> None:
    nothing = replace(
        library,
        segments=library.segments.iloc[:0],
        linear_energies=library.linear_energies[:0],
        rotational_energies=library.rotational_energies[:0],
        successors=library.successors[:0],
    )
    with pytest.raises(InputError, match="made-up"):
        draw(nothing)


@pytest.mark.parametrize("draw", FIGURES)
def test_no_word_leaves_the_sheet(draw: Callable[..., PaperFigure], library, asked) -> None:
    figure = draw(library) if draw is joint_intensity else draw(with_windows(library), goals=asked)
    figure.file_bytes("svg")
    with in_style():
        inches = figure.get_tightbbox()
    assert min(inches.x0, inches.y0) >= 0.0
    assert inches.x1 <= figure.get_figwidth()
    assert inches.y1 <= figure.get_figheight()
