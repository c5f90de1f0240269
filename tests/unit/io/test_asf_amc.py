"""ASF skeletons and AMC motions are read as they were meant, and broken ones are named to the line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.asf_amc import read_asf, read_asf_amc
from studykit.io.datasets.asf_amc import AsfAmcFiles
from studykit.io.datasets.recipe import Recipe
from studykit.motion import rotation

UNIT_M = 0.0254 / 0.45

# A root, a thigh slanting outwards with axes of its own, a shank that only bends.
ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   begin: nothing of this counts
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 1 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hipjoint
     direction 0 0 2
     length 1.5
     axis 0 0 0 XYZ
  end
  begin
     id 2
     name thigh
     direction 0 -1 0
     length 7
     axis 0 0 90 XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-70.0 70.0)
  end
  begin
     id 3
     name shank
     direction 0 -1 0
     length 8.0e+000
     axis 0 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root hipjoint
    hipjoint thigh
    thigh shank
  end
"""
AMC = """#!OML:ASF nowhere
# by hand
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
thigh 0 0
shank 90
2
root 1 2 3 0 90 0
thigh 30 0.0e-015
shank -1.5e+001
"""


def write(folder: Path, asf: str = ASF, amc: str = AMC) -> tuple[Path, Path]:
    (folder / "01.asf").write_bytes(asf.replace("\n", "\r\n").encode())
    (folder / "01_01.amc").write_bytes(amc.replace("\n", "\r\n").encode())
    return folder / "01_01.amc", folder / "01.asf"


def test_a_skeleton_by_hand(tmp_path: Path) -> None:
    skeleton = read_asf(write(tmp_path)[1])
    assert skeleton.names == ("root", "hipjoint", "thigh", "shank")
    assert skeleton.parents == (-1, 0, 1, 2)
    # A joint lies at the far end of the bone above it; directions need not be of unit length.
    expected = np.array([[0, 0, 0], [0, 0, 0], [0, 0, 1.5], [0, -7, 0]]) * UNIT_M
    assert skeleton.offsets == pytest.approx(expected)
    assert skeleton.dofs == (("tx", "ty", "tz", "rx", "ry", "rz"), (), ("rx", "rz"), ("rx",))


def test_a_motion_by_hand(tmp_path: Path) -> None:
    take = read_asf_amc(*write(tmp_path))
    assert take.frame_rate_hz == 120.0
    assert take.root_positions == pytest.approx(np.array([[1, 3, 3], [1, 3, 3]]) * UNIT_M)
    turned = np.degrees(rotation.log(take.rotations))
    assert turned[0] == pytest.approx(np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0], [90, 0, 0]]), abs=1e-9)
    # The X of the thigh points along the Y of the world: its frame is turned by 90 degrees about Z.
    expected = np.array([[0, 90, 0], [0, 0, 0], [0, 30, 0], [-15, 0, 0]])
    assert turned[1] == pytest.approx(expected, abs=1e-9)


def test_turns_are_applied_in_the_order_listed(tmp_path: Path) -> None:
    amc = AMC.replace("root 1 2 3 0 90 0", "root 1 2 3 90 0 90")
    take = read_asf_amc(*write(tmp_path, amc=amc))
    # About X first: Y becomes Z, and stays there when Z is turned about.
    assert rotation.rotate(take.rotations[1, 0], np.array([0.0, 1.0, 0.0])) == pytest.approx([0, 0, 1])
    other = write(tmp_path, asf=ASF.replace("order TX TY TZ RX RY RZ", "order TX TY TZ RZ RY RX"), amc=amc)
    assert rotation.rotate(read_asf_amc(*other).rotations[1, 0], np.array([0.0, 1.0, 0.0])) == pytest.approx(
        [-1, 0, 0]
    )


def test_radians_are_radians(tmp_path: Path) -> None:
    amc = AMC.replace(":DEGREES", ":RADIANS").replace("shank 90", f"shank {np.pi / 3}")
    turned = np.degrees(rotation.log(read_asf_amc(*write(tmp_path, amc=amc)).rotations[0, 3]))
    assert turned == pytest.approx([60.0, 0.0, 0.0])
    asf = ASF.replace("angle deg", "angle rad").replace("axis 0 0 90", f"axis 0 0 {np.pi / 2}")
    first, second = read_asf(write(tmp_path)[1]), read_asf(write(tmp_path, asf=asf)[1])
    assert first.frames == pytest.approx(second.frames)


def test_rows_may_stand_in_another_order_than_the_bones(tmp_path: Path) -> None:
    swapped = AMC.replace("thigh 0 0\nshank 90\n", "shank 90\nthigh 0 0\n")
    swapped = swapped.replace("thigh 30 0.0e-015\nshank -1.5e+001\n", "shank -1.5e+001\nthigh 30 0.0e-015\n")
    first = read_asf_amc(*write(tmp_path)).rotations
    assert read_asf_amc(*write(tmp_path, amc=swapped)).rotations == pytest.approx(first)


@pytest.mark.parametrize("keyword", [":SAMPLES-PER-SECOND 60", "  :samples-per-second\t6e1 "])
def test_a_file_may_say_its_rate(tmp_path: Path, keyword: str) -> None:
    amc, asf = write(tmp_path, amc=AMC.replace(":DEGREES", f"{keyword}\n:DEGREES"))
    assert read_asf_amc(amc, asf).frame_rate_hz == 60.0
    assert read_asf_amc(amc, asf, frame_rate_hz=100.0).frame_rate_hz == 100.0
    amc, asf = write(tmp_path, amc=AMC.replace(":DEGREES", ":SAMPLES-PER-SECOND many\n:DEGREES"))
    assert read_asf_amc(amc, asf, frame_rate_hz=100.0).frame_rate_hz == 100.0


