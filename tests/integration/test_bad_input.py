"""Wrong calls and wrong files: one sentence that names file, line or field and the remedy, exit code 2."""

from __future__ import annotations

import lzma
from collections.abc import Callable
from pathlib import Path

import pytest

from studykit.cli import main
from studykit.io.protocol_file import default_protocol
from studykit.library import make_sample

Refused = Callable[..., str]

LITTLE_BVH = """HIERARCHY
ROOT hip
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
}
MOTION
Frames: 2
Frame Time: .0333333
0 0 0 0 0 0
"""
RECIPE = """data_set = "own"
licence = "ours"
skeleton = "daz"
units_m = 0.01
takes = [{ match = "*", genre = "salsa", performer = "A" }]
"""


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Refused:
    """Run a command that must fail; give the one sentence that it says."""

    def run(*arguments: str | Path) -> str:
        with pytest.raises(SystemExit) as end:
            main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        assert end.value.code == 2, said.out + said.err
        sentence = said.err.strip().splitlines()[-1]
        assert "Traceback" not in said.err
        assert sentence.startswith("studykit")
        assert sentence.endswith(".")
        return sentence

    return run


@pytest.fixture(scope="module")
def little_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("libraries") / "little"
    make_sample(folder, segments=24, seed=1)
    return folder


def a_folder_of_takes(folder: Path, content: bytes, name: str = "01.bvh") -> Path:
    folder.mkdir()
    (folder / "library.toml").write_text(RECIPE)
    (folder / name).write_bytes(content)
    return folder


@pytest.mark.parametrize(
    ("content", "name", "said"),
    [
        (b"", "01.bvh", "the file is empty"),
        (LITTLE_BVH.encode(), "01.bvh", "2 frames promised, 1 found"),
        (LITTLE_BVH.replace("OFFSET 0 0 0", "OFFSET 0 zero 0").encode(), "01.bvh", "line 4"),
        (lzma.compress(LITTLE_BVH.encode())[:60], "01.bvh.xz", "broken .xz file"),
        (LITTLE_BVH.replace("Frames: 2", "Frames: 1").encode(), "01.bvh", "no joint"),
    ],
    ids=["empty", "cut off", "no number", "broken packing", "another skeleton"],
)
def test_a_broken_take_is_named_and_leaves_no_library(
    refused: Refused, tmp_path: Path, content: bytes, name: str, said: str
) -> None:
    takes = a_folder_of_takes(tmp_path / "takes", content, name)
    sentence = refused("library", "build", takes, "--out", tmp_path / "library")
    assert said in sentence
    assert str(takes / name) in sentence
    assert [path.name for path in tmp_path.iterdir()] == ["takes"]


def test_a_protocol_with_a_typing_error_names_the_line_and_what_was_meant(
    refused: Refused, tmp_path: Path
) -> None:
    protocol = tmp_path / "mine.toml"
    text = default_protocol().read_text(encoding="utf-8")
    protocol.write_text(text.replace("rest_s =", "rst_s ="), encoding="utf-8")
    line = next(n for n, row in enumerate(protocol.read_text().splitlines(), 1) if row.startswith("rst_s"))
    sentence = refused("demo", "--protocol", protocol, "--out", tmp_path / "study")
    assert str(protocol) in sentence
    assert f"line {line}" in sentence
    assert "rest_s" in sentence
    assert not (tmp_path / "study").exists()


def test_a_library_too_small_for_a_dance_that_never_repeats(
    refused: Refused, little_library: Path, tmp_path: Path
) -> None:
    sentence = refused(
        "choreograph",
        "--library",
        little_library,
        "--variety",
        "hard",
        "--duration",
        "400",
        "--out",
        tmp_path / "d",
    )
    assert "24 movements" in sentence
    assert not (tmp_path / "d").exists()


def test_a_duration_that_is_no_multiple_of_four_seconds(
    refused: Refused, little_library: Path, tmp_path: Path
) -> None:
    sentence = refused(
        "choreograph", "--library", little_library, "--duration", "30", "--out", tmp_path / "d"
    )
    assert "30 s" in sentence
    assert "32 s" in sentence


SPARE = """[dance.spare]
joints = ["right_elbow"]
weight = 0.0
speed_percentile = 50.0
cost_weight = 0.2

[session]"""


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        # Goals of the whole protocol that no dance of the library meets, with what comes nearest
        (
            {"easy = 0.55": "easy = 1.9", "hard = 0.94": "hard = 2.0"},
            ("light-easy-on", "variety cannot be had", "nearest is", "ask for that"),
        ),
        # Joints held so still that no segment is left
        (
            {"[session]": SPARE.replace("50.0", "1.0")},
            ("right_elbow", "exceed their limits in every segment", "allow more"),
        ),
        ({"[session]": SPARE.replace("elbow", "ellbow")}, ('"right_ellbow"', 'write "right_elbow"')),
        (
            {"[session]": SPARE.replace("50.0", "-1.0")},
            ("protocol.toml, line", "dance.spare.speed_percentile"),
        ),
        ({"[session]": SPARE.replace("weight = 0.0", "wait = 0.0")}, ("protocol.toml, line", "wait")),
    ],
)
def test_a_protocol_whose_dances_cannot_be_had(
    refused: Refused, little_library: Path, tmp_path: Path, wrong: dict[str, str], said: tuple[str, ...]
) -> None:
    text = default_protocol().read_text()
    for right, other in wrong.items():
        assert text.count(right) == 1
        text = text.replace(right, other)
    (tmp_path / "protocol.toml").write_text(text)
    sentence = refused(
        "choreograph",
        "--library",
        little_library,
        "--protocol",
        tmp_path / "protocol.toml",
        "--out",
        tmp_path / "dances",
    )
    assert all(words in sentence for words in said), sentence
    assert not (tmp_path / "dances").exists()


def test_a_folder_that_cannot_be_written(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    sentence = refused("library", "sample", "--out", tmp_path / "file" / "library", "--segments", "10")
    assert str(tmp_path / "file") in sentence
    sentence = refused("demo", "--out", tmp_path / "file" / "study", "--participants", "1")
    assert str(tmp_path / "file") in sentence
    assert (tmp_path / "file").read_text() == "in the way"


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_something_that_is_there_already_is_never_replaced(
    refused: Refused, little_library: Path, tmp_path: Path
) -> None:
    before = contents(little_library)
    assert str(little_library) in refused("library", "sample", "--out", little_library, "--seed", "9")
    assert contents(little_library) == before


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("library", "bild"), "build"),
        (("demo", "--participants", "none"), "--participants"),
        (("library", "info", "nowhere"), "not a dance library"),
        (("session", "list", "--study", "nowhere"), "nowhere"),
        (("analyse", "nowhere"), "nowhere"),
        (("library", "fetch", "cmu-dnce", "--out", "takes"), "cmu-dance"),
        (("library", "build", "nowhere", "--out", "library"), "nowhere"),
        (("demo", "--effects", "papr", "--out", "study"), "papr"),
    ],
)
def test_wrong_words_are_answered_with_the_right_ones(
    refused: Refused, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert said in refused(*arguments)
    assert not list(tmp_path.iterdir())


def test_a_visit_begins_only_with_a_protocol_and_dances(refused: Refused, tmp_path: Path) -> None:
    study = tmp_path / "study"
    assert "--protocol" in refused("session", "run", "--study", study, "--participant", "01")
    protocol = default_protocol()
    assert "dances" in refused(
        "session", "run", "--study", study, "--participant", "01", "--protocol", protocol
    )
    assert not study.exists()
