"""Motion-BIDS files, always derived from the journals, so that they can always be written again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.motion.motion import JointTracks
from studykit.protocol.questionnaire import PACES
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording import bids_file
from studykit.recording import bids_metadata as metadata
from studykit.recording.bids_file import compressed, description, samples, table
from studykit.recording.session_data import SessionRecord, StepRecord
from studykit.recording.session_record import read_session
from studykit.recording.study_folder import StudyFolder

_TASKS = {"perform": "dance", "calibrate": "calibration"}


def write(folder: StudyFolder, protocol: StudyProtocol) -> None:
    """Write the Motion-BIDS files of a whole study from its journals.

    Doing it again writes the same bytes.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    protocol : StudyProtocol
        What was planned.

    Raises
    ------
    InputError
        If a journal is damaged or the folder cannot be written.
    """
    records = [read_session(path) for path in folder.recorded()]
    for record in records:
        write_session(folder, protocol, record)
    write_study(folder, protocol, records)


def write_session(folder: StudyFolder, protocol: StudyProtocol, record: SessionRecord) -> None:
    """Write the files of one session: the whole session's course and heart rate, and every recording."""
    stem = f"sub-{record.participant}_ses-{record.session}"
    motion = folder.motion(record.participant, record.session)
    _write_heart_rate(motion / f"{stem}_task-session_recording-heartrate_physio", protocol, record)
    course = [_event(step, zero_s=0.0) for step in record.steps]
    _write_events(motion / f"{stem}_task-session_events.tsv", course)
    scans = []
    for step, task, label in _filmed(record):
        tracks = record.frames(step.step)
        if not len(tracks):  # interrupted before the first frame arrived
            continue
        recording = f"{stem}_task-{task}_tracksys-{metadata.TRACKING_SYSTEM}_{label}"
        _write_motion(motion / f"{recording}_motion.tsv", protocol, record, task=task, tracks=tracks)
        start_s = float(tracks.times_s[0])
        _write_events(motion / f"{recording}_events.tsv", [_event(step, zero_s=start_s)])
        scans.append(_scan(record, step, f"motion/{recording}_motion.tsv", start_s))
    bids_file.write(motion.parent / f"{stem}_scans.json", description(metadata.SCANS))
    bids_file.write(_scans(folder, record), table(metadata.SCAN_COLUMNS, scans))


def is_written(folder: StudyFolder, record: SessionRecord) -> bool:
    """Tell whether the files of a session have all been written, by the last of them."""
    return _scans(folder, record).exists()


def write_study(folder: StudyFolder, protocol: StudyProtocol, records: Sequence[SessionRecord]) -> None:
    """Write the files about the study as a whole: description, participants and questionnaires."""
    root = folder.path
    bids_file.write(
        root / "dataset_description.json", description(metadata.dataset_description(protocol, records))
    )
    bids_file.write(root / "README", metadata.readme(protocol, records).encode())
    bids_file.write(root / "CHANGES", metadata.changes(records).encode())
    demographics = tuple(metadata.DEMOGRAPHICS)
    people: dict[str, list[object]] = {}
    for record in records:  # a later visit tells the same about the person
        people[record.participant] = [
            *_answers(record, "demographics", demographics),
            record.sequence,
            record.simulated,
        ]
    rows = [[f"sub-{participant}", *values] for participant, values in people.items()]
    bids_file.write(
        root / "participants.tsv",
        table(["participant_id", *demographics, "sequence", "simulated"], rows),
    )
    bids_file.write(root / "participants.json", description(metadata.participants(records)))
    _write_phenotype(folder, protocol, records)


def _write_phenotype(folder: StudyFolder, protocol: StudyProtocol, records: Sequence[SessionRecord]) -> None:
    who = ("participant_id", "session_id")
    conditions = protocol.order.labels
    columns = {
        "paces": tuple(item.name for item in PACES),
        "demographics": tuple(metadata.DEMOGRAPHICS),
        "smoothness": tuple(metadata.smoothness_column(condition) for condition in conditions),
    }
    for name, items in columns.items():
        rows = []
        for record in records:
            if name == "smoothness":
                values = [
                    (record.answers_to(name, condition=condition) or {}).get("rating")
                    for condition in conditions
                ]
            else:
                values = _answers(record, name, items)
            rows.append([f"sub-{record.participant}", f"ses-{record.session}", *values])
        bids_file.write(folder.phenotype / f"{name}.tsv", table([*who, *items], rows))
        bids_file.write(folder.phenotype / f"{name}.json", description(metadata.phenotype(name, protocol)))


