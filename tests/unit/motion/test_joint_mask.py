"""Which joints are spared, and how far."""

from __future__ import annotations

import json

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.motion.joint_mask import JointMask, beyond, spare
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

ARM = ("right_elbow", "right_wrist", "right_hand")


def at(name: str) -> int:
    return NEUTRAL_BODY.index(name)


def test_what_hangs_on_a_joint_is_all_that_moves_with_it() -> None:
    for joint, name in enumerate(JOINT_NAMES):
        hanging = set(beyond(name))
        assert beyond(joint) == beyond(name)
        for other in range(24):
            above = other
            while above not in (joint, -1):
                above = NEUTRAL_BODY.parents[above]
            assert (other in hanging) == (above == joint), (name, JOINT_NAMES[other])
    assert len(beyond("pelvis")) == 24


def test_sparing_a_joint_spares_what_hangs_on_it() -> None:
    mask = spare("right_elbow", weights=0.25, speed_limits_rad_s=2.0, angle_limits_rad=1.5)
    assert mask.spared == ARM
    for joint, name in enumerate(JOINT_NAMES):
        spared = name in ARM
        assert mask.weights[joint] == (0.25 if spared else 1.0)
        assert mask.speed_limits_rad_s[joint] == (2.0 if spared else np.inf)
        assert mask.angle_limits_rad[joint] == (1.5 if spared else np.inf)


def test_what_is_said_of_a_joint_itself_goes_before_what_is_said_of_another() -> None:
    for names, limits in (
        (("right_shoulder", "right_wrist"), (3.0, 1.0)),
        (("right_wrist", "right_shoulder"), (1.0, 3.0)),
    ):
        mask = spare(names, speed_limits_rad_s=limits)
        assert mask.speed_limits_rad_s[at("right_elbow")] == 3.0
        assert mask.speed_limits_rad_s[at("right_hand")] == 1.0
    both = spare(("right_elbow", "left_knee")).spared
    assert set(both) == {"left_knee", "left_ankle", "left_foot", *ARM}


def test_limits_are_filled_in_for_spared_joints_that_have_none() -> None:
    own = np.linspace(1.0, 24.0, 24)
    mask = spare(("right_elbow", "right_wrist"), speed_limits_rad_s=(np.inf, 0.5)).limited(own)
    assert mask.speed_limits_rad_s[at("right_elbow")] == own[at("right_elbow")]
    assert mask.speed_limits_rad_s[at("right_hand")] == 0.5  # an own word stays
    assert np.isinf(mask.speed_limits_rad_s[at("left_elbow")])  # a free joint stays free
    assert np.array_equal(mask.weights, spare("right_elbow").weights)


def test_a_mask_without_a_word_is_free() -> None:
    assert JointMask().spared == ()
    assert JointMask().to_dict() == {}
    assert JointMask(angle_limits_rad=np.where(np.arange(24) == 3, 1.0, np.inf)).spared == ("spine1",)


def test_a_mask_comes_back_from_plain_values() -> None:
    mask = spare(("right_elbow", "left_knee"), weights=(0.0, 0.5), speed_limits_rad_s=(2.0, np.inf))
    told = json.loads(json.dumps(mask.to_dict(), allow_nan=False))
    assert set(told) == set(mask.spared)
    assert told["left_foot"] == {"weight": 0.5, "speed_limits_rad_s": None, "angle_limits_rad": None}
    back = JointMask.from_dict(told)
    for name in ("weights", "speed_limits_rad_s", "angle_limits_rad"):
        assert np.array_equal(getattr(back, name), getattr(mask, name))


@pytest.mark.parametrize(
    ("said", "message"),
    [
        (lambda: spare("right elbow"), r'no joint "right elbow"; write "right_elbow" if that was meant\.'),
        (lambda: spare("zzz"), r'no joint "zzz"; name one of SMPL'),
        (lambda: spare(()), r"spare: no joint is named; name one"),
        (lambda: spare("neck", weights=1.5), r"neck: a weight of 1\.5; say 0 to 1\."),
        (lambda: spare("neck", weights=-0.1), r"neck: a weight of -0\.1"),
        (lambda: spare("neck", weights=np.nan), r"neck: a weight of nan"),
        (lambda: spare("neck", speed_limits_rad_s=0.0), r"neck: a speed limit of 0; say a number above 0"),
        (lambda: spare("neck", speed_limits_rad_s=-1.0), r"neck: a speed limit of -1"),
        (lambda: spare("neck", angle_limits_rad=np.nan), r"neck: an angle limit of nan"),
        (lambda: spare("neck", angle_limits_rad=0.0), r"neck: an angle limit of 0"),
        (
            lambda: spare(("head", "neck", "head"), speed_limits_rad_s=(1.0, 2.0, 3.0)),
            r"speed_limits_rad_s: head is given both 1 and 3; name it once\.",
        ),
        (
            lambda: spare(("head", "neck"), weights=(0.0, 1.0, 0.5)),
            r"weights: 3 numbers for 2 joints; give one, or one for each joint\.",
        ),
        (lambda: JointMask.from_dict({"nek": {"weight": 0.0}}), r'no joint "nek"; write "neck"'),
        (
            lambda: JointMask.from_dict({"neck": {"wait": 0.0}}),
            r'neck: "wait" says nothing .* write "weight"',
        ),
        (lambda: JointMask.from_dict({"neck": {"weight": "low"}}), r"neck: a weight of 'low'; say a number"),
    ],
)
def test_what_no_mask_can_be_is_refused(said, message: str) -> None:
    with pytest.raises(InputError, match=message):
        said()


def test_the_same_joint_may_be_named_twice_alike() -> None:
    assert spare(("head", "head"), speed_limits_rad_s=(2.0, 2.0)).spared == ("head",)
