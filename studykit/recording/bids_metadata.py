"""What the files of the BIDS data set say about themselves."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from studykit.core.arrays import Floats
from studykit.protocol.questionnaire import HIGHEST, LOWEST, PACES, PACES_NAME, SMOOTHNESS_ANCHORS
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.session_data import SessionRecord

BIDS_VERSION = "1.10.0"
TRACKING_SYSTEM = "camera"
REAL_SOME = "Some sessions are SIMULATED: see the column simulated in participants.tsv."
SIMULATED_ALL = "SIMULATED DATA: no person took part; all recordings come from simulated participants."

_PHASES = {
    "calibrate": "standing still while the camera learns the body",
    "baseline": "sitting, resting heart rate",
    "train": "getting to know the system",
    "watch": "watching the dance of a condition",
    "perform": "dancing along with the guide: one trial",
    "smoothness": "rating the smoothness of the dance",
    "rest": "rest between conditions",
    "paces": "filling in the enjoyment scale",
    "demographics": "telling about oneself",
}


_README = """{title}

{note}Study {name}: {sessions} recorded sessions; {participants} participants are planned.
They dance in the orders of a Williams square: {conditions}.

What was recorded lies in sourcedata/journal, append-only: one journal a session with a chain of checksums,
and the frames of the camera. Everything else outside code and sourcedata is derived from it by studykit and
can be written again at any time. The protocol that was followed is code/protocol.toml.

Motion files hold the positions of the joints in metres (X to the left, Y up, Z to the front of a person who
faces the camera); n/a where a joint was not seen. The first column is the time since the first sample. Times
of the files named task-session, the heart rate among them, count from the start of the session. Trials that
were interrupted are kept and marked in the scans and events.
"""


def simulated_note(records: Sequence[SessionRecord]) -> str:
    """Say which sessions are simulated; empty if none is."""
    if not any(record.simulated for record in records):
        return ""
    return SIMULATED_ALL if all(record.simulated for record in records) else REAL_SOME


def dataset_description(protocol: StudyProtocol, records: Sequence[SessionRecord]) -> dict[str, Any]:
    """Describe the data set."""
    note = simulated_note(records)
    title = protocol.study.title
    generated_by = {
        "Name": "studykit",
        "Version": version("studykit"),
        "Description": f"Recorded and converted by studykit from sourcedata/journal. {note}".strip(),
    }
    return {
        "Name": f"{title} (SIMULATED DATA)" if note == SIMULATED_ALL else title,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [generated_by],
        "SourceDatasets": [{"URL": "bids::sourcedata/journal"}],
        "Simulated": any(record.simulated for record in records),
    }


def readme(protocol: StudyProtocol, records: Sequence[SessionRecord]) -> str:
    """Introduce the data set to a reader."""
    note = simulated_note(records)
    return _README.format(
        title=protocol.study.title,
        note=f"{note}\n\n" if note else "",
        name=protocol.study.name,
        sessions=len(records),
        participants=protocol.study.participants,
        conditions=", ".join(protocol.order.labels),
    )


def changes(records: Sequence[SessionRecord]) -> str:
    """Give the history of the data set."""
    first = min((record.utc_anchor[:10] for record in records), default="2000-01-01")
    return f"1.0.0 {first}\n  - First sessions recorded with studykit.\n"


def motion(protocol: StudyProtocol, record: SessionRecord, *, task: str, times_s: Floats) -> dict[str, Any]:
    """Describe one file of motion.

    Parameters
    ----------
    task : str
        What the person did.
    times_s : ndarray, shape (frame,), s
        When the frames were taken.
    """
    spacing = times_s[1:] - times_s[:-1]
    span_s = float(times_s[-1] - times_s[0]) if len(times_s) > 1 else 0.0
    nominal_hz = round(1.0 / float(sorted(spacing)[len(spacing) // 2])) if len(spacing) else 0
    joints = len(record.joint_names)
    return {
        "TaskName": task,
        "TaskDescription": f"{protocol.study.title}: {_TASKS[task]}",
        "Instructions": _INSTRUCTIONS[task],
        "SamplingFrequency": nominal_hz,
        "SamplingFrequencyEffective": round((len(times_s) - 1) / span_s, 6) if span_s else nominal_hz,
        "RecordingDuration": round(span_s, 4),
        "TrackingSystemName": TRACKING_SYSTEM,
        "ManufacturersModelName": record.devices["camera"],
        "SoftwareVersions": f"studykit {version('studykit')}",
        "TrackedPointsCount": joints,
        "MotionChannelCount": 3 * joints + 1,
        "POSChannelCount": 3 * joints,
        "LATENCYChannelCount": 1,
        **dict.fromkeys(_ABSENT_CHANNELS, 0),
        "MissingValues": "n/a",
        "Simulated": record.simulated,
    }


_TASKS = {
    "dance": "dancing along with a guide shown on a screen",
    "calibration": "standing still while the camera learns the body",
}
_INSTRUCTIONS = {
    "dance": "Dance along with the guide as well as you can.",
    "calibration": "Stand still, facing the camera.",
}

_ABSENT_CHANNELS = tuple(
    f"{kind}ChannelCount" for kind in ("ACCEL", "ANGACCEL", "GYRO", "JNTANG", "MAGN", "MISC", "ORNT", "VEL")
)

CHANNEL_COLUMNS = ("name", "component", "type", "tracked_point", "units", "reference_frame")
CHANNELS: dict[str, Any] = {
    "reference_frame": {
        "Description": "Axes in which positions are given.",
        "Levels": {
            "global": {
                "SpatialAxes": "LSA",
                "RotationRule": "right-hand",
                "Description": "Origin on the floor; X left, Y up, Z front of a person facing the camera.",
            }
        },
    }
}


def channels(joint_names: Sequence[str]) -> list[tuple[str, ...]]:
    """Name the columns of a motion file: the time, then x, y and z of every joint."""
    return [
        ("latency", "n/a", "LATENCY", "n/a", "s", "n/a"),
        *((f"{joint}_{axis}", axis, "POS", joint, "m", "global") for joint in joint_names for axis in "xyz"),
    ]


EVENT_COLUMNS = ("onset", "duration", "trial_type", "condition", "period", "step", "is_complete")
EVENTS: dict[str, Any] = {
    "onset": {
        "Description": "Start of the phase, from the first sample of the recording; "
        "in task-session from the start of the session.",
        "Units": "s",
    },
    "duration": {"Description": "How long it lasted.", "Units": "s"},
    "trial_type": {"Description": "Kind of phase.", "Levels": _PHASES},
    "condition": {"Description": "Intensity, variety and transition of the dance."},
    "period": {"Description": "Which condition of the session it was, from 1."},
    "step": {"Description": "Number of the step in the session; repeated steps have their own."},
    "is_complete": {"Description": "false if the phase was interrupted (and then repeated)."},
}

SCAN_COLUMNS = ("filename", "acq_time", "condition", "period", "is_valid", "exclusion_reason", "sha256")
SCANS: dict[str, Any] = {
    "condition": EVENTS["condition"],
    "period": EVENTS["period"],
    "is_valid": {"Description": "false if the recording must not be analysed."},
    "exclusion_reason": {"Description": "Why not."},
    "sha256": {"Description": "SHA-256 digest of the file, so that a later change is noticed."},
}

HEART_RATE_HZ = 20.0
"""A belt tells a reading about every second, at moments of its own. On a grid it comes late by up to a step;
steps of 1 s lower the mean of a dance in which the heart rises by 2 beats/min a second by up to as much."""


def heart_rate(record: SessionRecord, *, longest_gap_s: float) -> dict[str, Any]:
    """Describe the heart-rate recording of a session."""
    return {
        "TaskName": "session",
        "PhysioType": "generic",
        "SamplingFrequency": HEART_RATE_HZ,
        "StartTime": 0.0,
        "Columns": ["heart_rate"],
        "ManufacturersModelName": record.devices["heart_rate"],
        "heart_rate": {
            "LongName": "Heart rate",
            "Description": "Latest reading of the belt; n/a without one in the last "
            f"{longest_gap_s:g} s. RR intervals are in sourcedata/journal.",
            "Units": "beats/min",
        },
        "Simulated": record.simulated,
    }


DEMOGRAPHICS: dict[str, Any] = {
    "age": {"Description": "Age of the participant.", "Units": "year"},
    "sex": {
        "Description": "Sex as told by the participant.",
        "Levels": {"F": "female", "M": "male", "O": "other"},
    },
    "height_m": {"Description": "Height of the body.", "Units": "m"},
    "weight_kg": {"Description": "Weight of the body.", "Units": "kg"},
    "dance_experience_years": {"Description": "Years of dancing.", "Units": "year"},
}

_WHO: dict[str, Any] = {
    "participant_id": {"Description": "Number of the participant."},
    "session_id": {"Description": "Number of the visit."},
}


def participants(records: Sequence[SessionRecord]) -> dict[str, Any]:
    """Describe the columns of the participants' table."""
    note = simulated_note(records)
    return {
        "participant_id": {"Description": f"Number of the participant. {note}".strip()},
        **DEMOGRAPHICS,
        "sequence": {"Description": "Row of the Williams square that gave the order of conditions."},
        "simulated": {
            "Description": "Whether the participant is simulated.",
            "Levels": {"true": "simulated, no person took part", "false": "a person took part"},
        },
    }


