"""The dance designer: what its settings ask for, what it says of a dance, what it offers out of reach."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from studykit.choreography.dance import DanceMeasures, DanceSegment
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Block
from studykit.choreography.reach import OutOfReachError
from studykit.core.errors import InputError
from studykit.motion import kinematics
from studykit.motion.blending import joined
from studykit.motion.joint_mask import spare
from studykit.motion.kinematics import joint_positions
from studykit.widgets import dance_designer, watch
from studykit.widgets.designer.settings import Settings
from studykit.widgets.designer.workshop import Workshop

HOSTILE = "<img src=x onerror=alert(1)>"


class StandIn:
    """In place of the choreography: goals without thought, dances without search, both remembered."""

    def __init__(self) -> None:
        self.words: list[dict[str, Any]] = []
        self.searches: list[tuple[int, bool]] = []

    def requested(self, library: DanceLibrary, **words: Any) -> Any:
        self.words.append(words)
        goal = self._goal(library, words, min(words["intensity"], 90.0))
        if words["intensity"] > 95.0:
            raise OutOfReachError(
                "no dance is as intense", where="intensity", remedy="ask for 90", nearest=goal
            )
        if words["intensity"] < 1.0:
            raise InputError("no dance is as still", where="intensity", remedy="ask for 10")
        return goal

    def _goal(self, library: DanceLibrary, words: dict[str, Any], percentile: float) -> Any:
        linear, rotational = library.calibration.energy_targets(percentile)
        share = words["duration_s"] / 32.0
        block = Block(
            duration_s=words["duration_s"],
            linear_energy=share * linear,
            rotational_energy=share * rotational,
            variety=words["variety"] * library.calibration.median_distance,
            novelty=None,
        )
        return SimpleNamespace(
            blocks=(block,), mask=words["spare"] or None, weights={}, variety_tolerance=5.0
        )

    def dance(self, goal: Any, library: DanceLibrary, *, seed: int, is_preview: bool) -> Any:
        self.searches.append((seed, is_preview))
        (block,) = goal.blocks
        asked = block.measures
        chosen = np.resize([seed % 7, seed % 7 + 1, seed % 7], round(asked.duration_s / 4.0)).tolist()
        rows = library.segments.iloc[chosen].to_dict("records")
        motion = joined([library.motion(segment) for segment in chosen], blend="offset")
        achieved = DanceMeasures(
            duration_s=asked.duration_s,
            linear_energy=1.03 * asked.linear_energy,
            rotational_energy=0.9 * asked.rotational_energy,
            variety=asked.variety,
        )
        return SimpleNamespace(
            condition="wish",
            seed=seed,
            motion=motion,
            is_synthetic=True,
            is_interrupted=False,
            mask=goal.mask,
            segments=tuple(
                DanceSegment(
                    id=segment,
                    take=row["take"],
                    start_s=row["start_s"],
                    mirrored=row["mirrored"],
                    licence=row["licence"],
                )
                for segment, row in zip(chosen, rows, strict=True)
            ),
            displacements_m=(0.05,) * (len(chosen) - 1),
            blocks=(SimpleNamespace(asked=asked, achieved=achieved, achieved_blended=achieved),),
        )


@pytest.fixture
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    return made_library(24, seed=5)


@pytest.fixture
def source() -> StandIn:
    return StandIn()


def test_it_begins_with_a_quick_look_that_plays(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    assert source.searches == [(0, True)]
    assert designer.found == "preview"
    np.testing.assert_allclose(designer.positions, joint_positions(designer.dance.motion), atol=1e-6)
    assert designer.is_synthetic
    assert not designer.is_playing


def test_a_setting_searches_a_preview_the_button_the_dance(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    designer.intensity = 40.0
    designer.transition = False
    assert source.words[-1]["intensity"] == 40.0
    assert source.words[-1]["transition"] == "off"
    assert source.searches == [(0, True)] * 3
    designer.search()
    assert source.searches[-1] == (0, False)
    assert (designer.found, designer.is_searching) == ("dance", False)
    designer.another()
    assert source.searches[-1] == (1, True)
    assert designer.found == "preview"


def test_values_that_cross_together_are_searched_once(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    designer.set_state({"intensity": 30.0, "variety": 0.9, "duration_s": 16.0})
    assert len(source.searches) == 2
    assert source.words[-1]["duration_s"] == 16.0


def test_the_body_map_asks_for_a_mask(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    designer.weights = {"right_elbow": 0.0}
    assert source.words[-1]["spare"].spared == ("right_elbow", "right_wrist", "right_hand")
    designer.speed_limits_rad_s = {"right_elbow": 1e-6}
    rows = {row["joint"]: row for row in designer.joint_report}
    assert not rows["right_hand"]["is_within"]
    assert rows["left_hand"] == {
        "joint": "left_hand",
        "peak_rad_s": rows["left_hand"]["peak_rad_s"],
        "limit_rad_s": None,
        "is_within": True,
    }
    motion = designer.dance.motion
    peaks = kinematics.angular_speeds(motion.rotations, motion.frame_rate_hz).max(axis=0)
    assert rows["left_hand"]["peak_rad_s"] == pytest.approx(peaks[22])


def test_a_joint_beyond_its_limit_is_named_first_and_nothing_is_called_close(
    library: DanceLibrary, source: StandIn
) -> None:
    designer = dance_designer(library, source=source)
    goal = designer.goal
    turned = kinematics.rest_angles(designer.dance.motion.rotations).max(axis=0)[15]
    exact = SimpleNamespace(**vars(designer.dance))
    exact.blocks = tuple(
        SimpleNamespace(asked=b.asked, achieved=b.asked, achieved_blended=b.asked) for b in exact.blocks
    )
    workshop = Workshop(library, source=source)
    for limit, said in ((0.9 * turned, "Beyond its limit: head."), (1.1 * turned, "All is close enough.")):
        goal.mask = spare("head", angle_limits_rad=limit)
        assert workshop.words(goal, exact, is_preview=True) == f"A quick look. {said}"
    goal.mask = spare("head", angle_limits_rad=0.9 * turned)
    assert workshop.words(goal, designer.dance, is_preview=False) == (
        "Found. Beyond its limit: head. Not close enough: rotational energy."
    )


def test_a_preview_that_is_refused_says_why(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)

    def refused(*_: Any, **__: Any) -> Any:
        raise InputError("head turns too fast in every dance", where="sample", remedy="allow more")

    source.dance = refused  # type: ignore[method-assign]
    designer.intensity = 40.0
    assert designer.obstacle == {
        "sentence": "sample: head turns too fast in every dance; allow more.",
        "has_offer": False,
    }
    assert (designer.found, designer.dance, designer.joint_report) == ("", None, [])


def test_targets_stand_beside_what_was_achieved(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    (block,) = designer.blocks
    rows = {row["name"]: row for row in block["measures"]}
    linear, _ = library.calibration.energy_targets(75.0)
    assert rows["linear energy"]["asked"] == pytest.approx(73.5 * linear)
    assert rows["linear energy"]["achieved"] == pytest.approx(73.5 * 1.03 * linear)
    assert {name: row["is_hit"] for name, row in rows.items()} == {
        "duration": True,
        "linear energy": True,
        "rotational energy": False,
        "variety": True,
    }
    assert rows["rotational energy"]["verdict"] == "10.0% below, farther than asked"
    assert rows["variety"]["verdict"] == "as asked"
    assert designer.status == "A quick look. Not close enough: rotational energy."


def test_segments_that_come_back_have_the_same_letter(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source, duration_s=16.0)
    assert [row["letter"] for row in designer.segments] == ["A", "B", "A", "A"]
    assert [row["start_s"] for row in designer.segments] == [0.0, 4.0, 8.0, 12.0]
    assert [row["jump_cm"] for row in designer.segments] == [None, 5.0, 5.0, 5.0]


def test_out_of_reach_is_said_and_nothing_plays(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    designer.intensity = 99.0
    assert designer.obstacle == {
        "sentence": "no dance is as intense; ask for 90.",
        "has_offer": True,
    }
    assert (designer.found, designer.dance, designer.goal, len(designer.positions)) == ("", None, None, 0)
    assert (designer.blocks, designer.targets) == ([], {})
    designer.intensity = 0.0
    assert designer.obstacle == {
        "sentence": "intensity: no dance is as still; ask for 10.",
        "has_offer": False,
    }
    designer.intensity = 50.0
    assert designer.obstacle == {}
    assert designer.found == "preview"


@pytest.mark.parametrize("duration_s", [16.0, 32.0, 64.0])
def test_the_nearest_goal_is_taken_exactly_and_the_sliders_come_near(
    library: DanceLibrary, source: StandIn, duration_s: float
) -> None:
    designer = dance_designer(library, source=source, duration_s=duration_s, variety=0.713)
    designer.intensity = 99.0
    designer.use_nearest()
    linear, rotational = library.calibration.energy_targets(90.0)
    (block,) = designer.goal.blocks
    assert (block.linear_energy, block.rotational_energy) == (
        pytest.approx(linear * duration_s / 32.0),
        pytest.approx(rotational * duration_s / 32.0),
    )
    assert (designer.intensity, designer.variety, designer.duration_s) == (90.0, 0.71, duration_s)
    assert block.variety == pytest.approx(0.713 * library.calibration.median_distance)
    with pytest.raises(InputError, match="nothing else"):
        designer.use_nearest()
    designer.another()  # of the same goal
    assert designer.goal.blocks == (block,)
    designer.undo()
    designer.undo()
    assert designer.intensity == 99.0
    assert designer.obstacle["has_offer"]


def test_undo_takes_settings_back_and_searches_them(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    designer.intensity = 60.0
    designer.intensity = 50.0  # the same slider still moves
    designer.weights = {"left_knee": 0.0}
    designer.undo()
    assert designer.settings == Settings(intensity=50.0)
    assert source.words[-1]["spare"] == ()
    designer.undo()
    assert designer.settings == Settings()
    assert not designer.can_undo
    designer.redo()
    designer.redo()
    assert designer.settings == Settings(intensity=50.0, weights={"left_knee": 0.0})
    assert not designer.can_redo


def test_a_preview_is_not_saved(library: DanceLibrary, source: StandIn, tmp_path: Path) -> None:
    designer = dance_designer(library, source=source)
    with pytest.raises(InputError, match="only a preview"):
        designer.save(tmp_path)


def test_what_the_browser_cannot_ask_is_answered_in_words(library: DanceLibrary, source: StandIn) -> None:
    designer = dance_designer(library, source=source)
    for message in ({"deed": "explode"}, "search", {"deed": "save"}, {"deed": ["search"]}):
        designer._heed(message)
        assert "does not know" in designer.status
    designer._heed({"deed": "save", "folder": "dances"})
    assert designer.status.startswith("Not done. save: there is only a preview")
    designer._heed({"deed": "nearest"})
    assert designer.status.startswith("Not done.")
    assert source.searches == [(0, True)]


def test_a_dance_is_watched_with_its_segments_marked(library: DanceLibrary, source: StandIn) -> None:
    dance = dance_designer(library, source=source, duration_s=12.0).dance
    player = watch(dance)
    assert [mark[:2] for mark in player.marks] == [(0.0, 3.9), (4.0, 7.9), (8.0, 11.9)]
    assert [mark[2] for mark in player.marks] == [
        "A: take-0, from 0.0 s",
        "B: take-0, from 4.0 s",
        "A: take-0, from 0.0 s",
    ]
    assert player.is_synthetic


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("duration_s", 30.0),
        ("duration_s", 0.0),
        ("duration_s", float("nan")),
        ("intensity", -1.0),
        ("intensity", 101.0),
        ("variety", 0.0),
        ("schedule", HOSTILE),
        ("seed", -1),
        ("weights", {HOSTILE: 0.0}),
    ],
)
def test_a_setting_that_cannot_be_is_refused(
    library: DanceLibrary, source: StandIn, name: str, wrong: Any
) -> None:
    designer = dance_designer(library, source=source)
    with pytest.raises(InputError):
        setattr(designer, name, wrong)
    with pytest.raises(InputError):
        Settings(**{name: wrong})
    assert designer.settings == Settings()
    assert len(source.searches) == 1
