"""What of a study can be read; what cannot is left out here and named by `checks.problems`."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_value
from studykit.library.dance_file import read_dance
from studykit.motion.motion import JointTracks
from studykit.recording.session_record import SessionRecord, StepRecord, read_session
from studykit.recording.study_folder import StudyFolder


@dataclass(frozen=True, kw_only=True, slots=True)
class Visits:
    """The visits that can be read, and why others cannot."""

    records: tuple[SessionRecord, ...]
    errors: tuple[InputError, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Dances:
    """The dances that can be read, by condition, and why others cannot."""

    by_condition: Mapping[str, Dance]
    errors: tuple[InputError, ...]

    def shown_to(self, record: SessionRecord, condition: str | None) -> Dance | None:
        """Give the dance of a condition, unless somebody was shown another one or it cannot be read."""
        dance = self.by_condition.get(condition or "")
        told = record.dance_sha256.get(condition or "")
        return dance if dance is not None and told in (None, dance.sha256) else None


def stamp(folder: StudyFolder) -> str:
    """Give what changes when a file of the study does, but for its derivatives; no file is read."""
    files = []
    for root, folders, names in os.walk(folder.path):
        folders[:] = sorted(name for name in folders if Path(root, name) != folder.derivatives)
        for name in sorted(names):
            found = os.stat(os.path.join(root, name))  # noqa: PTH116, PTH118 - of thousands of files
            files.append((root, name, found.st_size, found.st_mtime_ns))
    return sha256_of_value(files)


def visits(folder: StudyFolder) -> Visits:
    """Read every visit of a study that can be read; from memory as long as no file changed.

    Raises
    ------
    InputError
        If none can; it is what the first of them lacks.
    """
    return _visits(folder, stamp(folder))


@lru_cache(maxsize=2)
def _visits(folder: StudyFolder, stamp: str) -> Visits:  # noqa: ARG001
    records, errors = [], []
    for path in folder.sessions():
        try:
            records.append(read_session(path))
        except InputError as error:
            errors.append(error)
    if errors and not records:
        raise errors[0]
    return Visits(records=tuple(records), errors=tuple(errors))


def dances(folder: StudyFolder, *, as_of: str | None = None) -> Dances:
    """Read every dance of a study that can be read; from memory as long as no file changed.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    as_of : str, optional
        Its `stamp`, where it is known already.

    Raises
    ------
    InputError
        If none can; it is what the first of them lacks.
    """
    return _dances(folder, as_of or stamp(folder))


@lru_cache(maxsize=2)
def _dances(folder: StudyFolder, stamp: str) -> Dances:  # noqa: ARG001
    found, errors = {}, []
    for path in sorted(folder.dances.glob("*.json")):
        try:
            found[path.stem] = read_dance(folder.dances, path.stem)
        except InputError as error:
            errors.append(error)
    if not found:
        missing = InputError(
            "no dances here", where=folder.dances, remedy="put back the dances that were shown"
        )
        raise errors[0] if errors else missing
    return Dances(by_condition=found, errors=tuple(errors))


def tracks(record: SessionRecord, step: StepRecord) -> JointTracks | None:
    """Read what the camera saw in a step; None if it saw nothing, or the file is not what was recorded."""
    try:
        return record.frames(step.step)
    except InputError:
        return None
