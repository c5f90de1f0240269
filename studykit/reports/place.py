"""Finding the folder of whatever stands for a study."""

from __future__ import annotations

from pathlib import Path

from studykit.core.errors import InputError
from studykit.recording.study_folder import StudyFolder
from studykit.session.study import Study

AnyStudy = Study | StudyFolder | Path | str
"""A study: opened, or its folder."""


def folder_of(study: AnyStudy) -> StudyFolder:
    """Give the folder of a study in which something was recorded.

    Raises
    ------
    InputError
        If there is no study, or nothing has been recorded yet.
    """
    if isinstance(study, Study):
        folder = study.folder
    else:
        folder = study if isinstance(study, StudyFolder) else StudyFolder(Path(study))
    if not folder.protocol.exists() and (folder.path / "dataset_description.json").exists():
        raise InputError(
            "the protocol that was followed is not there",
            where=folder.protocol,
            remedy="put it there, or name it once with 'studykit analyse --protocol FILE'",
        )
    if not folder.protocol.exists():
        raise InputError("there is no study here", where=folder.path, remedy="give the folder of a study")
    if not folder.sessions():
        raise InputError(
            "nothing has been recorded yet",
            where=folder.path,
            remedy="run a visit with 'studykit session run'",
        )
    return folder
