from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.core.clock import Clock
from studykit.core.errors import InputError
from studykit.devices.clock import SimulatedClock
from studykit.devices.depth_camera import CameraFrame
from studykit.devices.heart_rate import HeartRateSample
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.journal import Journal, read_journal
from studykit.recording.session_record import read_session
from studykit.session.steps.question import ITEMS
from studykit.session.study import Study, open_study


@pytest.fixture
def study(tmp_path: Path, small_protocol: StudyProtocol) -> Study:
    return open_study(tmp_path / "pilot", protocol=small_protocol)


class Camera:
    """A camera of one's own: 10 pictures a second; may fail after some."""

    name, simulated = "own camera", False

    def __init__(self, clock: Clock, *, fails_after: int = 10**9) -> None:
        self._clock, self._left, self.is_open = clock, fails_after, False

    async def open(self) -> None:
        self.is_open = True

    async def read(self) -> CameraFrame:
        await self._clock.sleep_until(self._clock.now_s() + 0.1)
        self._left -= 1
        if self._left < 0:
            raise OSError("the cable was pulled out")
        return CameraFrame(time_s=self._clock.now_s(), positions=np.ones((24, 3)), confidence=np.ones(24))

    async def close(self) -> None:
        self.is_open = False


class Belt:
    """A belt of one's own: a reading every two seconds."""

    name, simulated = "own belt", False

    def __init__(self, clock: Clock) -> None:
        self._clock, self.is_open = clock, False

    async def open(self) -> None:
        self.is_open = True

    async def read(self) -> HeartRateSample:
        await self._clock.sleep_until(self._clock.now_s() + 2.0)
        return HeartRateSample(time_s=self._clock.now_s(), heart_rate_bpm=None, contact=False)

    async def close(self) -> None:
        self.is_open = False


class Interviewer:
    """Answers everything with the same; may never come back."""

    def __init__(self, *, rating: int = 4, never: str = "") -> None:
        self.asked: list[tuple[str, str | None]] = []
        self._rating, self._never = rating, never

    async def ask(self, questionnaire: str, condition: str | None) -> Mapping[str, int | float | str]:
        self.asked.append((questionnaire, condition))
        if questionnaire == self._never:
            await asyncio.Event().wait()
        if questionnaire == "demographics":
            return {"age": 30, "sex": "O", "height_m": 1.7, "weight_kg": 70, "dance_experience_years": 2.5}
        return dict.fromkeys(ITEMS[questionnaire], self._rating)


def own(clock: Clock, **changes: Any) -> dict[str, Any]:
    return {
        "camera": Camera(clock),
        "heart_rate": Belt(clock),
        "clock": clock,
        "questions": Interviewer(),
    } | changes


def test_a_simulated_visit_runs_to_its_end(study: Study, small_dances: dict[str, Any]) -> None:
    record = asyncio.run(study.session("01").run(small_dances))
    assert record.completed
    assert record.simulated
    assert all(step.is_complete for step in record.steps)
    assert [step.step for step in record.steps] == list(range(1, 14))
    assert record.devices == {"camera": "simulated depth camera", "heart_rate": "simulated heart-rate belt"}
    assert 100 < len(record.heart_rate_bpm) < 160
    assert np.all((record.heart_rate_bpm > 40) & (record.heart_rate_bpm < 200))
    assert len(record.frames(5)) == pytest.approx(120, abs=5)
    assert record.frames(1).times_s[-1] <= 1.0
    assert sorted(ITEMS["paces"]) == sorted(record.answers_to("paces") or {})
    assert {answers.condition for answers in record.answers if answers.questionnaire == "smoothness"} == set(
        small_dances
    )


def test_it_also_runs_inside_a_loop_that_already_runs(study: Study, small_dances: dict[str, Any]) -> None:
    async def notebook_cell() -> bool:
        others = 0

        async def somebody_else() -> None:
            nonlocal others
            while True:
                await asyncio.sleep(0)
                others += 1

        task = asyncio.create_task(somebody_else())
        record = await study.session("01").run(small_dances)
        task.cancel()
        study.simulate(small_dances)  # starts no second loop in this thread
        return record.completed and others > 0

    assert asyncio.run(notebook_cell())
    assert [record.completed for record in study.sessions()] == [True, True]


