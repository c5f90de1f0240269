"""The runner: takes one participant through the plan and records it. Only here does anything wait."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from collections.abc import Sequence as Sequence_
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studykit.choreography.dance import Dance
from studykit.core.clock import Clock
from studykit.core.errors import InputError
from studykit.core.provenance import versions
from studykit.devices.depth_camera import CameraFrame
from studykit.devices.device import Device
from studykit.devices.heart_rate import HeartRateSample
from studykit.library.dance_file import write_dances
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES
from studykit.participant.effects import Effects
from studykit.participant.person import Person
from studykit.protocol.latin_square import Sequence
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.frames import FrameWriter
from studykit.recording.journal import Journal, read_journal
from studykit.recording.session_record import SessionRecord, read_session
from studykit.recording.study_folder import StudyFolder
from studykit.session.plan import plan
from studykit.session.planted import plant
from studykit.session.setting import Equipment, Questions, Setting, set_up
from studykit.session.simulated_participant import SimulatedParticipant
from studykit.session.state import SessionState, replay, transition
from studykit.session.step import Answer, Reply, ShownDance, Step
from studykit.session.steps import build
from studykit.session.steps.question import check

_SYNC_EVERY_S = 1.0


@dataclass(frozen=True, kw_only=True)
class Session:
    """One visit of one participant, ready to run; `Study.session` gives one.

    Parameters
    ----------
    folder : StudyFolder
        Where it is recorded.
    protocol : StudyProtocol
        What is followed.
    sequence : Sequence
        Who comes, and in which order the conditions are danced.
    name : str
        Number of the visit, such as "01".
    people : tuple of Person
        Everybody of this study, as far as people are simulated.
    effects : Effects
        What is planted in simulated people.
    seed : int
        Grows all chance of a simulated visit.
    """

    folder: StudyFolder
    protocol: StudyProtocol
    sequence: Sequence
    name: str
    people: tuple[Person, ...]
    effects: Effects
    seed: int

    @property
    def path(self) -> Path:
        """The journal."""
        return self.folder.journal(self.sequence.participant, self.name)

    @property
    def state(self) -> SessionState:
        """How far the visit has come."""
        return replay(read_journal(self.path)) if self.path.exists() else SessionState()

    async def run(
        self,
        dances: Mapping[str, ShownDance],
        *,
        camera: Device[CameraFrame] | str = "simulated",
        heart_rate: Device[HeartRateSample] | str = "simulated",
        clock: Clock | None = None,
        questions: Questions | None = None,
    ) -> SessionRecord:
        """Run the visit from where it was left, and record it.

        Parameters
        ----------
        dances : mapping of str to dance
            The dance of each condition.
        camera, heart_rate : Device or "simulated", optional
            What measures.
        clock : Clock, optional
            The clock of your devices. If everything is simulated, an hour takes a second.
        questions : Questions, optional
            Who hands out the questionnaires; needed unless everything is simulated.

        Returns
        -------
        SessionRecord

        Raises
        ------
        InputError
            If the visit is over, or what is given does not fit what was recorded; nothing is touched then.
        """
        equipment = Equipment(camera=camera, heart_rate=heart_rate, clock=clock, questions=questions)
        person = next(person for person in self.people if person.id == self.sequence.participant)
        participant = SimulatedParticipant(person, self.effects, seed=self.seed, session=self.name)
        state = self.state
        setting = set_up(equipment, participant, state)
        check_dances(dances, self.protocol)
        self._check_continuation(state, setting, dances)
        keep(dances, self.folder)
        if setting.participant is not None:
            plant(self.folder.planted, effects=self.effects, seed=self.seed, people=self.people)
        steps = [build(planned, dances) for planned in plan(self.protocol, self.sequence)]
        with Journal.reopen(self.path) if self.path.exists() else Journal.create(self.path) as journal:
            run = _Run(setting, journal)
            run.begin(self._introduction(setting, dances))
            await run.take(steps[run.state.steps_completed :])
        return read_session(self.path)

    def _check_continuation(
        self, state: SessionState, setting: Setting, dances: Mapping[str, ShownDance]
    ) -> None:
        """Refuse to go on with a visit in another way than it was begun."""
        if state.is_completed:
            raise already_recorded(self.path)
        new = self._introduction(setting, dances)
        for key, what in (
            ("simulated", "real and simulated devices cannot be mixed in one visit"),
            ("protocol_sha256", "the visit was begun under another protocol"),
            ("dance_sha256", "the visit was begun with other dances"),
            ("conditions", "the visit was begun with another order of conditions"),
        ):
            if state.started and state.started[key] != new[key]:
                raise InputError(what, where=self.path, remedy="go on with what it was begun with")

    def _introduction(self, setting: Setting, dances: Mapping[str, ShownDance]) -> dict[str, Any]:
        """Give what the first record says."""
        return {
            "participant": self.sequence.participant,
            "session": self.name,
            "sequence": self.sequence.number,
            "conditions": list(self.sequence.conditions),
            "protocol_sha256": self.protocol.sha256,
            "simulated": setting.is_simulated,
            "devices": {"camera": setting.camera.name, "heart_rate": setting.heart_rate.name},
            "utc_anchor": setting.clock.utc_anchor,
            "joint_names": list(JOINT_NAMES),
            "dance_sha256": {condition: dances[condition].sha256 for condition in sorted(dances)},
            "versions": versions(),
        }


def check_dances(dances: Mapping[str, ShownDance], protocol: StudyProtocol) -> None:
    """Refuse dances that are not those of the protocol.

    Raises
    ------
    InputError
        If a condition has no dance, or one of another length or body, or one that does not spare the joints
        that the protocol spares.
    """
    for condition in protocol.conditions_list():
        if condition not in dances:
            raise InputError(
                f"the condition {condition} has no dance",
                where="dances",
                remedy="make the dances of all conditions first",
            )
        motion = dances[condition].motion
        if abs(motion.duration_s - protocol.dance.duration_s) > 1.5 / motion.frame_rate_hz:
            raise InputError(
                f"the dance of {condition} lasts {motion.duration_s:g} s, "
                f"but the protocol says {protocol.dance.duration_s:g} s",
                where="dances",
                remedy="make the dances with this protocol",
            )
        _require_spared(condition, dances[condition], protocol)
        if motion.skeleton.joint_names != JOINT_NAMES:
            raise InputError(
                f"the dance of {condition} has other joints than SMPL's 24",
                where="dances",
                remedy="make the dances with a studykit library",
            )


def _require_spared(condition: str, shown: ShownDance, protocol: StudyProtocol) -> None:
    """Refuse a dance that does not spare what the protocol spares."""
    plan = protocol.dance.spare
    if plan is None or not isinstance(shown, Dance):
        return
    spared = () if shown.mask is None else shown.mask.spared
    told = shown.joints()
    for joint in spare(plan.joints).spared:
        if joint not in spared or not told[joint]["is_kept"]:
            raise InputError(
                f"the dance of {condition} does not spare {joint}, as the protocol says",
                where="dances",
                remedy="make the dances with this protocol",
            )


def keep(dances: Mapping[str, ShownDance], folder: StudyFolder) -> None:
    """Write the dances that are shown into the study, unless they are there; results are told against them.

    Raises
    ------
    InputError
        If other dances are there already, or the folder cannot be written.
    """
    write_dances({name: dance for name, dance in dances.items() if isinstance(dance, Dance)}, folder.dances)


def already_recorded(journal: Path) -> InputError:
    """Give the error for a visit that is over."""
    return InputError(
        "this visit has been recorded to its end",
        where=journal,
        remedy="choose another participant",
    )


class _Run:
    """One run through the steps of a visit: waits, asks, and writes down what happens."""

    def __init__(self, setting: Setting, journal: Journal) -> None:
        self.state = replay(journal.records)
        self._setting, self._journal = setting, journal
        self._frames: FrameWriter | None = None
        self._fault = ""

    def begin(self, introduction: Mapping[str, Any]) -> None:
        """Write down the start, or that the visit goes on after an interruption."""
        if not self.state.started:
            self._note("session_started", introduction)
            return
        if self.state.open_step is not None:
            reason = "the recording ended without notice"
            self._note("step_interrupted", {"step": self.state.open_step, "reason": reason})
        self._note("session_resumed", {"versions": introduction["versions"]})

    async def take(self, steps: Sequence_[Step]) -> None:
        """Take the remaining steps, with the belt on.

        Whatever ends the visit early is written down as an interruption of its step and raised again.
        """
        belt = self._setting.heart_rate
        await belt.open()
        try:
            async with asyncio.TaskGroup() as tasks:
                background = [tasks.create_task(self._watched(self._listen, belt.name))]
                if not self._setting.is_simulated:
                    background.append(tasks.create_task(self._keep_safe()))
                for step in steps:
                    await self._step(step, tasks)
                for task in background:
                    task.cancel()
        except BaseExceptionGroup as group:
            raise _first(group) from None
        finally:
            await belt.close()
        self._note("session_completed", {})

    def _note(self, kind: str, data: Mapping[str, Any]) -> None:
        """Write down an event and follow it."""
        record = self._journal.append(kind, data, time_s=self._setting.clock.now_s())
        self.state = transition(self.state, record)

    async def _step(self, step: Step, tasks: asyncio.TaskGroup) -> None:
        number, planned = self.state.steps_begun + 1, step.planned
        where = {"phase": planned.phase, "condition": planned.condition, "period": planned.period}
        self._note("step_started", {"step": number, **where})
        try:
            async with self._filming(step, number, tasks):
                await self._do(step, number)
        except BaseException as reason:
            why = self._fault or str(reason) or type(reason).__name__
            self._note("step_interrupted", {"step": number, "reason": why})
            raise
        self._note("step_completed", {"step": number})

    async def _do(self, step: Step, number: int) -> None:
        clock, planned = self._setting.clock, step.planned
        start_s, reply = clock.now_s(), None
        if (participant := self._setting.participant) is not None:
            reply = step.simulate(participant, start_s=start_s, rng=participant.random("step", number))
        if planned.duration_s is not None:
            await clock.pass_until(start_s + planned.duration_s)
        if step.questionnaire is not None:
            answers = await self._answers(step.questionnaire, planned.condition, reply)
            check(step.questionnaire, answers)
            what = {"questionnaire": step.questionnaire, "condition": planned.condition}
            self._note("answers", {"step": number, **what, "answers": dict(answers)})

    async def _answers(
        self, questionnaire: str, condition: str | None, reply: Reply | None
    ) -> Mapping[str, Answer]:
        if self._setting.questions is not None:
            return await self._setting.questions.ask(questionnaire, condition)
        if reply is None:
            raise ValueError(f"nobody answers {questionnaire}")
        await self._setting.clock.pass_until(self._setting.clock.now_s() + reply.seconds)
        return reply.answers

    @asynccontextmanager
    async def _filming(self, step: Step, number: int, tasks: asyncio.TaskGroup) -> AsyncIterator[None]:
        """Record the skeleton during a step that is filmed."""
        if not step.is_filmed:
            yield
            return
        camera, name = self._setting.camera, f"{number:02d}_{step.planned.phase}.frames"
        writer = self._frames = FrameWriter(self._journal.path.with_suffix("") / name, JOINT_NAMES)
        self._note("frames_started", {"step": number, "file": name})
        await camera.open()
        task = tasks.create_task(self._watched(lambda: self._film(writer), camera.name))
        try:
            yield
        finally:
            task.cancel()
            self._frames = None
            await camera.close()
            writer.close()
            facts = {"frames": writer.count, "sha256": writer.sha256}
            self._note("frames_stopped", {"step": number, "file": name, **facts})

    async def _film(self, writer: FrameWriter) -> None:
        while True:
            frame = await self._setting.camera.read()
            writer.append(frame.time_s, frame.positions, frame.confidence)

    async def _listen(self) -> None:
        while True:
            sample = await self._setting.heart_rate.read()
            reading = {
                "heart_rate_bpm": sample.heart_rate_bpm,
                "rr_intervals_s": sample.rr_intervals_s,
                "contact": sample.contact,
            }
            self._journal.append("heart_rate", reading, time_s=sample.time_s, durable=False)

    async def _keep_safe(self) -> None:
        """Make samples durable once a second."""
        while True:
            await self._setting.clock.sleep_until(self._setting.clock.now_s() + _SYNC_EVERY_S)
            self._journal.sync()
            if self._frames is not None:
                self._frames.sync()

    async def _watched(self, work: Callable[[], Awaitable[None]], device: str) -> None:
        """Remember which device ended the visit, if one does."""
        try:
            await work()
        except Exception as error:
            self._fault = f"{device}: {error}"
            raise


def _first(group: BaseExceptionGroup[BaseException]) -> BaseException:
    """Give the first error of a group of groups."""
    error = group.exceptions[0]
    return _first(error) if isinstance(error, BaseExceptionGroup) else error
