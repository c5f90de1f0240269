"""One dance, asked for in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography.request import default_plan, requested
from studykit.choreography.schedule import BlockPlan, hiit
from studykit.choreography.targets import goals, scheduled
from studykit.core.errors import InputError
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.motion.joint_mask import JointMask, spare
from studykit.protocol.study_protocol import DancePlan

ELBOW = ("right_elbow", "right_wrist", "right_hand")


@pytest.fixture(scope="module")
def library(made_library):
    return made_library(12)


def test_words_mean_what_they_mean_in_the_study_of_the_paper(library) -> None:
    wanted = goals(read_protocol(default_protocol()), library)
    for label, one in wanted.items():
        intensity, variety, transition = label.split("-")
        asked = requested(library, intensity=intensity, variety=variety, transition=transition)
        assert asked == one
        assert asked.weights == one.weights


def test_numbers_are_percentiles_and_shares(library) -> None:
    words = requested(library, intensity="intense", variety="hard")
    numbers = requested(library, intensity=75.0, variety=0.94)
    assert numbers.blocks == words.blocks
    assert (words.condition, numbers.condition) == ("intense-hard-on", "75-0.94-on")
    assert requested(library, intensity=0).measures.linear_energy == min(
        library.calibration.chain_linear_energies
    )


def test_a_wish_has_its_length(library) -> None:
    assert [requested(library, duration_s=s).segments for s in (4.0, 32.0, 64.0)] == [1, 8, 16]


@pytest.mark.parametrize("joints", ["right_elbow", ["right_elbow"], spare("right_elbow")])
def test_an_elbow_is_spared_with_all_beyond_it_and_stays_below_the_middle_segment(library, joints) -> None:
    asked = requested(library, spare=joints)
    assert asked.mask is not None
    assert asked.mask.spared == ELBOW
    assert asked.mask.weights[[19, 21, 23]].tolist() == [0.0, 0.0, 0.0]
    middle = np.median(library.peak_speeds, axis=0)
    assert asked.mask.speed_limits_rad_s[[19, 21, 23]] == pytest.approx(middle[[19, 21, 23]])
    assert np.isinf(np.delete(asked.mask.speed_limits_rad_s, [19, 21, 23])).all()


def test_a_mask_keeps_the_limits_it_has(library) -> None:
    mask = JointMask(speed_limits_rad_s=np.where(np.arange(24) == 19, 2.5, np.inf))
    asked = requested(library, spare=mask)
    assert asked.mask is not None
    assert asked.mask.to_dict() == mask.to_dict()
    assert requested(library, spare=()).mask is None
    assert requested(library, spare=[]).mask is None


def test_what_a_protocol_spares_is_spared_beside_what_is_named(library) -> None:
    said = {"joints": ["left_knee"], "weight": 0.5, "speed_percentile": 30.0, "cost_weight": 0.4}
    plan = DancePlan.model_validate(default_plan().model_dump() | {"spare": said})
    asked = requested(library, plan=plan)
    assert asked.mask is not None
    assert asked.mask.spared == ("left_knee", "left_ankle", "left_foot")
    assert asked.mask.speed_limits_rad_s[4] == pytest.approx(np.percentile(library.peak_speeds[:, 4], 30.0))
    assert asked.weights["mask"] == 0.4
    other = requested(library, plan=plan, spare="right_elbow")
    assert other.mask is not None
    assert set(other.mask.spared) == {*ELBOW, *asked.mask.spared}
    assert other.mask.speed_limits_rad_s[4] == asked.mask.speed_limits_rad_s[4]


def test_a_schedule_takes_the_place_of_one_block(library) -> None:
    named, given = (requested(library, schedule=one) for one in ("hiit", hiit()))
    assert named == scheduled(default_plan(), hiit(), library, name="hiit-on")
    assert given == replace(named, condition="schedule-on")
    assert requested(library, schedule=[BlockPlan(duration_s=8.0)]).segments == 2
    assert requested(library, schedule="waves", transition="off").weights["transition"] == 0.0


@pytest.mark.parametrize(
    ("wish", "sentence"),
    [
        ({"intensity": "wild"}, r'^intensity: there is no "wild"; choose light or intense\.$'),
        ({"variety": "medium"}, r'^variety: there is no "medium"; choose easy or hard\.$'),
        ({"transition": "maybe"}, r'^transition: there is no "maybe"; choose on or off\.$'),
        ({"intensity": 101.0}, r"^intensity: 101 is no percentile; say light, intense, or 0 to 100\.$"),
        ({"variety": -0.5}, r"^variety: -0.5 is no share .*\.$"),
        ({"duration_s": 30.0}, r"^duration: 30 s is not a multiple of 4 s; ask for 32 s\.$"),
        ({"duration_s": float("nan")}, r"^duration: nan s is not a multiple of 4 s; ask for 32 s\.$"),
        ({"spare": "right_ellbow"}, r'^the body has no joint "right_ellbow"; .*right_elbow.*\.$'),
        ({"spare": ["left_knee", "tail"]}, r'^the body has no joint "tail"; .*\.$'),
        ({"schedule": "tabata"}, r'^schedule: there is no schedule "tabata"; choose from hiit, .*\.$'),
        ({"schedule": ()}, r"^schedule: there is no block; give one or more\.$"),
        ({"schedule": [BlockPlan(intensity="wild")]}, r'^intensity: there is no "wild"; .*\.$'),
    ],
)
def test_what_nobody_can_ask_for_is_refused_in_one_sentence(library, wish, sentence) -> None:
    with pytest.raises(InputError, match=sentence) as refusal:
        requested(library, **wish)
    assert "\n" not in str(refusal.value)


def test_presets_are_known_by_name(library) -> None:
    paper = requested(library, plan=default_plan(preset="paper"))
    assert paper.preset.name == "paper"
    assert paper.measures.linear_energy * 73.5 == pytest.approx(56.5)
    with pytest.raises(
        InputError, match=r'^preset: there is no preset "pepper"; choose studykit or paper\.$'
    ):
        default_plan(preset="pepper")
