"""BVH files with all the habits of other programs are read, and broken ones are named to the line."""

from __future__ import annotations

import lzma
from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.bvh import bvh_text, read_bvh
from studykit.io.packed import MOST_LINES
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.skeleton_map import to_smpl
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

# Tabs and spaces, a tab after "Frames:", a frame time without its zero, another order of channels in every
# joint, six channels in one of them.
ODD = """HIERARCHY
ROOT Hips
{
\tOFFSET 0 0\t0
\tCHANNELS 6 Zposition Xposition Yposition  Yrotation Zrotation Xrotation
\tJOINT  Left Leg
\t{
\t\tOFFSET 10.0 -40.0 0.0
\t\tCHANNELS 3 Xrotation Yrotation Zrotation
\t\tJOINT LeftFoot
\t\t{
\t\t\tOFFSET 0 -4.0e1 0
\t\t\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\t\t\tEnd Site
\t\t\t{
\t\t\t\tOFFSET 0 0 15
\t\t\t}
\t\t}
\t}
\tJOINT Head
\t{
\t\tOFFSET 0 60 0
\t\tCHANNELS 2 Yrotation Xrotation
\t}
}
MOTION
Frames:\t2
Frame Time: .0083333
 3 1 2   90 0 0   0 0 0   0 0 0  0 0 0   0 0
-3.0 1.0e0 2\t0 0 90 \t 90 90 0 0 0 0 90 90 90 90 90\x20

"""


def read(folder: Path, text: str, name: str = "take.bvh") -> SkeletalTake:
    (folder / name).write_text(text, encoding="utf-8")
    return read_bvh(folder / name)


def positions(take: SkeletalTake) -> np.ndarray:
    """Give where the joints of a take are, in the file's unit."""
    skeleton = Skeleton(
        joint_names=take.joint_names,
        parents=take.parents,
        offsets=take.offsets,
        mirror=tuple(range(len(take.parents))),
    )
    return kinematics.joint_positions(
        Motion(
            skeleton=skeleton,
            rotations=take.rotations,
            root_positions=take.root_positions,
            frame_rate_hz=take.frame_rate_hz,
        )
    )


def turn(axis: str) -> np.ndarray:
    """Give a quarter turn about an axis, as a matrix written down by hand."""
    return np.array(
        {
            "X": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
            "Y": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
            "Z": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
        }[axis],
        dtype=float,
    )


def test_every_joint_has_its_own_order_of_channels(tmp_path) -> None:
    take = read(tmp_path, ODD)
    assert take.joint_names == ("Hips", "Left Leg", "LeftFoot", "Head")
    assert take.parents == (-1, 0, 1, 0)
    assert take.frame_rate_hz == pytest.approx(120.0, rel=1e-4)
    assert take.root_positions == pytest.approx(np.array([[1.0, 2.0, 3.0], [1.0, 2.0, -3.0]]))
    matrices = rotation.to_matrix(take.rotations)
    assert matrices[0, 0] == pytest.approx(turn("Y"))
    assert matrices[1, 0] == pytest.approx(turn("X"))
    assert matrices[1, 1] == pytest.approx(turn("X") @ turn("Y"))
    assert matrices[1, 2] == pytest.approx(turn("Z") @ turn("X") @ turn("Y"))
    assert matrices[1, 3] == pytest.approx(turn("Y") @ turn("X"))
    # The first frame: everything turned from +Z to +X with the hips.
    assert positions(take)[0] == pytest.approx(
        np.array([[1, 2, 3], [1, -38, -7], [1, -78, -7], [1, 62, 3]], dtype=float)
    )


def test_channels_read_in_one_fixed_order_would_be_noticed(tmp_path) -> None:
    matrix = rotation.to_matrix(read(tmp_path, ODD).rotations)[1, 3]
    assert np.abs(matrix - turn("X") @ turn("Y")).max() > 0.5
    assert np.abs(matrix - matrix.T).max() > 0.5  # nor may it be transposed


