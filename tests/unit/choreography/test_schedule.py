"""Goals in time: ready-made blocks, and blocks that follow a heart rate."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.choreography.request import default_plan
from studykit.choreography.schedule import (
    SCHEDULES,
    BlockPlan,
    heart_rate_profile,
    hiit,
    schedule,
    variety_waves,
    warm_up,
)
from studykit.choreography.targets import scheduled
from studykit.core.errors import InputError


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(12)


def levels(blocks) -> list[tuple[object, object]]:
    return [(block.intensity, block.variety) for block in blocks]


def test_intervals_alternate_in_intensity_alone() -> None:
    assert levels(hiit()) == [("intense", "easy"), ("light", "easy")] * 2
    assert [block.duration_s for block in hiit(rounds=3, block_s=16.0)] == [16.0] * 6
    assert levels(hiit(rounds=1, variety="hard")) == [("intense", "hard"), ("light", "hard")]


def test_waves_alternate_in_variety_alone() -> None:
    assert levels(variety_waves()) == [("light", "easy"), ("light", "hard")] * 2
    assert levels(variety_waves(rounds=1, intensity=60.0)) == [(60.0, "easy"), (60.0, "hard")]


def test_a_warm_up_ends_as_it_begins_and_works_between() -> None:
    first, work, last = warm_up(work_s=96.0)
    assert first == last
    assert levels([first, work]) == [("light", "easy"), ("intense", "hard")]
    assert (first.duration_s, work.duration_s) == (32.0, 96.0)


@pytest.mark.parametrize("name", SCHEDULES)
def test_a_schedule_adds_up(library, name) -> None:
    blocks = schedule(name)
    one = scheduled(default_plan(), blocks, library, name=f"{name}-on")
    assert one.duration_s == sum(block.duration_s for block in blocks)
    assert one.segments == sum(block.segments for block in one.blocks) == one.duration_s / 4.0
    for total in ("linear_energy", "rotational_energy"):
        each = [getattr(block, total) for block in one.blocks]
        assert getattr(one.measures, total) == pytest.approx(sum(each))
    # Each block asks for what a dance of its own would ask for.
    for plan, block in zip(blocks, one.blocks, strict=True):
        assert scheduled(default_plan(), (plan,), library, name="one-on").blocks == (block,)


@given(segments=st.integers(2, 60), percentile=st.floats(0.0, 100.0))
def test_energy_grows_with_the_length_and_variety_does_not(library, segments, percentile) -> None:
    plans = [BlockPlan(duration_s=4.0 * n, intensity=percentile, variety=0.5) for n in (segments, 8)]
    one = scheduled(default_plan(), tuple(plans), library, name="two-on")
    block, usual = one.blocks
    assert block.linear_energy * 8 == pytest.approx(usual.linear_energy * segments)
    assert block.rotational_energy * 8 == pytest.approx(usual.rotational_energy * segments)
    assert block.variety == usual.variety
    assert block.novelty == usual.novelty


@given(
    light=st.floats(40.0, 120.0),
    gap=st.floats(5.0, 80.0),
    percentiles=st.lists(st.floats(1.0, 99.0), min_size=1, max_size=8),
)
def test_a_heart_rate_is_a_straight_line_through_the_quartiles(light, gap, percentiles) -> None:
    wanted = [light + (percentile - 25.0) / 50.0 * gap for percentile in percentiles]
    blocks = heart_rate_profile(wanted, light_bpm=light, intense_bpm=light + gap, block_s=16.0, variety=0.7)
    assert [block.intensity for block in blocks] == pytest.approx(percentiles, abs=1e-6)
    assert {(block.duration_s, block.variety) for block in blocks} == {(16.0, 0.7)}


def test_the_ends_of_a_heart_rate_profile_are_the_ends_of_the_library() -> None:
    blocks = heart_rate_profile([80.0, 160.0], light_bpm=100.0, intense_bpm=140.0)
    assert [block.intensity for block in blocks] == [0.0, 100.0]


@pytest.mark.parametrize("bpm", [79.9, 160.1, math.nan, math.inf])
def test_a_heart_rate_beyond_the_library_is_refused_with_what_is_possible(bpm) -> None:
    sentence = r"^block 2: .* beats a minute are beyond these dances; ask for 80 to 160\.$"
    with pytest.raises(InputError, match=sentence):
        heart_rate_profile([120.0, bpm], light_bpm=100.0, intense_bpm=140.0)


@pytest.mark.parametrize(
    ("light", "intense"),
    [(140.0, 100.0), (120.0, 120.0), (0.0, 100.0), (math.nan, 120.0), (90.0, math.nan), (90.0, math.inf)],
)
def test_a_heart_that_beats_no_faster_in_intense_dances_is_refused(light, intense) -> None:
    with pytest.raises(InputError, match=r"^light_bpm: light dances at .*; give what the heart .*\.$"):
        heart_rate_profile([120.0], light_bpm=light, intense_bpm=intense)


def test_an_unknown_schedule_is_refused_by_name() -> None:
    with pytest.raises(
        InputError, match=r'^schedule: there is no schedule "tabata"; choose from hiit, waves, warm-up\.$'
    ):
        schedule("tabata")