def _answers(record: SessionRecord, questionnaire: str, items: Sequence[str]) -> list[object]:
    given = record.answers_to(questionnaire) or {}
    return [given.get(item) for item in items]


def _filmed(record: SessionRecord) -> Iterator[tuple[StepRecord, str, str]]:
    """Give each filmed step with its task and the rest of its file name; each repetition is a run."""
    runs: Counter[tuple[str, str | None]] = Counter()
    for step in record.steps:
        if step.step not in record.frame_files:
            continue
        runs[step.phase, step.condition] += 1
        run = f"run-{runs[step.phase, step.condition]}"
        label = f"acq-{step.condition.replace('-', '')}_{run}" if step.condition else run
        yield step, _TASKS[step.phase], label


def _write_motion(
    path: Path, protocol: StudyProtocol, record: SessionRecord, *, task: str, tracks: JointTracks
) -> None:
    latency_s = (tracks.times_s - tracks.times_s[0])[:, None]
    bids_file.write(path, samples(np.hstack([latency_s, tracks.positions.reshape(len(tracks), -1)])))
    about = metadata.motion(protocol, record, task=task, times_s=tracks.times_s)
    bids_file.write(path.with_suffix(".json"), description(about))
    channels = path.with_name(path.name.replace("_motion.tsv", "_channels.tsv"))
    bids_file.write(channels, table(metadata.CHANNEL_COLUMNS, metadata.channels(record.joint_names)))
    bids_file.write(channels.with_suffix(".json"), description(metadata.CHANNELS))


def _write_events(path: Path, events: Sequence[tuple[object, ...]]) -> None:
    bids_file.write(path, table(metadata.EVENT_COLUMNS, events))
    bids_file.write(path.with_suffix(".json"), description(metadata.EVENTS))


def _event(step: StepRecord, *, zero_s: float) -> tuple[object, ...]:
    duration_s = step.stop_s - step.start_s
    where = (step.condition, step.period, step.step, step.is_complete)
    return (step.start_s - zero_s, duration_s, step.phase, *where)


def _scans(folder: StudyFolder, record: SessionRecord) -> Path:
    stem = f"sub-{record.participant}_ses-{record.session}"
    return folder.motion(record.participant, record.session).parent / f"{stem}_scans.tsv"


def _scan(record: SessionRecord, step: StepRecord, filename: str, start_s: float) -> tuple[object, ...]:
    anchor = datetime.fromisoformat(record.utc_anchor)
    moment = (anchor + timedelta(seconds=start_s)).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
    reason = None if step.is_complete else "interrupted"
    return filename, moment, step.condition, step.period, step.is_complete, reason


def _write_heart_rate(stem: Path, protocol: StudyProtocol, record: SessionRecord) -> None:
    longest_gap_s = protocol.heart_rate.longest_gap_s
    stop_s = max((step.stop_s for step in record.steps), default=0.0)
    grid = heart_rate_grid(
        record.heart_rate_times_s, record.heart_rate_bpm, stop_s=stop_s, longest_gap_s=longest_gap_s
    )
    bids_file.write(stem.with_suffix(".tsv.gz"), compressed(samples(grid[:, None], decimals=0)))
    about = metadata.heart_rate(record, longest_gap_s=longest_gap_s)
    bids_file.write(stem.with_suffix(".json"), description(about))


def heart_rate_grid(times_s: Floats, bpm: Floats, *, stop_s: float, longest_gap_s: float) -> Floats:
    """Put readings on a regular grid: at every second, the latest one.

    Parameters
    ----------
    times_s : ndarray, shape (reading,), s
        When readings came, in order.
    bpm : ndarray, shape (reading,), beats/min
        The readings; 0 is none.
    stop_s : float
        Where the grid ends, s; it begins at 0.
    longest_gap_s : float
        A reading older than this is none any more, s.

    Returns
    -------
    ndarray, shape (second,), beats/min
        NaN where there was no reading.
    """
    grid_s = np.arange(int(stop_s) + 1) / metadata.HEART_RATE_HZ
    latest = np.searchsorted(times_s, grid_s, side="right") - 1
    values = np.full(len(grid_s), np.nan)
    has_one = latest >= 0
    values[has_one] = bpm[latest[has_one]]
    values[has_one] = np.where(
        (grid_s[has_one] - times_s[latest[has_one]] <= longest_gap_s) & (values[has_one] > 0.0),
        values[has_one],
        np.nan,
    )
    return values