LEGS = """HIERARCHY
ROOT Hips
{
OFFSET 0.0 90.0 0.0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT LeftKnee
{
OFFSET 10 -40 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftAnkle
{
OFFSET 0 -40 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 0 12
}
}
}
JOINT RightKnee
{
OFFSET -10 -40 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT RightAnkle
{
OFFSET 0 -40 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 0 12
}
}
}
}
MOTION
Frames: 1
Frame Time: 0.0333333
0 0 0 0 0 0  0 90 0  0 0 0  0 0 0  0 0 0
"""


def test_a_knee_bent_by_90_degrees_ends_behind_and_left_is_left(tmp_path) -> None:
    take = read(tmp_path, LEGS)
    at = dict(zip(take.joint_names, positions(take)[0], strict=True))
    assert at["LeftKnee"] == pytest.approx([10.0, 50.0, 0.0])
    assert at["LeftAnkle"] == pytest.approx([10.0, 50.0, -40.0])  # the person looks to +Z
    assert at["RightAnkle"] == pytest.approx([-10.0, 10.0, 0.0])


def a_dance() -> Motion:
    rng = np.random.default_rng(5)
    return Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(rng.normal(scale=0.9, size=(40, 24, 3))),
        root_positions=rng.normal(size=(40, 3)),
        frame_rate_hz=30.0,
    )


@pytest.mark.parametrize("packed", ["", ".xz"])
def test_what_is_written_is_read_again(tmp_path, packed) -> None:
    dance, path = a_dance(), tmp_path / f"dance.bvh{packed}"
    text = bvh_text(dance).encode()
    path.write_bytes(lzma.compress(text) if packed else text)
    again = to_smpl(read_bvh(path), "smpl", units_m=0.01)
    assert again.frame_rate_hz == pytest.approx(30.0, rel=1e-6)
    difference = kinematics.joint_positions(again) - kinematics.joint_positions(dance)
    assert np.abs(difference).max() < 1e-3


def test_gimbal_lock_is_written_and_read_again(tmp_path) -> None:
    rotations = rotation.identity(3, 24)
    rotations[:, 0] = rotation.from_euler(
        "ZXY", np.radians([[30.0, 90.0, 20.0], [10.0, -90.0, 5.0], [0, 88, 0]])
    )
    dance = Motion(
        skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=np.zeros((3, 3)), frame_rate_hz=30.0
    )
    again = read(tmp_path, bvh_text(dance))
    smpl = to_smpl(again, "smpl", units_m=0.01)
    assert rotation.between(smpl.rotations, rotations) == pytest.approx(np.zeros((3, 24, 3)), abs=1e-5)


HABITS = {
    "an empty line after MOTION": ("MOTION\n", "MOTION\n\n"),
    "empty lines round the frame time": ("Frame Time", "\n\t\nFrame Time"),
    "channels with large letters": (
        "Xposition Yposition Zposition Zrotation",
        "XPosition YPOSITION zposition ZRotation",
    ),
    "a Ctrl-Z at the end": ("0 90 0  0 0 0  0 0 0  0 0 0\n", "0 90 0  0 0 0  0 0 0  0 0 0\n\x1a"),
    "zeros at the end": ("0 90 0  0 0 0  0 0 0  0 0 0\n", "0 90 0  0 0 0  0 0 0  0 0 0\n\0\0"),
    "a brace behind the root": ("ROOT Hips\n{", "ROOT Hips {"),
    "a brace behind a joint": ("JOINT RightAnkle\n{", "JOINT RightAnkle\t{"),
    "a brace behind every end": ("End Site\n{", "End Site {"),
}


@pytest.mark.parametrize("habit", HABITS)
def test_habits_of_other_programs_change_nothing(tmp_path, habit) -> None:
    plain, other = HABITS[habit]
    assert plain in LEGS
    expected, take = read(tmp_path, LEGS), read(tmp_path, LEGS.replace(plain, other))
    assert take.joint_names == expected.joint_names
    assert take.parents == expected.parents
    np.testing.assert_array_equal(positions(take), positions(expected))


