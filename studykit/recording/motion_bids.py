"""Motion-BIDS files, always derived from the journals, so that they can always be written again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from studykit.core.arrays import Floats
from studykit.core.provenance import sha256_of_bytes, sha256_of_file
from studykit.motion.motion import JointTracks
from studykit.protocol.questionnaire import PACES
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording import bids_file, bids_lookup
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
    scans = []
    for path, content in _movements(folder, protocol, record):
        bids_file.write(path, content)
        if path.name.endswith("_motion.tsv"):
            scans.append((path.name, sha256_of_bytes(content)))
    for path, content in _descriptions(folder, protocol, record):
        bids_file.write(path, content)
    bids_file.write(_scans(folder, record), table(metadata.SCAN_COLUMNS, _scan_rows(record, dict(scans))))


def changed_files(folder: StudyFolder, protocol: StudyProtocol, record: SessionRecord) -> tuple[Path, ...]:
    """Name the files of a session that are there and no longer what was written.

    Movement is held against the digests in the table of scans; events and heart rate of a journal are
    written once more, in memory. The words of descriptions may change from release to release.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    protocol : StudyProtocol
        What was planned.
    record : SessionRecord
        The session.
    """
    scans = _scans(folder, record)
    rows = bids_lookup.rows(scans) if scans.exists() else []
    told = {scans.parent / (row.get("filename") or ""): row.get("sha256") for row in rows}
    changed = [
        path for path, sha256 in told.items() if sha256 and path.exists() and sha256_of_file(path) != sha256
    ]
    if record.journal.is_file():
        changed += [
            path
            for path, content in _descriptions(folder, protocol, record)
            if path.suffix != ".json" and path.exists() and path.read_bytes() != content
        ]
    return tuple(sorted(changed))


def _descriptions(
    folder: StudyFolder, protocol: StudyProtocol, record: SessionRecord
) -> Iterator[tuple[Path, bytes]]:
    """Give the files of a session that follow from its journal alone."""
    stem = f"sub-{record.participant}_ses-{record.session}"
    motion = folder.motion(record.participant, record.session)
    yield from _heart_rate(motion / f"{stem}_task-session_recording-heartrate_physio", protocol, record)
    course = [_event(step, zero_s=0.0) for step in record.steps]
    yield from _events(motion / f"{stem}_task-session_events.tsv", course)
    yield motion.parent / f"{stem}_scans.json", description(metadata.SCANS)


def _movements(
    folder: StudyFolder, protocol: StudyProtocol, record: SessionRecord
) -> Iterator[tuple[Path, bytes]]:
    """Give the files of what the camera saw."""
    motion = folder.motion(record.participant, record.session)
    for step, task, name in _filmed(record):
        tracks = record.frames(step.step)
        if not len(tracks):  # interrupted before the first frame arrived
            continue
        stem = motion / name
        yield from _motion(stem, protocol, record, task=task, tracks=tracks)
        event = _event(step, zero_s=float(tracks.times_s[0]))
        yield from _events(stem.with_name(f"{name}_events.tsv"), [event])


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
    bids_file.write(root / "participants.json", description(metadata.participants(records)))
    for name in _phenotypes(protocol):
        bids_file.write(folder.phenotype / f"{name}.json", description(metadata.phenotype(name, protocol)))
    for path, content in _tables(folder, protocol, records):
        bids_file.write(path, content)


def changed_tables(
    folder: StudyFolder, protocol: StudyProtocol, records: Sequence[SessionRecord]
) -> tuple[Path, ...]:
    """Name the tables of people and answers that are there and no longer what the journals say.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    protocol : StudyProtocol
        What was planned.
    records : sequence of SessionRecord
        All sessions, each read from its journal.
    """
    tables = _tables(folder, protocol, records)
    return tuple(path for path, content in tables if path.exists() and path.read_bytes() != content)


def _tables(
    folder: StudyFolder, protocol: StudyProtocol, records: Sequence[SessionRecord]
) -> Iterator[tuple[Path, bytes]]:
    """Give the tables of people and of what they answered."""
    demographics = tuple(metadata.DEMOGRAPHICS)
    people: dict[str, list[object]] = {}
    for record in records:  # a later visit tells the same about the person
        people[record.participant] = [
            *_answers(record, "demographics", demographics),
            record.sequence,
            record.simulated,
        ]
    rows = [[f"sub-{participant}", *values] for participant, values in people.items()]
    heads = ["participant_id", *demographics, "sequence", "simulated"]
    yield folder.path / "participants.tsv", table(heads, rows)
    conditions = protocol.order.labels
    for name, items in _phenotypes(protocol).items():
        answered = []
        for record in records:
            values = _answers(record, name, items)
            if name == "smoothness":
                given = [record.answers_to(name, condition=condition) or {} for condition in conditions]
                values = [answer.get("rating") for answer in given]
            answered.append([f"sub-{record.participant}", f"ses-{record.session}", *values])
        yield folder.phenotype / f"{name}.tsv", table(["participant_id", "session_id", *items], answered)


def _phenotypes(protocol: StudyProtocol) -> dict[str, tuple[str, ...]]:
    """Give each questionnaire with its columns."""
    return {
        "paces": tuple(item.name for item in PACES),
        "demographics": tuple(metadata.DEMOGRAPHICS),
        "smoothness": tuple(metadata.smoothness_column(condition) for condition in protocol.order.labels),
    }


def _answers(record: SessionRecord, questionnaire: str, items: Sequence[str]) -> list[object]:
    given = record.answers_to(questionnaire) or {}
    return [given.get(item) for item in items]


def _filmed(record: SessionRecord) -> Iterator[tuple[StepRecord, str, str]]:
    """Give each filmed step with its task and the stem of its files; each repetition is a run."""
    stem = f"sub-{record.participant}_ses-{record.session}"
    runs: Counter[tuple[str, str | None]] = Counter()
    for step in record.steps:
        if step.step not in record.frame_files:
            continue
        runs[step.phase, step.condition] += 1
        run = f"run-{runs[step.phase, step.condition]}"
        label = f"acq-{step.condition.replace('-', '')}_{run}" if step.condition else run
        task = _TASKS[step.phase]
        yield step, task, f"{stem}_task-{task}_tracksys-{metadata.TRACKING_SYSTEM}_{label}"


def _motion(
    stem: Path, protocol: StudyProtocol, record: SessionRecord, *, task: str, tracks: JointTracks
) -> Iterator[tuple[Path, bytes]]:
    latency_s = (tracks.times_s - tracks.times_s[0])[:, None]
    path = stem.with_name(f"{stem.name}_motion.tsv")
    yield path, samples(np.hstack([latency_s, tracks.positions.reshape(len(tracks), -1)]))
    about = metadata.motion(protocol, record, task=task, times_s=tracks.times_s)
    yield path.with_suffix(".json"), description(about)
    channels = stem.with_name(f"{stem.name}_channels.tsv")
    yield channels, table(metadata.CHANNEL_COLUMNS, metadata.channels(record.joint_names))
    yield channels.with_suffix(".json"), description(metadata.CHANNELS)


def _events(path: Path, events: Sequence[tuple[object, ...]]) -> Iterator[tuple[Path, bytes]]:
    yield path, table(metadata.EVENT_COLUMNS, events)
    yield path.with_suffix(".json"), description(metadata.EVENTS)


def _event(step: StepRecord, *, zero_s: float) -> tuple[object, ...]:
    duration_s = step.stop_s - step.start_s
    where = (step.condition, step.period, step.step, step.is_complete)
    return (step.start_s - zero_s, duration_s, step.phase, *where)


def _scans(folder: StudyFolder, record: SessionRecord) -> Path:
    stem = f"sub-{record.participant}_ses-{record.session}"
    return folder.motion(record.participant, record.session).parent / f"{stem}_scans.tsv"


def _scan_rows(record: SessionRecord, sha256: Mapping[str, str]) -> Iterator[tuple[object, ...]]:
    """Give a row a recording that was written, with its digest."""
    anchor = datetime.fromisoformat(record.utc_anchor)
    for step, _, name in _filmed(record):
        path = f"{name}_motion.tsv"
        if path not in sha256:
            continue
        start_s = float(record.frames(step.step).times_s[0])
        moment = (anchor + timedelta(seconds=start_s)).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
        reason = None if step.is_complete else "interrupted"
        where = (step.condition, step.period, step.is_complete, reason)
        yield (f"motion/{path}", moment, *where, sha256[path])


def _heart_rate(stem: Path, protocol: StudyProtocol, record: SessionRecord) -> Iterator[tuple[Path, bytes]]:
    longest_gap_s = protocol.heart_rate.longest_gap_s
    stop_s = max((step.stop_s for step in record.steps), default=0.0)
    grid = heart_rate_grid(
        record.heart_rate_times_s, record.heart_rate_bpm, stop_s=stop_s, longest_gap_s=longest_gap_s
    )
    yield stem.with_suffix(".tsv.gz"), compressed(samples(grid[:, None], decimals=0))
    about = metadata.heart_rate(record, longest_gap_s=longest_gap_s)
    yield stem.with_suffix(".json"), description(about)


def heart_rate_grid(times_s: Floats, bpm: Floats, *, stop_s: float, longest_gap_s: float) -> Floats:
    """Put readings on a regular grid: at every step, the latest one.

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
    ndarray, shape (step,), beats/min
        NaN where there was no reading.
    """
    grid_s = np.arange(int(stop_s * metadata.HEART_RATE_HZ) + 1) / metadata.HEART_RATE_HZ
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
