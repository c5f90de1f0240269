from __future__ import annotations

import re
from pathlib import Path

import pytest

from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol, write_protocol
from studykit.io.toml_file import line_of, model_text

SHIPPED = Path(__file__).resolve().parents[3] / "protocols" / "dance-2x2x2.toml"


def test_the_shipped_protocol_has_every_field_explained() -> None:
    # The writer puts the explanation of every field beside it, so its own text is the complete one.
    assert SHIPPED.read_text() == model_text(read_protocol(SHIPPED))


def test_the_shipped_protocol_is_narrow_enough_to_read() -> None:
    assert max(map(len, SHIPPED.read_text().splitlines())) <= 110


def test_the_shipped_protocol_is_the_published_design() -> None:
    protocol = read_protocol(SHIPPED)
    assert protocol.study.participants == 20
    assert (protocol.dance.duration_s, protocol.session.rest_s) == (32.0, 300.0)
    assert (protocol.session.watch_repetitions, protocol.session.perform_repetitions) == (1, 1)
    assert [(test.outcome, len(test.conditions)) for test in protocol.analysis.tests] == [
        ("heart_rate_mean_bpm", 4),
        ("dtw_m", 4),
        ("smoothness_rating", 8),
    ]
    assert all(
        on.removesuffix("on") == off.removesuffix("off")
        for on, off in protocol.analysis.tests[2].pairs_list()
    )


MISTAKES = [
    (
        "duration_s = 32.0",
        "duration_s = 30.0",
        r"dance\.duration_s: a dance of 30 s .*; write 28\.0 or 32\.0\.",
    ),
    (
        "duration_s = 32.0",
        "duraton_s = 32.0",
        'dance.duraton_s: the field "duraton_s" is unknown; write "duration_s"',
    ),
    (
        'design = "williams"',
        'design = "wiliams"',
        'order.design: "wiliams" is not possible here; write "williams"',
    ),
    ('design = "williams"', 'design = "williams', "this is not valid TOML"),
    ('    "light-easy-off",', '    "light-easy-of",', 'order.labels: .* write "light-easy-off"'),
    ('"dtw_m"', '"dtw"', 'analysis.tests.outcome: "dtw" is no measured column .* write "dtw_m"'),
    ("[heart_rate]", "[heartrate]", 'heartrate: the field "heartrate" is unknown; write "heart_rate"'),
    ("rest_s = 300.0", 'rest_s = "long"', 'session.rest_s: "long" should be a valid number'),
    ("rest_s = 300.0", "rest_s = nan", "session.rest_s: NaN should be a finite number"),
    ('pairs = "all"', 'pairs = "al"', 'analysis.tests.pairs: "al" is not possible here; write "all"'),
    ('pairs = "all"', 'pairs = [["light-easy-on"]]', "analysis.tests.pairs: entry 2 of the list is missing"),
    ('pairs = "all"', 'pairs = [["a", "b"]]', 'analysis.tests.pairs: the pair .* names "a"'),
    ("participants = 20", "participants = 21", "order.extra_rows: 21 participants leave 5"),
    ("light = 25.0", "light = 85.0", r"dance.intensity.intense: light \(85\) is not below intense \(75\)"),
    ("[1, 7]", "[1, 5]", "questionnaires.smoothness.scale: 5 is not possible here; use one of: 7"),
]


@pytest.mark.parametrize(("right", "wrong", "message"), MISTAKES)
def test_a_typing_error_is_one_sentence_with_its_line(
    right: str, wrong: str, message: str, tmp_path: Path
) -> None:
    text = SHIPPED.read_text()
    line = text[: text.index(right)].count("\n") + 1
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(right, wrong, 1))
    with pytest.raises(InputError, match=message) as error:
        read_protocol(path)
    named = re.match(rf"{re.escape(str(path))}, line (\d+)", str(error.value))
    assert named is not None
    elsewhere = {
        "participants = 21": "extra_rows",
        "light = 85.0": "intense = ",
        '    "light-easy-of",': "labels",
    }
    if wrong in elsewhere:
        assert path.read_text().splitlines()[int(named[1]) - 1].startswith(elsewhere[wrong])
    else:
        assert int(named[1]) == line
    assert str(error.value).endswith(".")
    assert "\n" not in str(error.value)


def test_a_frozen_protocol_keeps_the_experimenters_own_words(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text("# my words\n" + SHIPPED.read_text())
    protocol = read_protocol(mine)
    write_protocol(protocol, tmp_path / "frozen.toml", source=mine)
    assert (tmp_path / "frozen.toml").read_bytes() == mine.read_bytes()
    write_protocol(protocol.with_participants(5), tmp_path / "five.toml")
    assert read_protocol(tmp_path / "five.toml") == protocol.with_participants(5)
    assert line_of((tmp_path / "five.toml").read_text(), ("study", "participants")) is not None


def test_nothing_is_written_over(tmp_path: Path) -> None:
    protocol = read_protocol(SHIPPED)
    (tmp_path / "there.toml").write_text("mine")
    with pytest.raises(InputError, match="a protocol is already there"):
        write_protocol(protocol, tmp_path / "there.toml")
    assert (tmp_path / "there.toml").read_text() == "mine"
    with pytest.raises(InputError, match="is not the protocol"):
        write_protocol(protocol.with_participants(8), tmp_path / "new.toml", source=SHIPPED)
    with pytest.raises(InputError, match="cannot be written"):
        write_protocol(protocol, tmp_path / "absent" / "new.toml")
    assert not (tmp_path / "new.toml").exists()


def test_every_field_of_the_shipped_protocol_is_found_on_its_own_line() -> None:
    text = SHIPPED.read_text()
    lines = text.splitlines()

    def fields(value: object, way: tuple[str | int, ...]) -> list[tuple[str | int, ...]]:
        inner = (
            value.items()
            if isinstance(value, dict)
            else list(enumerate(value))
            if isinstance(value, list)
            else []
        )
        holds_tables = any(isinstance(part, dict) for _, part in inner) or isinstance(value, dict)
        below = [found for key, part in inner for found in fields(part, (*way, key))] if holds_tables else []
        return [*below, way] if way and not holds_tables else below

    found = fields(read_protocol(SHIPPED).model_dump(mode="json", exclude_none=True), ())
    assert len(found) > 60
    for way in found:
        line = line_of(text, way)
        assert line is not None
        assert lines[line - 1].startswith(f"{way[-1]} = "), way
