"""Tables of markers are read, short gaps filled, long ones and broken tables named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.markers import MarkerTables
from studykit.io.datasets.recipe import Recipe
from studykit.io.gaps import filled
from studykit.io.marker_map import NEEDED, joints_of, marker_map
from studykit.io.marker_table import read_marker_table
from studykit.motion.skeleton import JOINT_NAMES

HEAD = "NO_OF_FRAMES\t3\nNO_OF_MARKERS\t2\nFREQUENCY\t10\nTIME_STAMP\t2007-10-24, 14:17:51\t85780.2\n"
TABLE = HEAD + "MARKER_NAMES\tHead\tToe\n1\t2\t3\t4\t5\t6\n1\t2\t3\t\t\t\n3\t2\t1\t8\t5\t0\t\n"


def read(folder: Path, text: str) -> object:
    path = folder / "take.tsv"
    path.write_text(text)
    return read_marker_table(path)


@pytest.mark.parametrize("lost", ["\t\t", "NaN\tnan\tNaN", "0\t0\t0", "0.000\t-0\t0"])
def test_a_lost_marker_is_filled_in_and_counted(tmp_path: Path, lost: str) -> None:
    table = read(tmp_path, TABLE.replace("1\t2\t3\t\t\t\n", f"1\t2\t3\t{lost}\n"))
    assert table.names == ("Head", "Toe")
    assert table.frame_rate_hz == 10.0
    assert table.positions[:, 1].tolist() == [[4, 5, 6], [6, 5, 3], [8, 5, 0]]
    assert table.gaps == {"Toe": 1}


def test_gaps_are_filled_in_a_straight_line_and_only_short_ones() -> None:
    rng = np.random.default_rng(2)
    line = np.linspace([0.0, 1.0, 2.0], [3.0, -1.0, 2.5], 100)[:, None] + np.zeros((1, 2, 1))
    gappy = line.copy()
    gappy[40:70, 0] = gappy[97:, 1] = gappy[:2, 1] = np.nan  # half a second at 60 Hz
    whole, counts = filled(gappy, ("a", "b"), 60.0, Path("x"))
    assert whole[:, 0] == pytest.approx(line[:, 0])
    assert counts == {"a": 30, "b": 5}
    assert np.all(whole[97:, 1] == line[96, 1])  # at the ends it stays where it is seen
    assert np.all(whole[:2, 1] == line[2, 1])
    assert whole[2:97, 1] == pytest.approx(line[2:97, 1])
    gappy[40:71, 0] = np.nan
    with pytest.raises(InputError, match=r"x: a is lost in frames 41-71, more than 0\.5 s; fill the gap"):
        filled(gappy, ("a", "b"), 60.0, Path("x"))
    assert filled(rng.normal(size=(5, 2, 3)), ("a", "b"), 60.0, Path("x"))[1] == {}


HEADINGS = {
    "types of trajectories": ("TRAJECTORY_TYPES\tMeasured\tMixed\n", ()),
    "a heading for each column": ("Head X\tHead Y\tHead Z\tToe X\tToe Y\tToe Z\n", ()),
    "frame": ("TRAJECTORY_TYPES\tMeasured\tMixed\nFrame\tHead X\tHead Y\n", ("7",)),
    "time": ("Time\tHead X\tHead Y\n", ("0.1",)),
    "markers called by numbers": ("1 X\t1 Y\t1 Z\t2 X\t2 Y\t2 Z\n", ()),
    "frame and time": ("TRAJECTORY_TYPES\nFrame\tTime (s)\tHead X\n", ("7", "0.1")),
    "headings of columns that are not there": ("Frame\tTime\tHead X\n", ()),
}


@pytest.mark.parametrize("first", ["1\t2\t3", "NaN\tNaN\tNaN", "\t\t"])
@pytest.mark.parametrize("lines", HEADINGS)
def test_lines_of_headings_and_columns_before_the_markers_fall_out(
    tmp_path: Path, lines: str, first: str
) -> None:
    head, before = HEADINGS[lines]
    rows = [f"{first}\t4\t5\t6", "1\t2\t3\t\t\t", "3\t2\t1\t8\t5\t0\t"]
    body = "\n".join("\t".join((*before, row)) for row in rows)
    table = read(tmp_path, f"{HEAD}MARKER_NAMES\tHead\tToe\n{head}{body}\n")
    assert table.names == ("Head", "Toe")
    assert table.positions[:, 0].tolist() == [[1, 2, 3], [1, 2, 3], [3, 2, 1]]
    assert table.positions[:, 1].tolist() == [[4, 5, 6], [6, 5, 3], [8, 5, 0]]


@pytest.mark.parametrize("written", ["EXT", "0", "10", ""])
def test_a_rate_that_is_known_goes_before_that_in_the_file(tmp_path: Path, written: str) -> None:
    path = tmp_path / "take.tsv"
    path.write_text(TABLE.replace("FREQUENCY\t10", f"FREQUENCY\t{written}"))
    assert read_marker_table(path, frame_rate_hz=100.0).frame_rate_hz == 100.0


def test_the_rate_of_a_recipe_measures_gaps_and_holds_for_the_take(tmp_path: Path) -> None:
    # 20 frames lost: 2 s at the 10 Hz written, 0.2 s at the true 100 Hz.
    markers = sorted(marker_map("mocap-toolbox").markers)
    text = a_table(markers, lost=range(10, 30))
    path = tmp_path / "take.tsv"
    recipe = Recipe(data_set="mine", format="markers", skeleton="mocap-toolbox", frame_rates_hz={"*": 100.0})
    for frequency in ("10", "EXT"):
        path.write_text(text.replace("FREQUENCY\t10", f"FREQUENCY\t{frequency}"))
        with pytest.raises(InputError, match="are nobody's"):  # markers strewn about; but they are read
            MarkerTables().read(path, recipe)
    with pytest.raises(InputError, match="no FREQUENCY above zero"):
        MarkerTables().read(path, recipe.model_copy(update={"frame_rates_hz": {}}))


def a_table(markers: list[str], *, lost: range) -> str:
    """Write 40 frames of markers strewn about, the first of them lost for some frames."""
    places = np.random.default_rng(3).normal(size=(40, len(markers), 3))
    places[list(lost), 0] = np.nan
    rows = ["\t".join(f"{value:.4f}" for value in row) for row in places.reshape(40, -1)]
    head = HEAD.replace("FRAMES\t3", "FRAMES\t40")
    return "\n".join((head + "\t".join(("MARKER_NAMES", *markers)), *rows, ""))


@pytest.mark.parametrize("lost", [range(2, 30), range(40)])
def test_only_markers_in_use_must_be_seen(tmp_path: Path, lost: range) -> None:
    markers = ["a stick", *sorted(marker_map("mocap-toolbox").markers)]
    path = tmp_path / "take.tsv"
    path.write_text(a_table(markers, lost=lost))
    table = read_marker_table(path, used=marker_map("mocap-toolbox").markers)
    assert table.names == tuple(markers[1:])
    assert table.gaps == {}
    with pytest.raises(InputError, match=r"a stick is (lost in frames 3-30|never seen)"):
        read_marker_table(path)


def test_a_point_never_seen_is_named() -> None:
    with pytest.raises(InputError, match="x: b is never seen; leave it out"):
        filled(np.full((3, 1, 3), np.nan), ("b",), 60.0, Path("x"))


BROKEN = {
    "empty": ("", "no table of markers"),
    "no names": (HEAD, "no line begins with MARKER_NAMES"),
    "no rate": (TABLE.replace("FREQUENCY\t10\n", ""), "no FREQUENCY above zero"),
    "a rate of zero": (TABLE.replace("FREQUENCY\t10", "FREQUENCY\t0"), "line 3: no FREQUENCY above zero"),
    "frames missing": (TABLE.replace("FRAMES\t3", "FRAMES\t9"), "9 frames promised, 3 found"),
    "no frames": (TABLE[: TABLE.index("1\t2\t3\t4")], "3 frames promised, 0 found"),
    "a marker twice": (TABLE.replace("Toe", "Head"), "line 5: 2 marker names, not all different"),
    "a number missing": (TABLE.replace("4\t5\t6", "4\t5"), "line 6: not 6 numbers"),
    "a word": (TABLE.replace("4\t5\t6", "4\t5\tx"), "line 6: not 6 numbers"),
    "infinite": (TABLE.replace("4\t5\t6", "4\t5\tinf"), "line 6: not 6 numbers"),
    "lost for good": (
        HEAD.replace("10", "1") + "MARKER_NAMES\tHead\tToe\n" + "1\t2\t3\t\t\t\n" * 3,
        "Toe is never seen; leave it out of the map",
    ),
    "lost for long": (
        TABLE.replace("FREQUENCY\t10", "FREQUENCY\t1"),
        "Toe is lost in frames 2-2",
    ),
    "decimal commas": (TABLE.replace("1\t2\t3\t4", "1,0\t2\t3\t4"), "line 6: not 6 numbers"),
    "nothing seen": (TABLE.replace("1\t2\t3\t\t\t\n", "\t\t\t\t\tNaN\n"), "line 7: no marker was seen"),
    "too many markers": (
        TABLE.replace("Head\tToe", "\t".join(f"m{n}" for n in range(5000))),
        "line 5: 5000 marker names",
    ),
}


@pytest.mark.parametrize("mistake", BROKEN)
def test_a_broken_table_is_named_to_the_line(tmp_path: Path, mistake: str) -> None:
    text, message = BROKEN[mistake]
    with pytest.raises(InputError, match=rf"take\.tsv.*{message}"):
        read(tmp_path, text)


def test_a_table_without_the_markers_of_its_map_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"take\.tsv: has no marker 'Ankle_L'; choose the set"):
        joints_of(read(tmp_path, TABLE), marker_map("mocap-toolbox"), tmp_path / "take.tsv")


def test_a_map_of_markers_names_known_joints_and_all_that_are_needed(tmp_path: Path) -> None:
    built_in = marker_map("mocap-toolbox").joints
    assert set(NEEDED) <= set(built_in) <= set(JOINT_NAMES)
    path = tmp_path / "mine.toml"
    lines = [f"{joint} = {list(markers)}" for joint, markers in built_in.items()]
    path.write_text("[joints]\n" + "\n".join(lines).replace("'", '"'))
    assert marker_map(str(path)).joints == built_in
    path.write_text("[joints]\n" + "\n".join(line for line in lines if "knee" not in line).replace("'", '"'))
    with pytest.raises(InputError, match=r"mine\.toml.*no markers for left_knee; name some"):
        marker_map(str(path))
    path.write_text('[joints]\nspine1 = ["a"]\n')
    with pytest.raises(InputError, match=r"mine\.toml, line 2, joints\.spine1: no joint 'spine1' with"):
        marker_map(str(path))
    with pytest.raises(
        InputError, match=r"no set of markers called 'plug-in-gait'; choose mocap-toolbox, or"
    ):
        marker_map("plug-in-gait")
