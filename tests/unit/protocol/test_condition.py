from __future__ import annotations

import pytest

from studykit.core.errors import InputError
from studykit.protocol.condition import ALL_CONDITIONS, Condition


def test_every_name_is_read_and_written_back() -> None:
    assert len(set(ALL_CONDITIONS)) == 8
    assert [str(Condition.parse(name)) for name in ALL_CONDITIONS] == list(ALL_CONDITIONS)
    assert Condition.parse("light-hard-off") == Condition(intensity="light", variety="hard", transition="off")


@pytest.mark.parametrize("name", ["intense-hard-onn", "easy-intense-on", "light-easy", ""])
def test_an_unknown_name_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="is no condition"):
        Condition.parse(name)


def test_the_nearest_name_is_the_remedy() -> None:
    with pytest.raises(InputError, match='write "intense-hard-on" if that was meant'):
        Condition.parse("intense-hrad-on")