def test_the_way_of_the_root_adds_to_where_it_stands(tmp_path) -> None:
    moved = read(tmp_path, LEGS.replace("\n0 0 0 0 0 0 ", "\n1 2 3 0 0 0 "))
    assert moved.root_positions.tolist() == [[1.0, 92.0, 3.0]]


@pytest.mark.parametrize("end", ["\n", "\r", "\f", "\x85", "\u2028"])
def test_lines_without_end_are_counted_and_not_cut(tmp_path, end, monkeypatch) -> None:
    text = "HIERARCHY\n" + end * MOST_LINES
    monkeypatch.setattr("studykit.io.packed.read_text", lambda path: text)
    with pytest.raises(InputError, match=r"take\.bvh: has more than 2000000 lines"):
        read_bvh(tmp_path / "take.bvh")


ROW = "0 0 0 0 0 0  0 90 0  0 0 0  0 0 0  0 0 0"
BROKEN = {
    "empty": ("", r"take\.bvh: the file is empty; "),
    "blank": ("\n \n", r"take\.bvh: the file is empty; "),
    "no motion": (
        LEGS.split("MOTION", maxsplit=1)[0],
        r"take\.bvh, line 34: the file ends before its motion; ",
    ),
    "cut in the skeleton": (LEGS[:100], r"take\.bvh, line \d+: "),
    "cut in the head": (LEGS.split("Frame Time", maxsplit=1)[0], r"take\.bvh, line 36: no number of frames"),
    "cut in a frame": (LEGS[:-20], r"take\.bvh, line 38: not 18 finite numbers; "),
    "frames missing": (
        LEGS.replace("Frames: 1", "Frames: 3"),
        r"take\.bvh, line 36: 3 frames promised, 1 found; ",
    ),
    "frames too many": (LEGS + ROW + "\n", r"take\.bvh, line 36: 1 frames promised, 2 found; "),
    "no frames": (LEGS.replace("Frames: 1", "Frames: 0").replace(ROW, ""), r"take\.bvh, line 36: no frames"),
    "no time": (LEGS.replace("0.0333333", "0"), r"take\.bvh, line 36: no frames, or no frame time"),
    "endless time": (LEGS.replace("0.0333333", "inf"), r"take\.bvh, line 36: no frames, or no frame time"),
    "not a number": (LEGS.replace(" 90 ", " nan "), r"take\.bvh, line 38: not 18 finite numbers; "),
    "infinite": (LEGS.replace(" 90 ", " 1e999 "), r"take\.bvh, line 38: not 18 finite numbers; "),
    "a word": (LEGS.replace(" 90 ", " ninety "), r"take\.bvh, line 38: not 18 finite numbers; "),
    "a number missing": (LEGS.replace(" 90 ", " "), r"take\.bvh, line 38: not 18 finite numbers; "),
    "a channel missing": (
        LEGS.replace("CHANNELS 3", "CHANNELS 4", 1),
        r"take\.bvh, line 9: 4 channels promised, 3 named; ",
    ),
    "an unknown channel": (
        LEGS.replace("3 Zrotation", "3 Wrotation", 1),
        r"take\.bvh, line 9: channels Wrotation Xrotation Yrotation, not all known; ",
    ),
    "a channel twice": (LEGS.replace("3 Zrotation", "3 Yrotation", 1), r"take\.bvh, line 9: channels "),
    "an offset missing": (
        LEGS.replace("OFFSET 10 -40 0", "OFFSET 10 -40"),
        r"take\.bvh, line 8: an OFFSET needs",
    ),
    "an endless offset": (LEGS.replace("10 -40 0", "10 inf 0"), r"take\.bvh, line 8: an OFFSET needs"),
    "junk": ("<html>not here</html>\n", r"take\.bvh, line 1: not BVH: '<html>not here</html>'; "),
    "junk inside": (LEGS.replace("JOINT RightKnee", "BONE RightKnee"), r"take\.bvh, line 20: not BVH: 'BONE"),
    "a joint in an end site": (
        LEGS.replace("OFFSET 0 0 12\n}", "OFFSET 0 0 12\nJOINT Toe\n}", 1),
        r"take\.bvh, line 17: a joint inside an end site; ",
    ),
}


