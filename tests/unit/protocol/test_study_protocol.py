from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.protocol.condition import ALL_CONDITIONS, Condition
from studykit.protocol.study_protocol import StudyProtocol

SHIPPED = Path(__file__).resolve().parents[3] / "protocols" / "dance-2x2x2.toml"


@pytest.fixture(scope="module")
def protocol() -> StudyProtocol:
    return read_protocol(SHIPPED)


def changed(protocol: StudyProtocol, table: str, **values: Any) -> StudyProtocol:
    fields = deepcopy(protocol.model_dump(mode="json"))
    part = fields
    for name in table.split("."):
        part = part[name]
    part.update(values)
    return StudyProtocol.model_validate(fields)


def test_it_lists_the_eight_conditions(protocol: StudyProtocol) -> None:
    assert sorted(protocol.conditions_list()) == sorted(ALL_CONDITIONS)
    assert protocol.condition("light-easy-on") == Condition.parse("light-easy-on")
    with pytest.raises(InputError, match="is no condition of this study"):
        protocol.condition("light-easy")


def test_it_cannot_be_changed(protocol: StudyProtocol) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        protocol.study.seed = 2  # type: ignore[misc]


def test_the_digest_depends_on_content_alone(protocol: StudyProtocol) -> None:
    assert (
        StudyProtocol.model_validate_json(json.dumps(protocol.model_dump(mode="json"))).sha256
        == protocol.sha256
    )
    assert changed(protocol, "study", seed=2).sha256 != protocol.sha256
    assert changed(protocol, "analysis", alpha=0.01).sha256 != protocol.sha256


@pytest.mark.parametrize(
    ("duration_s", "remedy"),
    [(30.0, r"write 28\.0 or 32\.0"), (33.5, r"write 32\.0 or 36\.0"), (2.0, r"write 4\.0")],
)
def test_a_dance_of_broken_pieces_is_refused(protocol: StudyProtocol, duration_s: float, remedy: str) -> None:
    with pytest.raises(ValidationError, match=remedy):
        changed(protocol, "dance", duration_s=duration_s)


@pytest.mark.parametrize("duration_s", [4.0, 32.0, 128.0])
def test_a_dance_of_whole_pieces_is_accepted(protocol: StudyProtocol, duration_s: float) -> None:
    assert changed(protocol, "dance", duration_s=duration_s).dance.duration_s == duration_s


@pytest.mark.parametrize(
    ("table", "values", "message"),
    [
        ("conditions", {"variety": ["easy"]}, "no combination of the levels"),
        ("conditions", {"variety": ["easy", "easy"]}, "stands twice"),
        ("order", {"labels": [*ALL_CONDITIONS[:7], ALL_CONDITIONS[0]]}, "stands twice"),
        ("order", {"labels": list(ALL_CONDITIONS[:7])}, 'the condition "intense-hard-off" is missing'),
        ("order", {"labels": [*ALL_CONDITIONS[:7], "intense-hard-of"]}, 'write "intense-hard-off"'),
        ("order", {"extra_rows": [1, 3, 5, 9]}, "no row 9"),
        ("order", {"extra_rows": [1, 3, 5, 5]}, "stands twice"),
        ("order", {"extra_rows": [1, 3]}, "name 4 rows, or set participants to 16 or 24"),
        ("study", {"participants": 5}, "name 5 rows, or set participants to 8"),
        ("study", {"name": "my study/1"}, "pattern"),
        ("dance.intensity", {"light": 80.0}, "is not below"),
        ("dance.variety", {"hard": 0.5}, "is not below"),
        ("heart_rate", {"vigorous_fraction": 70.0}, "less than or equal to 1"),
        ("questionnaires.paces", {"scale": [1, 5]}, "should be 7"),
    ],
)
def test_what_does_not_fit_is_refused(
    protocol: StudyProtocol, table: str, values: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValidationError, match=message):
        changed(protocol, table, **values)


def test_a_test_of_a_condition_that_is_not_in_the_study_is_refused(protocol: StudyProtocol) -> None:
    values = protocol.model_dump(mode="json")
    values["conditions"]["transition"] = ["on"]
    values["order"] = {
        "design": "williams",
        "labels": [name for name in protocol.conditions_list() if name.endswith("on")],
        "extra_rows": [],
    }
    with pytest.raises(ValidationError, match="is no condition of this study"):
        StudyProtocol.model_validate(values)
    values["analysis"]["tests"] = values["analysis"]["tests"][:2]
    values["analysis"]["equivalences"] = None
    assert len(StudyProtocol.model_validate(values).conditions_list()) == 4


@pytest.mark.parametrize("participants", [1, 5, 8, 16, 20, 23, 100])
def test_the_same_study_for_other_numbers_of_people(protocol: StudyProtocol, participants: int) -> None:
    other = protocol.with_participants(participants)
    assert other.study.participants == participants
    assert other.order.extra_rows[:4] == protocol.order.extra_rows
    assert other.analysis == protocol.analysis


@pytest.mark.parametrize(
    ("kind", "number", "changes", "problem"),
    [
        ("tests", 2, {"correction": "closed"}, "closed testing is for all pairs of up to 6 conditions"),
        ("equivalences", 0, {"low": 5.0}, r"low \(5\) is not below high \(5\)"),
        ("equivalences", 0, {"b": "intense-hard-on"}, "is compared with itself"),
        ("equivalences", 0, {"a": "none"}, '"none" is no condition of this study'),
        ("curves", 0, {"conditions": ["light-easy-on", "light-easy-on"]}, "stands twice"),
        ("curves", 1, {"name": "heart_rate_over_time"}, 'the name "heart_rate_over_time" stands twice'),
        ("models", 0, {"outcome": "dtw"}, 'write "dtw_m"'),
        ("models", 0, {"factors": ["variety", "variety"]}, 'the factor "variety" stands twice'),
    ],
)
def test_what_cannot_be_analysed_is_refused_before_the_study(
    protocol: StudyProtocol, kind: str, number: int, changes: dict[str, object], problem: str
) -> None:
    values = protocol.model_dump(mode="json")
    values["analysis"][kind][number] |= changes
    with pytest.raises(ValidationError, match=problem):
        StudyProtocol.model_validate(values)


def test_the_analysis_names_every_column_that_it_needs_once(protocol: StudyProtocol) -> None:
    assert protocol.analysis.outcomes == (
        "heart_rate_mean_bpm",
        "dtw_m",
        "smoothness_rating",
        "linear_energy_asked",
        "rotational_energy_asked",
        "variety_achieved",
    )
