from __future__ import annotations

from studykit.protocol.latin_square import assignment
from studykit.protocol.study_protocol import StudyProtocol
from studykit.session.plan import PHASES, plan


def test_a_visit_has_its_phases_in_order(small_protocol: StudyProtocol) -> None:
    sequence = assignment(small_protocol)[0]
    steps = plan(small_protocol, sequence)
    condition = ["watch", "perform", "smoothness", "rest"]
    phases = ["calibrate", "baseline", "train", *condition, *condition, "paces", "demographics"]
    assert [step.phase for step in steps] == phases
    assert [step.condition for step in steps[3:11:4]] == list(sequence.conditions)
    assert [step.period for step in steps] == [None] * 3 + [1] * 4 + [2] * 4 + [None] * 2
    assert [step.duration_s for step in steps[:7]] == [1.0, 2.0, 1.0, 4.0, 4.0, None, 2.0]
    assert set(phases) == set(PHASES)


def test_watching_and_dancing_can_be_repeated_or_watching_left_out(small_protocol: StudyProtocol) -> None:
    values = small_protocol.model_dump(mode="json")
    values["session"] |= {"watch_repetitions": 0, "perform_repetitions": 2}
    protocol = StudyProtocol.model_validate(values)
    phases = [step.phase for step in plan(protocol, assignment(protocol)[0])]
    assert phases[3:7] == ["perform", "perform", "smoothness", "rest"]


def test_the_published_study_takes_less_than_an_hour(small_protocol: StudyProtocol) -> None:
    values = small_protocol.model_dump(mode="json")
    values["dance"]["duration_s"] = 32.0
    values["session"] |= {"calibrate_s": 5.0, "baseline_s": 120.0, "train_s": 120.0, "rest_s": 300.0}
    protocol = StudyProtocol.model_validate(values)
    total = sum(step.duration_s or 0.0 for step in plan(protocol, assignment(protocol)[0]))
    assert total == 245 + 2 * (32 + 32 + 300)
