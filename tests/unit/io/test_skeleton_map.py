"""Takes of foreign skeletons move SMPL's body the same way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.skeleton_map import skeleton_map, skeleton_names, to_smpl
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

# A daz figure to the thighs and up to the neck, with a buttock between hip and thigh that SMPL lacks.
DAZ = (
    ("hip", -1, (0, 0, 0)),
    ("abdomen", 0, (0, 20, 0)),
    ("chest", 1, (0, 12, 0)),
    ("neck", 2, (0, 22, 0)),
    ("head", 3, (0, 7, 0)),
    *(
        joint
        for side, sign, first in (("l", 1, 5), ("r", -1, 13))
        for joint in (
            (f"{side}Buttock", 0, (sign * 8, 0, 0)),
            (f"{side}Thigh", first, (0, -5, 0)),
            (f"{side}Shin", first + 1, (0, -40, 0)),
            (f"{side}Foot", first + 2, (0, -42, 0)),
            (f"{side}Collar", 2, (sign * 3, 18, 0)),
            (f"{side}Shldr", first + 4, (sign * 12, 0, 0)),
            (f"{side}ForeArm", first + 5, (sign * 28, 0, 0)),
            (f"{side}Hand", first + 6, (sign * 25, 0, 0)),
        )
    ),
)


def take(**turns: tuple[float, float, float]) -> SkeletalTake:
    """Give one frame of the figure with some joints turned (degrees about X, Y, Z)."""
    names = tuple(name for name, _, _ in DAZ)
    rotations = rotation.identity(1, len(names))
    for name, degrees in turns.items():
        rotations[0, names.index(name)] = rotation.exp(np.radians(degrees))
    return SkeletalTake(
        path=Path("made/up.bvh"),
        joint_names=names,
        parents=tuple(parent for _, parent, _ in DAZ),
        offsets=np.array([offset for _, _, offset in DAZ], dtype=float),
        rotations=rotations,
        root_positions=np.array([[0.0, 95.0, 10.0]]),
        frame_rate_hz=120.0,
    )


def joints(**turns: tuple[float, float, float]) -> dict[str, np.ndarray]:
    motion = to_smpl(take(**turns), "daz", units_m=0.01)
    return dict(
        zip(JOINT_NAMES, kinematics.centred_positions(NEUTRAL_BODY, motion.rotations)[0], strict=True)
    )


def test_the_rest_pose_is_the_rest_pose() -> None:
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    assert np.array(list(joints().values())) == pytest.approx(rest)


def test_a_bent_knee_and_a_raised_arm_stay_what_and_where_they_are() -> None:
    rest, bent = joints(), joints(lShin=(90, 0, 0), rShldr=(0, 0, -90))
    assert bent["left_ankle"][2] < bent["left_knee"][2] - 0.3  # behind
    assert bent["left_ankle"][1] == pytest.approx(bent["left_knee"][1], abs=0.05)
    assert bent["right_ankle"] == pytest.approx(rest["right_ankle"])
    assert bent["right_wrist"][1] > bent["right_shoulder"][1] + 0.4  # up
    assert bent["left_wrist"] == pytest.approx(rest["left_wrist"])


def test_joints_that_smpl_lacks_still_pass_their_turn_on() -> None:
    assert joints(lButtock=(0, 0, 40))["left_ankle"] == pytest.approx(joints(lThigh=(0, 0, 40))["left_ankle"])


def test_joints_that_the_take_lacks_move_with_their_parent() -> None:
    bent = to_smpl(take(chest=(30, 0, 0), lFoot=(20, 0, 0)), "daz", units_m=0.01)
    turned = rotation.log(bent.rotations[0])
    for name in ("spine2", "left_foot", "left_hand"):
        assert turned[NEUTRAL_BODY.index(name)] == pytest.approx(np.zeros(3), abs=1e-12)
    assert np.degrees(turned[NEUTRAL_BODY.index("spine3")]) == pytest.approx([30.0, 0.0, 0.0])


def test_the_way_is_scaled_to_our_legs_and_the_rate_stays() -> None:
    motion = to_smpl(take(), "daz", units_m=0.01)
    bones = NEUTRAL_BODY.bone_lengths
    legs = bones[NEUTRAL_BODY.index("left_knee")] + bones[NEUTRAL_BODY.index("left_ankle")]
    assert motion.root_positions[0] == pytest.approx(np.array([0.0, 0.95, 0.10]) * legs / 0.82)
    assert motion.frame_rate_hz == 120.0


@pytest.mark.parametrize("name", skeleton_names())
def test_every_map_treats_both_sides_alike(name) -> None:
    joints = skeleton_map(name).joints
    assert set(joints) <= set(JOINT_NAMES)
    assert len(set(joints.values())) == len(joints)
    for joint in joints:
        assert JOINT_NAMES[NEUTRAL_BODY.mirror[NEUTRAL_BODY.index(joint)]] in joints
        side = joint.split("_")[0]
        if side in ("left", "right"):
            foreign = joints[joint]
            assert foreign.endswith(f"_{side[0].upper()}") or foreign[0].lower() == side[0]


def test_a_skeleton_that_does_not_fit_is_named() -> None:
    with pytest.raises(InputError, match=r"made/up\.bvh: has no joint 'Head' of the neo skeleton; choose"):
        to_smpl(take(), "neo", units_m=0.01)
    with pytest.raises(
        InputError, match=r"no skeleton map called 'dax'; choose .*daz, motionbuilder, neo, smpl, or"
    ):
        to_smpl(take(), "dax", units_m=0.01)


# --- skeletons whose zero pose is no T-pose --------------------------------------------------------------


def spread(degrees: float) -> SkeletalTake:
    """Give the figure with legs spread and arms hanging at rest, still standing in a T-pose in its frame."""
    one = take()
    offsets, rotations = np.array(one.offsets), np.array(one.rotations)
    for side, sign in (("l", 1.0), ("r", -1.0)):
        for first, below, angle in (
            ("Thigh", ("Shin", "Foot"), sign * degrees),
            ("Shldr", ("ForeArm", "Hand"), -2.0 * sign * degrees),
        ):
            turn = rotation.exp(np.radians([0.0, 0.0, angle]))
            for name in below:
                joint = one.joint_names.index(f"{side}{name}")
                offsets[joint] = rotation.rotate(turn, offsets[joint])
            rotations[0, one.joint_names.index(f"{side}{first}")] = rotation.inverse(turn)
    return replace(one, offsets=offsets, rotations=rotations)


def own_map(folder: Path, extra: str) -> str:
    path = folder / "mine.toml"
    lines = [f'{smpl} = "{name}"' for smpl, name in skeleton_map("daz").joints.items()]
    path.write_text(extra + "\n[joints]\n" + "\n".join(lines) + "\n")
    return str(path)


@pytest.mark.parametrize("t_pose", ["limbs", "first-frame"])
def test_limbs_spread_at_rest_are_brought_back(tmp_path: Path, t_pose: str) -> None:
    one = spread(20.0)
    motion = to_smpl(one, own_map(tmp_path, f't_pose = "{t_pose}"'), units_m=0.01)
    # SMPL's own legs and arms are not quite straight down and aside.
    assert np.degrees(np.linalg.norm(rotation.log(motion.rotations), axis=-1)).max() < 6.0
    copied = to_smpl(one, own_map(tmp_path, ""), units_m=0.01)  # wrong: as if it were a T-pose at rest
    assert np.degrees(np.linalg.norm(rotation.log(copied.rotations), axis=-1)).max() > 35.0


def test_a_first_frame_that_is_no_t_pose_is_refused(tmp_path: Path) -> None:
    named = own_map(tmp_path, 't_pose = "first-frame"')
    with pytest.raises(InputError, match=r"made/up\.bvh: the first frame is no T-pose .*left_shoulder"):
        to_smpl(take(lShldr=(0, 0, -70)), named, units_m=0.01)


def test_joints_with_axes_of_their_own_are_turned_back(tmp_path: Path) -> None:
    # All bones along X, as one rig has them: the thigh's X points down and its Y to the left.
    one = take()
    offsets, rotations = np.array(one.offsets), np.array(one.rotations)
    down = rotation.exp(np.radians([0.0, 0.0, -90.0]))
    thigh, shin, foot = (one.joint_names.index(name) for name in ("lThigh", "lShin", "lFoot"))
    offsets[shin], offsets[foot] = [40.0, 0.0, 0.0], [42.0, 0.0, 0.0]
    rotations[0, thigh] = down
    rotations[0, shin] = rotation.exp(np.radians([0.0, 70.0, 0.0]))  # a knee bends about the left
    rotations[0, foot] = rotation.inverse(down)
    own = own_map(tmp_path, "").replace("mine", "axes")
    text = Path(own_map(tmp_path, "")).read_text()
    Path(own).write_text(text + "\n[turns]\nleft_hip = [0.0, 0.0, -90.0]\nleft_knee = [0.0, 0.0, -90.0]\n")
    motion = to_smpl(replace(one, offsets=offsets, rotations=rotations), own, units_m=0.01)
    turned = np.degrees(rotation.log(motion.rotations[0]))
    assert turned[NEUTRAL_BODY.index("left_hip")] == pytest.approx(np.zeros(3), abs=1e-9)
    assert turned[NEUTRAL_BODY.index("left_knee")] == pytest.approx([70.0, 0.0, 0.0], abs=1e-9)


def test_the_way_is_taken_from_the_pelvis_not_from_a_root_above_it() -> None:
    one = take()
    under_a_root = replace(
        one,
        joint_names=("floor", *one.joint_names),
        parents=(-1, *(parent + 1 for parent in one.parents)),
        offsets=np.concatenate((np.zeros((1, 3)), one.offsets)),
        rotations=np.concatenate((rotation.yaw(np.array([np.pi / 2]))[:, None], one.rotations), axis=1),
        root_positions=np.zeros((1, 3)),
        shifts={1: np.array([[10.0, 95.0, 0.0]])},
    )
    way = to_smpl(under_a_root, "daz", units_m=0.01).root_positions[0]
    assert way == pytest.approx(to_smpl(one, "daz", units_m=0.01).root_positions[0] * [0, 1, -1], abs=1e-9)


# --- what cannot be --------------------------------------------------------------------------------------


@pytest.mark.parametrize("units_m", [1.0, 0.1, 0.001])
def test_legs_of_a_giant_or_a_mouse_name_the_unit(units_m: float) -> None:
    with pytest.raises(InputError, match=r"made/up\.bvh: legs of .* m .* nobody's; correct units_m"):
        to_smpl(take(), "daz", units_m=units_m)


MISTAKES = {
    "a joint that SMPL lacks": ('[joints]\ntail = "Tail"', r"mine\.toml, line 2, joints\.tail: SMPL has no"),
    "no knees": ('[joints]\npelvis = "hip"', r"mine\.toml, line 1, joints: no joint for left_hip; name one"),
    "a misspelt field": ('t_post = "zero"\n[joints]\n', r"mine\.toml, line 1, t_post: .* unknown"),
    "an unknown T-pose": ('t_pose = "last"\n[joints]\n', r"mine\.toml, line 1, t_pose: "),
    "not TOML": ("joints = {", r"mine\.toml, line 1: this is not valid TOML"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_a_map_file_is_named_to_the_line(tmp_path: Path, mistake: str) -> None:
    text, message = MISTAKES[mistake]
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        skeleton_map(str(tmp_path / "mine.toml"))


def test_a_joint_named_twice_is_noticed(tmp_path: Path) -> None:
    path = Path(own_map(tmp_path, ""))
    path.write_text(path.read_text().replace('"rShin"', '"lShin"'))
    with pytest.raises(InputError, match=r"mine\.toml.*'lShin' stands twice"):
        skeleton_map(str(path))


def test_a_map_that_hangs_the_foot_elsewhere_is_noticed(tmp_path: Path) -> None:
    path = Path(own_map(tmp_path, ""))
    text = path.read_text().replace('"lFoot"', '"x"').replace('"lHand"', '"lFoot"').replace('"x"', '"lHand"')
    path.write_text(text)
    with pytest.raises(InputError, match=r"made/up\.bvh: the joint 'lHand' does not hang on 'lShin'"):
        to_smpl(take(), str(path), units_m=0.01)


def test_a_joint_called_by_thousands_of_digits_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'[joints]\n{"9" * 5000} = "Hips"\n')
    with pytest.raises(InputError, match=r"mine\.toml, line 2, joints.*SMPL has no joint"):
        skeleton_map(str(path))