ROOT = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
END = "}\nMOTION\nFrames: 1\nFrame Time: .03\n0 0 0\n"
JOINTS = "".join(f"JOINT j{number}\n{{\nOFFSET 0 0 0\n" for number in range(10_000))
HOSTILE = {
    "a million channels": (
        ROOT.replace("CHANNELS 3", "CHANNELS 1000000 " + "Xrotation " * 999_997) + END,
        r"line 5: 1000000 channels in one joint",
    ),
    "joints within joints within joints": (ROOT + JOINTS, r"line 3003: more than 1000 joints"),
    "joints beside joints": (ROOT + JOINTS.replace("0 0 0\n", "0 0 0\n}\n"), "more than 1000 joints"),
    "a joint twice": (ROOT + "JOINT a\n{\nOFFSET 0 0 0\n}\n" + END, r"line 6: a second joint called 'a'"),
    "two roots": (
        ROOT + "}\n" + ROOT.replace("HIERARCHY\n", "").replace(" a", " b") + END,
        "line 7: not BVH",
    ),
    "frames without end": (ROOT + END.replace(": 1", ": 999999999"), "999999999 frames promised, 1 found"),
    "a number of frames as long as a page": (ROOT + END.replace(": 1", ": " + "9" * 4000), "frames promised"),
    "many frames of joints that do not move": (
        ROOT
        + JOINTS[: JOINTS.index("JOINT j999")]
        + "}\n" * 999
        + END.replace(": 1", ": 30000").replace("0 0 0\n", "0 0 0\n" * 30_000),
        "30000 frames of 1000 joints with 3 channels are no take",
    ),
    "no channels": (ROOT.replace("CHANNELS 3 Zrotation Xrotation Yrotation\n", "") + END, "0 channels"),
    "a huge angle": (ROOT + END.replace("0 0 0", "1e300 0 0"), "line 10: not 3 finite numbers"),
    "a huge offset": (ROOT.replace("OFFSET 0", "OFFSET 1e300") + END, "line 4: an OFFSET needs"),
    "no time at all": (ROOT + END.replace(".03", "1e-320"), "no frame time above zero"),
}


@pytest.mark.parametrize("mistake", HOSTILE)
def test_what_would_eat_time_or_memory_is_refused(tmp_path, mistake) -> None:
    text, message = HOSTILE[mistake]
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, text)
    assert len(str(caught.value)) < 300 + len(str(tmp_path))


def test_the_travel_of_a_joint_below_the_root_is_kept(tmp_path) -> None:
    text = """HIERARCHY
ROOT floor
{
OFFSET 0 0 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT Hips
{
OFFSET 0 93 -3
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
}
}
MOTION
Frames: 2
Frame Time: 0.05
0 0 0 0 0 0 1 90 5 0 0 0
0 0 0 0 0 0 2 91 6 0 0 0
"""
    take = read(tmp_path, text)
    assert take.shifts[1].tolist() == [[1.0, 90.0, 5.0], [2.0, 91.0, 6.0]]
    assert take.root_positions.tolist() == [[0.0, 0.0, 0.0]] * 2
    assert take.frame_rate_hz == pytest.approx(20.0)


@pytest.mark.parametrize("mistake", BROKEN)
def test_a_broken_file_is_named_to_the_line(tmp_path, mistake) -> None:
    text, message = BROKEN[mistake]
    with pytest.raises(InputError, match=message + r".*export the take again\.$") as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_bytes_that_are_no_text_at_all(tmp_path) -> None:
    (tmp_path / "take.bvh").write_bytes(bytes(range(128, 256)) * 4)
    with pytest.raises(InputError, match=r"take\.bvh, line 1: not BVH"):
        read_bvh(tmp_path / "take.bvh")


def test_digits_of_arabic_are_digits(tmp_path) -> None:
    text = bvh_text(a_dance())
    plain = read(tmp_path, text)
    head, rows = text.split("Frame Time", 1)
    arabic = read(tmp_path, f"{head}Frame Time{rows.replace('3', chr(0x663))}")
    np.testing.assert_array_equal(arabic.rotations, plain.rotations)
