"""Tables of wishes: what they mean, and what is said where they are wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError, MistakesError
from studykit.library.wishes import Wish, read_wishes

CSV = """participant,name,duration_s,intensity,variety,transition,spare,schedule,seed
P01,monday,64,intense,0.7,off,right_elbow left_knee,,5
P01,friday,,60,hard,,right_elbow;left_knee,,
P02,,,,,,,hiit,
"""
TOML = """
[[dance]]
participant = "P01"
name = "monday"
duration_s = 64
intensity = "intense"
variety = 0.7
transition = "off"
spare = ["right_elbow", "left_knee"]
seed = 5

[[dance]]
participant = "P01"
name = "friday"
intensity = 60
variety = "hard"
spare = "right_elbow left_knee"

[[dance]]
participant = "P02"
schedule = "hiit"
"""


@pytest.fixture(scope="module")
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    return made_library(60)


@pytest.fixture
def read(library: DanceLibrary, tmp_path: Path) -> Callable[..., tuple[Wish, ...]]:
    def read(content: str | bytes, *, name: str = "wishes.csv", seed: int = 0) -> tuple[Wish, ...]:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return read_wishes(path, library, seed=seed)

    return read


Read = Callable[..., tuple[Wish, ...]]


def test_a_row_is_a_wish_and_empty_cells_are_left_out(read: Read) -> None:
    first, second, third = read(CSV)
    joints = ("right_elbow", "left_knee")
    assert first == Wish(
        participant="P01",
        name="monday",
        duration_s=64.0,
        intensity="intense",
        variety=0.7,
        transition="off",
        spare=joints,
        seed=5,
    )
    assert (second.duration_s, second.intensity, second.variety, second.spare) == (32.0, 60.0, "hard", joints)
    assert (third.name, third.schedule) == ("hiit-on", "hiit")


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + CSV,
        CSV.replace("\n", "\r\n"),
        CSV.replace("right_elbow;left_knee", "right_elbow left_knee").replace(",", ";"),
        CSV.replace(",", "\t"),
        CSV.replace(",", " , ").replace("\n", "\n\n"),
        CSV + ",,,,,,,,\n",
        CSV.replace("\n", ",,\n"),
        CSV.replace("right_elbow left_knee", '"right_elbow; left_knee"'),
    ],
    ids=["mark", "windows", "semicolons", "tabs", "spaces", "empty row", "empty columns", "quotes"],
)
def test_however_a_spreadsheet_saves_it_it_is_the_same(read: Read, text: str) -> None:
    assert read(text) == read(CSV)


def test_a_toml_file_says_the_same(read: Read) -> None:
    assert read(TOML, name="wishes.toml") == read(CSV)


def test_seeds_depend_on_who_dances_what_and_on_the_seed_given_but_on_no_other_row(read: Read) -> None:
    heading, first, second, third, _ = CSV.split("\n")
    seeds = {(wish.participant, wish.name): wish.seed for wish in read(CSV)}
    turned = read("\n".join([heading, third, "P03,,,,,,,,", second, first]))
    assert {(wish.participant, wish.name): wish.seed for wish in turned if wish.participant != "P03"} == seeds
    assert len({wish.seed for wish in turned}) == 4
    others = {(wish.participant, wish.name): wish.seed for wish in read(CSV, seed=1)}
    same = [key for key in seeds if others[key] == seeds[key]]
    assert same == [("P01", "monday")]  # the one that says its seed


def test_dances_that_spare_the_same_joints_share_one_mask(read: Read, library: DanceLibrary) -> None:
    first, second, _ = read(CSV)
    assert first.goal(library).mask is second.goal(library).mask


def test_limits_and_a_stage_are_said_as_on_the_command_line(read: Read, library: DanceLibrary) -> None:
    calm, usual, strict = read("name,spare,speed_percentile,stage\na,head,20,3x2.5\nb,head,,\nc,head,0,2X2\n")
    assert (calm.stage_m, usual.stage_m, strict.stage_m) == ((3.0, 2.5), None, (2.0, 2.0))
    for wish, percentile in ((calm, 20.0), (usual, 50.0), (strict, 0.0)):
        mask = wish.goal(library).mask
        assert mask is not None
        assert mask.speed_limits_rad_s[15] == np.percentile(library.peak_speeds[:, 15], percentile)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("a,,50,", "line 2, speed_percentile: no joint is spared; name one under spare."),
        ("a,head,101,", "line 2, speed_percentile: cannot read '101'; write a percentile"),
        ("a,,,3", "line 2, stage: '3' is no stage; say width x depth, such as 3x2.5."),
        ("a,,,0x3", "line 2, stage: '0x3' is no stage"),
    ],
)
def test_a_limit_or_a_stage_that_cannot_be_is_refused(read: Read, row: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(f"name,spare,speed_percentile,stage\n{row}\n")
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("P01,,,fast,,,,,", 'line 2, intensity: there is no "fast"; choose light or intense.'),
        ("P01,,,101,,,,,", "line 2, intensity: 101 is no percentile"),
        ("P01,,,nan,,,,,", "line 2, intensity: cannot read 'nan'; write light, intense, or a percentile"),
        ("P01,,,,3,,,,", "line 2, variety: 3 is no share"),
        ("P01,,,,,maybe,,,", 'line 2, transition: there is no "maybe"; choose on or off.'),
        ("P01,,30,,,,,,", "line 2, duration_s: 30 s is not a multiple of 4 s; ask for 32 s."),
        ("P01,,long,,,,,,", "line 2, duration_s: cannot read 'long'; write a multiple of 4."),
        ("P01,,inf,,,,,,", "line 2, duration_s: cannot read 'inf'"),
        ("P01,,,,,,right_elbo,,", 'line 2, spare: the body has no joint "right_elbo"; write "right_elbow"'),
        ("P01,,,,,,,tango,", 'line 2, schedule: there is no schedule "tango"; choose from hiit'),
        (
            "P01,,64,,,,,hiit,",
            "line 2, schedule: a schedule has lengths and levels of its own, not one duration_s",
        ),
        ("P01,,,,,,,,-1", "line 2, seed: cannot read '-1'"),
        ("P01,,,,,,,,1.5", "line 2, seed: cannot read '1.5'; write a whole number"),
        (",,,,,,,,3", "line 2, participant: nobody is named; give a participant or a name."),
        ("../P01,,,,,,,,", 'line 2, participant: no file can be called "../P01"; use letters'),
        ("P01,a\\b,,,,,,,", "line 2, name: no file can be called"),
        ("..,,,,,,,,", 'line 2, participant: no file can be called ".."'),
        (f"{'P' * 101},,,,,,,,", "line 2, participant: 101 letters are too long for a file"),
        ("P01,a,,,,,,,\np01,A,,,,,,,", 'line 3, name: "A" is wished for already on line 2; give each'),
        ("P01,,,,,,,,\nP01,,,,,,left_knee,,", 'line 3, name: "light-easy-on" is wished for already'),
        ("P01,,,,,,,,,7", "line 2: 10 cells below 9 columns; write lists such as joints with spaces"),
        ('P01,"a,,,,,,,', "line 2: no CSV (unexpected end of data); save the table again."),
        ("", "wishes.csv: no dance is wished for; write a row for each."),
    ],
)
def test_what_is_wrong_is_said_with_its_line_its_field_and_a_remedy(read: Read, row: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(CSV[: CSV.index("\n") + 1] + row)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no dance is wished for"),
        (b"participant,inensity\n", 'line 1: there is no column "inensity"; write "intensity" if that was'),
        (b"name,name\n", 'line 1: the column "name" stands twice'),
        (b"\xff\xfe\x00", "the file is not text; save it as CSV in UTF-8."),
    ],
)
def test_a_table_that_is_none_is_refused(read: Read, content: bytes, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(content)
    assert said in str(error.value)


def test_a_table_that_is_not_there_is_refused(library: DanceLibrary, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be read \(no such file or directory\)"):
        read_wishes(tmp_path / "none.csv", library)


def test_a_toml_file_too_names_the_line(read: Read) -> None:
    with pytest.raises(InputError, match=r"wishes.toml, line 15, intensity: 600 is no percentile"):
        read(TOML.replace("intensity = 60", "intensity = 600"), name="wishes.toml")
    with pytest.raises(InputError, match=r'line 21.*the field "shedule" is unknown; write "schedule"'):
        read(TOML.replace("schedule", "shedule"), name="wishes.toml")
    with pytest.raises(InputError, match=r'line 3, participant: no file can be called "a/b"'):
        read(TOML.replace("P01", "a/b"), name="wishes.toml")


def test_no_mistake_hides_another(read: Read) -> None:
    rows = (
        "P01,,30,fast,3,maybe,heed,,x\nP02,,,,,,,,,9\nP03,,64,,,,,hiit,\n"
        'P04,a,,,,,,,\np04,A,,,,,,,\nP05,"a,,\n'
    )
    with pytest.raises(MistakesError) as error:
        read(CSV[: CSV.index("\n") + 1] + rows)
    told = [str(one).rpartition("wishes.csv, ")[2].partition(": ")[0] for one in error.value.errors]
    assert told == [
        "line 2, seed", "line 2, duration_s", "line 2, intensity", "line 2, variety", "line 2, transition",
        "line 2, spare", "line 3", "line 4, schedule", "line 6, name", "line 7",
    ]  # fmt: skip
    assert len(str(error.value).splitlines()) == len(told)


def test_below_a_wrong_heading_only_what_is_known_is_judged(read: Read) -> None:
    with pytest.raises(MistakesError) as error:
        read("participent,intensity,intensety\nP01,fast,\nP02,60,\n")
    assert [str(one).rpartition("wishes.csv, ")[2].partition(";")[0] for one in error.value.errors] == [
        'line 1: there is no column "participent"',
        'line 1: there is no column "intensety"',
        'line 2, intensity: there is no "fast"',
    ]


def test_all_mistakes_of_a_toml_file_are_told(read: Read) -> None:
    wrong = TOML.replace('"intense"', '"fast"').replace("seed = 5", "sead = 5").replace("hiit", "tango")
    with pytest.raises(MistakesError) as error:
        read(wrong, name="wishes.toml")
    told = [str(one).rpartition("wishes.toml, ")[2].partition(": ")[0] for one in error.value.errors]
    assert told == ["line 10, sead", "line 6, intensity", "line 21, schedule"]
