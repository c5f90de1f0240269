"""The framework: laid out from its stages, which are those of the program."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.core.errors import InputError
from studykit.figures import Stage, framework
from studykit.figures.overview import stage_columns
from studykit.reports.pipeline import PIPELINE


@st.composite
def graphs(draw: st.DrawFn) -> list[Stage]:
    count = draw(st.integers(1, 9))
    stages = []
    for number in range(count):
        before = draw(st.sets(st.integers(0, number - 1))) if number else set()
        stages.append(
            Stage(
                name=str(number), words="", lane=draw(st.sampled_from("ab")), module="",
                after=tuple(str(one) for one in sorted(before)),
            )
        )  # fmt: skip
    return draw(st.permutations(stages))


@given(graphs())
def test_a_stage_stands_right_of_all_that_it_takes_in_its_lane_and_no_further(stages: list[Stage]) -> None:
    columns = stage_columns(stages)
    known = {stage.name: stage for stage in stages}
    for stage in stages:
        before = [columns[one] for one in stage.after if known[one].lane == stage.lane]
        assert columns[stage.name] == (max(before) + 1 if before else 0)


def test_every_stage_is_done_where_it_says() -> None:
    for stage in PIPELINE:
        assert find_spec(stage.module) is not None, stage.module


def test_every_stage_is_a_box_and_everything_taken_an_arrow() -> None:
    axes = framework(PIPELINE).axes[0]
    boxes = {patch.get_gid() for patch in axes.patches if patch.get_gid()}
    assert boxes == {f"stage {stage.name}" for stage in PIPELINE}
    arrows = {line.get_gid() for line in axes.lines}
    assert arrows == {f"{source} to {stage.name}" for stage in PIPELINE for source in stage.after} | {
        f"{stage.name} back to {stage.again}" for stage in PIPELINE if stage.again
    }


def test_boxes_do_not_cover_each_other() -> None:
    axes = framework(PIPELINE).axes[0]
    boxes = [patch.get_window_extent() for patch in axes.patches if patch.get_gid()]
    assert not any(a.overlaps(b) for place, a in enumerate(boxes) for b in boxes[:place])


def test_words_stay_in_their_boxes() -> None:
    figure = framework(PIPELINE)
    axes = figure.axes[0]
    figure.draw_without_rendering()
    inside = {str(stage.words) for stage in PIPELINE}
    boxes = {patch.get_gid(): patch.get_window_extent() for patch in axes.patches if patch.get_gid()}
    by_words = {stage.words: boxes[f"stage {stage.name}"] for stage in PIPELINE}
    for text in axes.texts:
        if text.get_text() in inside:
            extent, box = text.get_window_extent(), by_words[text.get_text()]
            assert box.x0 <= extent.x0
            assert extent.x1 <= box.x1


@pytest.mark.parametrize(
    ("change", "problem"),
    [({"after": ("nobody",)}, 'no stage "nobody"'), ({"again": "nobody"}, 'no stage "nobody"')],
)
def test_a_stage_that_names_no_other_is_refused(change: dict[str, object], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        stage_columns([replace(PIPELINE[0], **change)])  # type: ignore[arg-type]


def test_a_circle_is_refused() -> None:
    one = Stage(name="one", words="", lane="a", module="", after=("two",))
    with pytest.raises(InputError, match="waits for itself"):
        stage_columns([one, replace(one, name="two", after=("one",))])


def test_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="there is no stage"):
        framework([])