def test_keywords_and_comments_may_be_indented(tmp_path: Path) -> None:
    indented = AMC.replace(":FULLY", "  :FULLY").replace(":DEGREES", "\t:RADIANS\n  # of the joints")
    turned = rotation.log(read_asf_amc(*write(tmp_path, amc=indented)).rotations[1, 2])
    assert turned == pytest.approx([0.0, 30.0 - 10.0 * np.pi, 0.0])


BROKEN_AMC = {
    "no number for a rate": (
        AMC.replace(":DEGREES", ":SAMPLES-PER-SECOND many"),
        "line 4: 1 number wanted, not 'many'",
    ),
    "a rate of nothing": (AMC.replace(":DEGREES", ":SAMPLES-PER-SECOND 0"), "line 4: no :SAMPLES-PER-SECOND"),
    "empty": ("", "no AMC motion"),
    "junk": ("<html>\n" * 5, "no AMC motion"),
    "no frames": (AMC[: AMC.index("1\nroot")], "there are no frames"),
    "cut in a frame": (AMC[: AMC.index("shank -")], r"line 11: ends within a frame"),
    "cut in a row": (
        AMC.replace("thigh 30 0.0e-015", "thigh 30"),
        r"line 11: 'thigh 30' stands where 'thigh'",
    ),
    "a bone it lacks": (AMC.replace("shank", "tail"), r"line 8: 'tail 90' stands where 'tail' should"),
    "a word": (AMC.replace("thigh 30", "thigh x"), r"line 11: 2 numbers wanted, not 'x 0.0e-015'"),
    "not a number": (AMC.replace("thigh 30", "thigh nan"), r"line 11: 2 numbers wanted"),
    "huge": (AMC.replace("thigh 30", "thigh 1e300"), r"line 11: 2 numbers wanted"),
    "a bone missing": (AMC.replace("thigh 30 0.0e-015\n", ""), r"line 11: 'shank -1.5e\+001' stands where"),
}


@pytest.mark.parametrize("mistake", BROKEN_AMC)
def test_a_broken_motion_is_named_to_the_line(tmp_path: Path, mistake: str) -> None:
    amc, message = BROKEN_AMC[mistake]
    with pytest.raises(InputError, match=rf"01_01\.amc.*{message}"):
        read_asf_amc(*write(tmp_path, amc=amc))


BROKEN_ASF = {
    "empty": ("", "no ASF skeleton: there is no :root"),
    "no tree": (ASF[: ASF.index(":hierarchy")], "there is no :hierarchy"),
    "a bone twice": (ASF.replace("name shank", "name thigh"), "a second bone called 'thigh'"),
    "a bone without a name": (ASF.replace("     name shank\n", ""), "line 32: a bone without a name"),
    "a root turned at rest": (ASF.replace("orientation 0", "orientation 90"), "line 13: the root is turned"),
    "a bone that grows": (ASF.replace("dof rx\n", "dof rx l\n"), "line 38: degrees of freedom 'rx l'"),
    "an endless bone": (ASF.replace("length 7", "length inf"), "line 26: 1 number wanted, not 'inf'"),
    "a strange axis": (ASF.replace("90 XYZ", "90 XYW"), "line 27: axes in the order 'XYW'"),
    "a circle": (ASF.replace("thigh shank\n", "thigh root\n"), "line 44: 'root' cannot hang on 'thigh'"),
    "a stranger": (ASF.replace("thigh shank\n", "thigh tail\n"), "line 44: 'tail' cannot hang on 'thigh'"),
    "no unit of length": (ASF.replace("length 0.45", "length x"), "1 number wanted, not 'x'"),
    "a unit of nothing": (ASF.replace("length 0.45", "length 0"), "the unit of length is no length"),
    "a thousand bones": (
        ASF.replace(":hierarchy", "".join(f"begin\nname b{n}\nend\n" for n in range(2000)) + ":hierarchy"),
        "more than 1000 bones",
    ),
}


@pytest.mark.parametrize("mistake", BROKEN_ASF)
def test_a_broken_skeleton_is_named_to_the_line(tmp_path: Path, mistake: str) -> None:
    asf, message = BROKEN_ASF[mistake]
    with pytest.raises(InputError, match=rf"01\.asf.*{message}"):
        read_asf_amc(*write(tmp_path, asf=asf))


def test_the_skeleton_of_the_performer_is_found_or_asked_for(tmp_path: Path) -> None:
    importer = AsfAmcFiles()
    amc, asf = write(tmp_path)
    assert importer.recognises(tmp_path)
    assert importer.companions(amc) == [asf]
    asf.rename(tmp_path / "someone.asf")  # the only one of the folder
    (tmp_path / "._someone.asf").write_bytes(b"\0")  # left by macOS
    assert importer.companions(amc) == [tmp_path / "someone.asf"]
    (tmp_path / "other.asf").write_text(ASF)
    assert importer.companions(amc) == []
    recipe = Recipe(data_set="mine", format="asf-amc")
    with pytest.raises(
        InputError, match=r"01_01\.amc: 2 skeletons .*none is called 01\.asf; put the skeleton"
    ):
        importer.read(amc, recipe)
    for one in ("other.asf", "someone.asf"):
        (tmp_path / one).unlink()
    with pytest.raises(InputError, match=r"01_01\.amc: no skeletons .*; put the skeleton"):
        importer.read(amc, recipe)
