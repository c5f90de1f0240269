from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import BaseModel, ConfigDict, Field

from studykit.core.errors import InputError
from studykit.io.toml_file import line_of, model_text, read_model
from studykit.participant.effects import NONE, PAPER, Effects


class Inner(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    text: str = Field(description="some text")
    numbers: tuple[float, ...] = Field(default=(), description="some numbers")


class Outer(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    count: int = Field(description="how many")
    inner: Inner
    many: tuple[Inner, ...] = ()


@pytest.fixture
def read(tmp_path: Path):
    path = tmp_path / "settings.toml"

    def reading(content: str | bytes) -> Outer:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_model(path, Outer)

    return reading


LAYOUTS = """count = 1 # one

[inner]
text = '''
three
[[many]]
'''
numbers = [
  1,
  2,
]
[[many]]
text = "a"
[[many]]
text = "b"
numbers = [3]
"""


@pytest.mark.parametrize(
    ("field", "line"),
    [
        (("count",), 1),
        (("inner",), 3),
        (("inner", "text"), 4),
        (("inner", "numbers"), 8),
        (("inner", "numbers", 1), 8),
        (("many", 0, "text"), 13),
        (("many", 1), 14),
        (("many", 1, "text"), 15),
        (("many", 1, "numbers", 0), 16),
        (("absent",), None),
        (("inner", "absent"), None),
        (("many", 2), None),
    ],
)
def test_the_line_of_a_field(field: tuple[str | int, ...], line: int | None) -> None:
    assert line_of(LAYOUTS, field) == line


@pytest.mark.parametrize(
    ("text", "field", "line"),
    [
        ("a.b.c = 1\na.d = 2", ("a", "d"), 2),
        ("x = 1\na = { b = 1, c = { d = 2 } }", ("a", "c", "d"), 2),
        ('# a = 0\n"a" = 1', ("a",), 2),
        ("a = '# no comment' # b = 1\nb = 2", ("b",), 2),
        ("[a]\r\nb = 1\r\n\r\nc = 2\r\n", ("a", "c"), 4),
        ("a = [\n {b = 1},\n {b = 2},\n]", ("a", 1, "b"), 1),
        ("[a.b]\nc = 1\n[a]\nd = 2", ("a", "d"), 4),
        ("a = '\u2028'\nb = 2", ("b",), 2),
    ],
)
def test_the_line_in_other_layouts(text: str, field: tuple[str | int, ...], line: int) -> None:
    assert line_of(text, field) == line


def test_a_whole_file_is_read(read) -> None:
    outer = read(b"\xef\xbb\xbf" + LAYOUTS.encode())  # with the mark that some editors put first
    assert outer.many[1].numbers == (3.0,)
    assert outer.inner.text == "three\n[[many]]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "cout = 1\n[inner]\ntext = 'a'",
            '{}, line 1, cout: the field "cout" is unknown; write "count" if that was meant.',
        ),
        ("count = 1", '{}, inner: the field "inner" is missing; add it.'),
        ("count = 1\n[inner]", '{}, line 2, inner.text: the field "text" is missing; add it (some text).'),
        (
            "count = 1\n[inner]\ntext = 'a'\nnumbers = [1, '2']",
            '{}, line 4, inner.numbers: "2" should be a valid number; correct the value (some numbers).',
        ),
        (
            "count = true\n[inner]\ntext = 'a'",
            "{}, line 1, count: true should be a valid integer; correct the value (how many).",
        ),
        (
            "count = 1\n[inner]\ntext = 'a'\n[[many]]\ntext = 'b'\n[[many]]\ntxt = 'c'",
            '{}, line 7, many.txt: the field "txt" is unknown; write "text" if that was meant.',
        ),
        (
            "count = 1\n[inner]\ntext = 'a'\nfoo.bar = 1",
            '{}, line 4, inner.foo: the field "foo" is unknown; use one of: text, numbers.',
        ),
        ("count = 1979-05-27\n[inner]\ntext = 'a'", "{}, line 1, count: "),
    ],
)
def test_an_error_names_file_line_field_and_remedy(read, tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError) as error:
        read(text)
    expected = message.format(tmp_path / "settings.toml")
    assert str(error.value) == expected or (
        not message.endswith(".") and str(error.value).startswith(expected)
    )
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("count = 1\ncount = 2", 2),
        ("count = 1\n[inner\n", 2),
        ("count = 1\n[inner]\ntext = 'a\n", 3),
        ("count = 1\n[inner]\nnumbers = [1,\n2,\n3", 3),
        ("count = 1\n[inner]\ntext = '''a\nb\n", 3),
        ("count = 1\n[inner]\ntext = ", 3),
        ("nonsense", 1),
    ],
)
def test_broken_toml_names_the_line_where_it_begins(read, text: str, line: int) -> None:
    with pytest.raises(InputError, match=rf"settings\.toml, line {line}: this is not valid TOML \("):
        read(text)


