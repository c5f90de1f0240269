"""Reading a session from Motion-BIDS files alone, as a study that was recorded elsewhere has them.

Needed are ``code/protocol.toml``; events with ``trial_type`` (the phase, "perform" for dancing along) and
``condition``; positions of joints under known names; and when recordings began. Heart rate, questionnaires
and verdicts are read where they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from studykit.core.arrays import frozen
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_files, sha256_of_value
from studykit.io.protocol_file import read_protocol
from studykit.motion.skeleton import JOINT_NAMES
from studykit.protocol.latin_square import williams
from studykit.recording import bids_lookup
from studykit.recording.bids_answers import Visitor, visitor
from studykit.recording.bids_course import PERFORM, Course, Film, course
from studykit.recording.bids_heart_rate import heart_rate
from studykit.recording.motion_file import MotionFile
from studykit.recording.session_data import SessionRecord, StepRecord
from studykit.recording.study_folder import ONLY_SESSION, StudyFolder


def read_motion_bids(folder: Path) -> SessionRecord:
    """Read a session from the folder of its Motion-BIDS files.

    Parameters
    ----------
    folder : Path
        Such as ``sub-07/ses-01/motion``.

    Raises
    ------
    InputError
        Naming the file and the field that is missing or wrong.
    """
    visit = folder.parent
    root = visit.parent if visit.name.startswith("sub-") else visit.parent.parent
    about = bids_lookup.entities(min(folder.glob("*_events.tsv")))
    participant, session = about["sub"], about.get("ses", ONLY_SESSION)
    study = StudyFolder(root)
    protocol = read_protocol(study.protocol)
    labels = protocol.order.labels
    went = course(folder, root, labels)
    pulse = heart_rate(folder, root, went.zero_s)
    who = visitor(study, participant, session, labels)
    sequence, conditions = _order(went.steps, who, labels, study.path / "participants.tsv")
    danced = {step.condition for step in went.steps if step.phase == PERFORM and step.is_complete}
    return SessionRecord(
        journal=folder,
        participant=participant,
        session=session,
        sequence=sequence,
        conditions=conditions,
        simulated=who.simulated,
        protocol_sha256=protocol.sha256,
        dance_sha256={},  # nobody wrote down which were shown
        devices={"camera": _camera(went.films, root), "heart_rate": pulse.device},
        joint_names=JOINT_NAMES,
        utc_anchor=min((row.get("acq_time") or "" for row in went.scans.values()), default=""),
        steps=went.steps,
        heart_rate_times_s=frozen(pulse.times_s, shape=(None,), name="heart_rate_times_s"),
        heart_rate_bpm=frozen(pulse.bpm, shape=(None,), name="heart_rate_bpm"),
        answers=who.answers,
        completed=danced >= set(conditions),
        sha256=_digest(visit, who),
        frame_files=_files(went, root),
    )


def _order(
    steps: Sequence[StepRecord], who: Visitor, labels: Sequence[str], participants: Path
) -> tuple[int, tuple[str, ...]]:
    """Find the row of the square that somebody danced, and the conditions that were due."""
    at = {step.period: step.condition for step in steps if step.phase == PERFORM}
    periods = sorted(period for period in at if period is not None)
    danced = tuple(str(at[period]) for period in periods)
    rows = [tuple(labels[place] for place in row) for row in williams(len(labels)).tolist()]
    for number, row in enumerate(rows, start=1):
        fits = row[: len(danced)] == danced and periods == list(range(1, len(danced) + 1))
        if fits and who.sequence in (None, number):
            return number, row
    if who.sequence is None:
        raise InputError(
            f"nobody tells which order this is: {', '.join(danced)}",
            where=participants,
            remedy="give each order a number in the column sequence",
        )
    return who.sequence, danced


def _files(went: Course, root: Path) -> Mapping[int, MotionFile]:
    return {
        step.step: MotionFile(
            path=film.path,
            sha256=went.scans.get(film.path.name, {}).get("sha256"),
            channels=film.channels,
            rate_hz=_rate_hz(film, root),
            zero_s=film.zero_s,
            within_s=(step.start_s, step.stop_s) if len(film.steps) > 1 else None,
        )
        for film in went.films
        for step in film.steps
    }


def _rate_hz(film: Film, root: Path) -> float:
    told = bids_lookup.description(film.path, root, "motion.json")
    rate_hz = told.get("SamplingFrequencyEffective") or told.get("SamplingFrequency")
    if not isinstance(rate_hz, int | float) or not rate_hz > 0.0:
        raise InputError(
            "its SamplingFrequency is not told",
            where=film.path,
            remedy="write it in its JSON, in samples a second",
        )
    return float(rate_hz)


def _camera(films: Sequence[Film], root: Path) -> str:
    told = bids_lookup.description(films[0].path, root, "motion.json") if films else {}
    return str(told.get("ManufacturersModelName") or told.get("TrackingSystemName") or "not told")


def _digest(visit: Path, who: Visitor) -> str:
    """Give one digest of everything that was read."""
    answers = [[given.questionnaire, given.condition, dict(given.answers)] for given in who.answers]
    files = sorted(path for path in visit.rglob("*") if path.is_file())
    return sha256_of_value([sha256_of_files(files), answers])