def phenotype(questionnaire: str, protocol: StudyProtocol) -> dict[str, Any]:
    """Describe the table of a questionnaire."""
    if questionnaire == "paces":
        tool = {
            "Description": f"{PACES_NAME}, after all conditions. Answers as ticked, not yet turned round."
        }
        items: dict[str, Any] = {
            item.name: {
                "Description": f"{LOWEST} {item.left} ... {HIGHEST} {item.right}"
                + (" (pleasant pole at 1)" if item.is_reversed else ""),
                "Levels": _levels(item.left, item.right),
            }
            for item in PACES
        }
    elif questionnaire == "smoothness":
        text = protocol.questionnaires.smoothness.text
        tool = {"Description": f"One rating after every condition: {text}"}
        items = {
            smoothness_column(condition): {"Description": text, "Levels": _levels(*SMOOTHNESS_ANCHORS)}
            for condition in protocol.order.labels
        }
    else:
        tool, items = {"Description": "Questions about the participant."}, DEMOGRAPHICS
    return {"MeasurementToolMetadata": tool, **_WHO, **items}


def smoothness_column(condition: str) -> str:
    """Give the column of a condition's rating, such as ``light_easy_on``."""
    return condition.replace("-", "_")


def _levels(lowest: str, highest: str) -> dict[str, str]:
    middle = {str(number): str(number) for number in range(LOWEST + 1, HIGHEST)}
    return {str(LOWEST): lowest, **middle, str(HIGHEST): highest}