def test_what_is_no_readable_text_is_one_sentence(read, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the file is not text; save it as UTF-8 text"):
        read(b"count = '\xff'")
    with pytest.raises(InputError, match=r"there is no such file; use .*settings\.toml if that was meant"):
        read_model(tmp_path / "setings.toml", Outer)
    with pytest.raises(InputError, match="there is no such file; check the path"):
        read_model(tmp_path / "absent" / "x.toml", Outer)
    with pytest.raises(InputError, match="cannot be read"):
        read_model(tmp_path, Outer)


@pytest.mark.parametrize("effects", [PAPER, NONE])
def test_what_is_written_is_read_back_and_explained(effects: Effects, tmp_path: Path) -> None:
    path = tmp_path / "effects.toml"
    path.write_text(model_text(effects))
    assert read_model(path, Effects) == effects
    assert "# share of the heart-rate reserve that a dance asks for" not in path.read_text()
    assert "# standard deviation between people" in path.read_text()


def test_difficult_texts_survive(tmp_path: Path) -> None:
    outer = Outer(
        count=3,
        inner=Inner(text='"\\\n\t\x7f\x00é 💃 # [x]', numbers=(1e-7, 1e22, -0.0)),
        many=(Inner(text=""),),
    )
    path = tmp_path / "outer.toml"
    path.write_text(model_text(outer), encoding="utf-8")
    assert read_model(path, Outer) == outer


@pytest.mark.parametrize(
    "text",
    [
        "count = " + "[" * 3000,
        "count = " + "{a=" * 3000,
        "a." * 3000 + "a = 1",
        "count = " + "9" * 5000,
        "count = 0x" + "9" * 5000,
    ],
    ids=["brackets", "tables", "dots", "digits", "sixteens"],
)
def test_what_nests_or_counts_beyond_all_reason_is_refused(read, text: str) -> None:
    with pytest.raises(InputError, match=r"settings\.toml: a number is too long or brackets are nested"):
        read(text)


def test_many_mistakes_do_not_take_for_ever(read) -> None:
    fields = "".join(f"a{number} = 1\n" for number in range(1500))
    with pytest.raises(InputError, match=r"line 1, a0: the field"):
        read(fields)
    with pytest.raises(InputError, match=r"line 1501, count: "):
        read("# nothing\n" * 1500 + "count = 'a'\n[inner]\ntext = 'a'\n")
    with pytest.raises(InputError, match=r"line 2: this is not valid TOML"):
        read("count = 1\nx = [\n" + "1,\n" * 5000)


def test_a_line_end_in_a_name_does_not_break_the_sentence(read) -> None:
    with pytest.raises(InputError) as caught:
        read('count = 1\n"a\\nb" = 1\n[inner]\ntext = "a"\n')
    assert len(str(caught.value).splitlines()) == 1


def test_a_path_that_no_file_can_have_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file can be called that"):
        read_model(tmp_path / "a\0.toml", Outer)
