"""A study on disk: its protocol, its participants and their visits."""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.io.protocol_file import read_protocol, write_protocol
from studykit.motion.motion import Motion
from studykit.participant.effects import PAPER, Effects
from studykit.participant.person import cohort
from studykit.protocol.latin_square import assignment
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording import motion_bids
from studykit.recording.journal import unwritable
from studykit.recording.session_record import SessionRecord, read_session
from studykit.recording.study_folder import StudyFolder
from studykit.session.planted import plant
from studykit.session.runner import Session, already_recorded, check_dances, keep
from studykit.session.step import ShownDance


def open_study(path: Path | str, *, protocol: StudyProtocol | Path | str | None = None) -> Study:
    """Open the folder of a study; with a protocol, create it if it is not there yet.

    Parameters
    ----------
    path : Path or str
        The folder.
    protocol : StudyProtocol, Path or str, optional
        The protocol or its file, which is copied into the folder byte for byte. If the folder holds one
        already, it must be the same.

    Raises
    ------
    InputError
        If there is no study, another one, or the folder cannot be written; nothing is touched then.
    """
    folder = StudyFolder(Path(path))
    source: Path | str | None = None
    given: StudyProtocol | None = None
    if isinstance(protocol, StudyProtocol):
        given = protocol
    elif protocol is not None:
        source, given = protocol, read_protocol(protocol)
    if folder.protocol.exists():
        frozen = read_protocol(folder.protocol)
        if given is not None and given.sha256 != frozen.sha256:
            raise InputError(
                "the study was begun with another protocol",
                where=folder.protocol,
                remedy="use another folder for the changed protocol",
            )
        return Study(folder=folder, protocol=frozen)
    if given is None:
        raise InputError(
            "there is no study here",
            where=folder.path,
            remedy="name the folder of a study, or give a protocol to begin one",
        )
    try:
        folder.protocol.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder.path, error) from error
    write_protocol(given, folder.protocol, source=source)
    return Study(folder=folder, protocol=given)


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study on disk; `open_study` gives one.

    Parameters
    ----------
    folder : StudyFolder
        Where it lies.
    protocol : StudyProtocol
        What is followed.
    """

    folder: StudyFolder
    protocol: StudyProtocol

    @property
    def path(self) -> Path:
        """The folder."""
        return self.folder.path

    @property
    def participants(self) -> tuple[str, ...]:
        """The numbers of all participants, whether they have come yet or not."""
        return tuple(sequence.participant for sequence in assignment(self.protocol))

    def sessions(self) -> tuple[SessionRecord, ...]:
        """Give the visits recorded so far."""
        return tuple(read_session(path) for path in self.folder.recorded())

    def session(
        self, participant: str, *, session: str = "01", effects: Effects = PAPER, seed: int = 1
    ) -> Session:
        """Prepare the visit of a participant: a new one, or one that was interrupted.

        Parameters
        ----------
        participant : str
            Number of the participant, such as "07".
        session : str, optional
            Number of the visit.
        effects : Effects, optional
            What is planted, if the person is simulated.
        seed : int, optional
            Repeats a simulated visit.

        Raises
        ------
        InputError
            If there is no such participant, or the visit is over.
        """
        sequences = {sequence.participant: sequence for sequence in assignment(self.protocol)}
        if participant not in sequences:
            known = list(sequences)
            raise InputError(
                f'there is no participant "{participant}"',
                where=self.folder.protocol,
                remedy=f"choose one from {known[0]} to {known[-1]}",
            )
        if not (session.isascii() and session.isalnum()):
            raise InputError(f'"{session}" is no number of a visit', remedy='write digits, such as "01"')
        prepared = Session(
            folder=self.folder,
            protocol=self.protocol,
            sequence=sequences[participant],
            name=session,
            people=cohort(len(sequences), seed),
            effects=effects,
            seed=seed,
        )
        if prepared.state.is_completed:
            raise already_recorded(prepared.path)
        return prepared

    def simulate(
        self,
        dances: Mapping[str, ShownDance],
        *,
        effects: Effects = PAPER,
        seed: int = 1,
        progress: Progress = silent,
        workers: int = 1,
    ) -> None:
        """Let simulated people take part until everybody has; visits that are over stay as they are.

        Parameters
        ----------
        dances : mapping of str to dance
            The dance of each condition.
        effects : Effects, optional
            What is planted.
        seed : int, optional
            The same seed writes the same bytes.
        progress : Progress, optional
            Is told of every visit.
        workers : int, optional
            How many visits are simulated at once; the result is the same.
        """
        check_dances(dances, self.protocol)
        keep(dances, self.folder)
        shown = {condition: _Shown.of(dances[condition]) for condition in self.protocol.conditions_list()}
        plant(self.folder.planted, effects=effects, seed=seed, people=cohort(len(self.participants), seed))
        over = {r.participant: r for r in self.sessions() if r.completed and r.session == "01"}
        for record in over.values():
            if not motion_bids.is_written(self.folder, record):  # the power went between visit and export
                motion_bids.write_session(self.folder, self.protocol, record)
        visits = [
            _Visit(session=self.session(participant, effects=effects, seed=seed), dances=shown)
            for participant in self.participants
            if participant not in over
        ]
        for _ in progress(_carried_out(visits, workers), label="Simulating visits", total=len(visits)):
            pass
        motion_bids.write_study(self.folder, self.protocol, self.sessions())

    def write_bids(self) -> None:
        """Write the Motion-BIDS files of all visits from their journals, again or for the first time."""
        motion_bids.write(self.folder, self.protocol)


@dataclass(frozen=True, kw_only=True)
class _Shown:
    """The little of a dance that a visit needs, cheap to send to another process."""

    condition: str
    motion: Motion
    sha256: str

    @classmethod
    def of(cls, dance: ShownDance) -> _Shown:
        return cls(condition=dance.condition, motion=dance.motion, sha256=dance.sha256)


@dataclass(frozen=True, kw_only=True)
class _Visit:
    """A simulated visit to be carried out."""

    session: Session
    dances: Mapping[str, _Shown]


def _carried_out(visits: list[_Visit], workers: int) -> Iterator[None]:
    if workers > 1 and len(visits) > 1:
        context = multiprocessing.get_context("spawn")  # the same on every system
        with ProcessPoolExecutor(workers, mp_context=context) as pool:
            yield from pool.map(_carry_out, visits)
    else:
        with ThreadPoolExecutor(1) as pool:  # a loop of its own, also where a notebook's already runs
            yield from pool.map(_carry_out, visits)


def _carry_out(visit: _Visit) -> None:
    parent = multiprocessing.parent_process()
    if parent is not None and not parent.is_alive():
        return  # whoever asked for the visits was killed; the next run takes them up
    session = visit.session
    record = asyncio.run(session.run(visit.dances))
    motion_bids.write_session(session.folder, session.protocol, record)
