from __future__ import annotations

import asyncio
import json
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.targets import goals
from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol, write_protocol
from studykit.participant.effects import NONE
from studykit.protocol.study_protocol import StudyProtocol
from studykit.session.runner import check_dances
from studykit.session.study import open_study


def bytes_below(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_a_protocol_file_is_frozen_byte_for_byte(tmp_path: Path, small_protocol: StudyProtocol) -> None:
    source = tmp_path / "own.toml"
    write_protocol(small_protocol, source)
    source.write_text("# written by hand\n" + source.read_text())
    study = open_study(tmp_path / "pilot", protocol=source)
    assert study.folder.protocol.read_bytes() == source.read_bytes()
    assert study.protocol == small_protocol
    assert open_study(str(tmp_path / "pilot"), protocol=small_protocol) == study
    assert open_study(tmp_path / "pilot") == study
    assert study.participants == ("01", "02")
    assert study.sessions() == ()


def test_a_protocol_in_memory_is_frozen_too(tmp_path: Path, small_protocol: StudyProtocol) -> None:
    study = open_study(tmp_path / "pilot", protocol=small_protocol)
    assert read_protocol(study.path / "code" / "protocol.toml") == small_protocol


def test_another_protocol_is_refused_and_nothing_is_touched(
    tmp_path: Path, small_protocol: StudyProtocol
) -> None:
    open_study(tmp_path / "pilot", protocol=small_protocol)
    before = bytes_below(tmp_path)
    changed = small_protocol.model_copy(
        update={"dance": small_protocol.dance.model_copy(update={"duration_s": 8.0})}
    )
    with pytest.raises(InputError, match=r"protocol\.toml: .*another protocol; use another folder"):
        open_study(tmp_path / "pilot", protocol=changed)
    assert bytes_below(tmp_path) == before


def test_a_folder_without_a_study_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no study here; name the folder"):
        open_study(tmp_path / "pilot")
    assert not (tmp_path / "pilot").exists()


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path, small_protocol: StudyProtocol) -> None:
    (tmp_path / "pilot").write_text("a file in the way")
    with pytest.raises(InputError, match="pilot: the folder cannot be written"):
        open_study(tmp_path / "pilot", protocol=small_protocol)
    assert (tmp_path / "pilot").read_text() == "a file in the way"


@pytest.mark.parametrize("participant", ["00", "3", "03", "1", "sub-01", ""])
def test_an_unknown_participant_is_refused(
    tmp_path: Path, small_protocol: StudyProtocol, participant: str
) -> None:
    study = open_study(tmp_path / "pilot", protocol=small_protocol)
    before = bytes_below(tmp_path)
    with pytest.raises(InputError, match="choose one from 01 to 02"):
        study.session(participant)
    assert bytes_below(tmp_path) == before


@pytest.mark.parametrize("number", ["../01", "", "0 1", "é"])
def test_a_visit_needs_a_plain_number(tmp_path: Path, small_protocol: StudyProtocol, number: str) -> None:
    with pytest.raises(InputError, match="no number of a visit"):
        open_study(tmp_path / "pilot", protocol=small_protocol).session("01", session=number)


def test_a_study_is_simulated_only_as_it_was_begun(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    study = open_study(tmp_path / "pilot", protocol=small_protocol)
    labels = []

    def progress(items: Any, *, label: str, total: int) -> Any:
        labels.append((label, total))
        return items

    study.simulate(small_dances, effects=NONE, seed=5, progress=progress)
    before = bytes_below(tmp_path)
    study.simulate(small_dances, effects=NONE, seed=5, progress=progress)
    assert labels == [("Simulating visits", 2), ("Simulating visits", 0)]
    assert bytes_below(tmp_path) == before
    for changes in ({"seed": 6, "effects": NONE}, {"seed": 5}):
        with pytest.raises(InputError, match="other effects or another seed"):
            study.simulate(small_dances, **changes)
    assert bytes_below(tmp_path) == before
    planted = json.loads((study.path / "sourcedata/simulation/planted.json").read_text())
    assert planted["seed"] == 5
    assert planted["effects"]["name"] == "none"
    assert planted["people"]["02"]["maximum_heart_rate_bpm"] > 100


def test_a_study_that_broke_off_is_simulated_to_its_end(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    whole, broken = (open_study(tmp_path / name, protocol=small_protocol) for name in ("whole", "broken"))
    whole.simulate(small_dances)
    asyncio.run(broken.session("01").run(small_dances))  # recorded, and not yet exported
    broken.simulate(small_dances)
    assert bytes_below(broken.path) == bytes_below(whole.path)


def test_dances_must_be_those_of_the_protocol(
    tmp_path: Path, small_protocol: StudyProtocol, small_dances: dict[str, Any]
) -> None:
    study = open_study(tmp_path / "pilot", protocol=small_protocol)
    before = bytes_below(tmp_path)
    with pytest.raises(InputError, match="light-easy-on has no dance"):
        study.simulate({"intense-easy-on": small_dances["intense-easy-on"]})
    longer = StudyProtocol.model_validate(
        small_protocol.model_dump(mode="json")
        | {"dance": small_protocol.dance.model_dump(mode="json") | {"duration_s": 8.0}}
    )
    other = open_study(tmp_path / "longer", protocol=longer)
    with pytest.raises(InputError, match="lasts 4 s, but the protocol says 8 s"):
        other.simulate(small_dances)
    assert bytes_below(study.path) == {key[6:]: value for key, value in before.items()}


def test_dances_must_spare_what_the_protocol_spares(
    tmp_path: Path, small_protocol: StudyProtocol, made_library, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = made_library(20)
    # Whether single segments are as intense as asked is not the question here.
    monkeypatch.setattr(
        import_module("studykit.choreography.choreograph"), "require_reachable", lambda *_: None
    )
    spared = {"joints": ["right_hand"], "weight": 0.0, "speed_percentile": 60.0, "cost_weight": 0.2}
    values = small_protocol.model_dump(mode="json")
    careful = StudyProtocol.model_validate(values | {"dance": values["dance"] | {"spare": spared}})
    free, held = (
        {name: dance(one, library, is_preview=True) for name, one in goals(protocol, library).items()}
        for protocol in (small_protocol, careful)
    )
    study = open_study(tmp_path / "pilot", protocol=careful)
    with pytest.raises(InputError, match="light-easy-on does not spare right_hand, as the protocol says"):
        study.simulate(free)
    check_dances(held, careful)
    check_dances(free, small_protocol)