def test_a_visit_with_real_devices_says_so_and_is_kept_safe_every_second(
    study: Study, small_dances: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock, synced = SimulatedClock(), []
    sync = Journal.sync
    monkeypatch.setattr(Journal, "sync", lambda journal: (synced.append(clock.now_s()), sync(journal))[1])
    interviewer = Interviewer()
    camera, belt = Camera(clock), Belt(clock)
    record = asyncio.run(
        study.session("01").run(
            small_dances, camera=camera, heart_rate=belt, clock=clock, questions=interviewer
        )
    )
    assert record.completed
    assert not record.simulated
    assert record.devices == {"camera": "own camera", "heart_rate": "own belt"}
    assert np.all(record.heart_rate_bpm == 0.0)  # no reading
    assert record.answers_to("demographics") == {
        "age": 30,
        "sex": "O",
        "height_m": 1.7,
        "weight_kg": 70,
        "dance_experience_years": 2.5,
    }
    assert interviewer.asked[-2:] == [("paces", None), ("demographics", None)]
    assert max(np.diff(sorted(synced))) <= 1.0
    assert not camera.is_open
    assert not belt.is_open
    assert not study.folder.planted.exists()


def test_a_device_that_fails_interrupts_the_step_and_the_visit_goes_on_later(
    study: Study, small_dances: dict[str, Any]
) -> None:
    clock = SimulatedClock()
    camera, belt = Camera(clock, fails_after=30), Belt(clock)
    session = study.session("01")
    with pytest.raises(OSError, match="the cable was pulled out"):
        asyncio.run(session.run(small_dances, **own(clock, camera=camera, heart_rate=belt)))
    assert not camera.is_open
    assert not belt.is_open
    last = read_journal(session.path)[-1]
    assert last.kind == "step_interrupted"
    assert last.data == {"step": 5, "reason": "own camera: the cable was pulled out"}
    before = session.path.read_bytes()

    later = SimulatedClock(start_s=500.0)
    record = asyncio.run(study.session("01").run(small_dances, **own(later)))
    assert session.path.read_bytes().startswith(before)
    performed = [step for step in record.steps if step.phase == "perform"]
    assert [(step.step, step.is_complete) for step in performed] == [(5, False), (6, True), (10, True)]
    assert performed[0].condition == performed[1].condition
    assert performed[0].stop_s < 500.0 <= performed[1].start_s
    assert len(record.frames(5)) == 30 - len(record.frames(1))
    assert record.completed


def test_somebody_who_stops_the_visit_interrupts_the_step(study: Study, small_dances: dict[str, Any]) -> None:
    session = study.session("01")

    async def stopped() -> None:
        clock = SimulatedClock()
        never = Interviewer(never="smoothness")
        task = asyncio.create_task(session.run(small_dances, **own(clock, questions=never)))
        while not never.asked:
            await asyncio.sleep(0)
        task.cancel()
        await task

    with pytest.raises(asyncio.CancelledError):
        asyncio.run(stopped())
    last = read_journal(session.path)[-1]
    assert (last.kind, last.data) == ("step_interrupted", {"step": 6, "reason": "CancelledError"})
    assert session.state.steps_completed == 5


def test_an_impossible_answer_interrupts_the_step(study: Study, small_dances: dict[str, Any]) -> None:
    session = study.session("01")
    with pytest.raises(InputError, match="rating is 9"):
        asyncio.run(session.run(small_dances, **own(SimulatedClock(), questions=Interviewer(rating=9))))
    assert read_journal(session.path)[-1].data["reason"] == "smoothness: rating is 9; tick 1 to 7."


def test_a_finished_visit_is_refused_and_nothing_is_touched(
    study: Study, small_dances: dict[str, Any]
) -> None:
    session = study.session("01")
    asyncio.run(session.run(small_dances))
    before = session.path.read_bytes()
    with pytest.raises(InputError, match=r"sub-01_ses-01\.jsonl: .* recorded to its end; choose another"):
        study.session("01")
    with pytest.raises(InputError, match="recorded to its end"):
        asyncio.run(session.run(small_dances))
    assert session.path.read_bytes() == before
    study.session("01", session="02")


def interrupted(study: Study, dances: dict[str, Any], **devices: Any) -> Path:
    session = study.session("01")
    with pytest.raises(OSError, match="cable"):
        asyncio.run(session.run(dances, **devices))
    return session.path


def test_a_visit_goes_on_only_as_it_was_begun(study: Study, small_dances: dict[str, Any]) -> None:
    clock = SimulatedClock()
    path = interrupted(study, small_dances, **own(clock, camera=Camera(clock, fails_after=30)))
    before = path.read_bytes()
    other = {
        name: type(dance)(dance.condition, dance.motion, "f" * 64) for name, dance in small_dances.items()
    }
    for dances, devices, message in (
        (small_dances, {}, "real and simulated devices cannot be mixed"),
        (other, own(SimulatedClock()), "begun with other dances"),
    ):
        with pytest.raises(InputError, match=message):
            asyncio.run(study.session("01").run(dances, **devices))
    assert path.read_bytes() == before
    assert not study.folder.planted.exists()


def test_an_unknown_device_and_a_missing_interviewer_are_refused(
    study: Study, small_dances: dict[str, Any]
) -> None:
    session = study.session("01")
    with pytest.raises(InputError, match='there is no device "kinect"'):
        asyncio.run(session.run(small_dances, camera="kinect"))
    with pytest.raises(InputError, match="nobody asks the questionnaires"):
        asyncio.run(session.run(small_dances, heart_rate=Belt(SimulatedClock())))
    assert not session.path.exists()


def test_half_real_is_simulated(study: Study, small_dances: dict[str, Any]) -> None:
    clock = SimulatedClock()
    record = asyncio.run(
        study.session("01").run(small_dances, heart_rate=Belt(clock), clock=clock, questions=Interviewer())
    )
    assert record.simulated
    assert record.devices == {"camera": "simulated depth camera", "heart_rate": "own belt"}


def test_a_journal_without_a_whole_line_is_begun_again(study: Study, small_dances: dict[str, Any]) -> None:
    path = study.folder.journal("01", "01")
    path.parent.mkdir(parents=True)
    path.write_text('{"number":1,"ti')
    with pytest.raises(InputError, match="holds no session yet"):
        read_session(path)
    record = asyncio.run(study.session("01").run(small_dances))
    assert record.completed


def test_every_record_names_the_protocol_and_whether_it_is_simulated(
    study: Study, small_dances: dict[str, Any]
) -> None:
    asyncio.run(study.session("02").run(small_dances))
    first = json.loads(study.folder.journal("02", "01").read_text().splitlines()[0])["data"]
    assert first["protocol_sha256"] == study.protocol.sha256
    assert first["simulated"] is True
    assert first["utc_anchor"] == "2000-01-01T00:00:00.000000Z"
    assert first["participant"] == "02"
    assert first["dance_sha256"] == {name: dance.sha256 for name, dance in small_dances.items()}
    assert first["versions"]["studykit"]
