"""Where everything lies in the folder of a study."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ONLY_SESSION = "01"
"""The number of a visit whose files name none."""


@dataclass(frozen=True)
class StudyFolder:
    """The folder of a study, laid out as a BIDS data set.

    Parameters
    ----------
    path : Path
        The folder itself; nothing is created by naming it.

    Examples
    --------
    >>> StudyFolder(Path("pilot")).journal("07", "01").as_posix()
    'pilot/sourcedata/journal/sub-07_ses-01.jsonl'
    """

    path: Path

    @property
    def name(self) -> str:
        """The folder's own name."""
        return self.path.resolve().name

    @property
    def protocol(self) -> Path:
        """The frozen protocol."""
        return self.path / "code" / "protocol.toml"

    @property
    def dances(self) -> Path:
        """The dances that were shown."""
        return self.path / "sourcedata" / "dances"

    @property
    def planted(self) -> Path:
        """What was planted in simulated people; analysis never reads it."""
        return self.path / "sourcedata" / "simulation" / "planted.json"

    @property
    def journals(self) -> Path:
        """What was recorded: the truth."""
        return self.path / "sourcedata" / "journal"

    @property
    def derivatives(self) -> Path:
        """Tables, figures and the report, which can always be made again."""
        return self.path / "derivatives" / "studykit"

    @property
    def figures(self) -> Path:
        """The figures."""
        return self.derivatives / "figures"

    @property
    def phenotype(self) -> Path:
        """Questionnaires, one table each."""
        return self.path / "phenotype"

    def journal(self, participant: str, session: str) -> Path:
        """Give the journal of one session."""
        return self.journals / f"sub-{participant}_ses-{session}.jsonl"

    def frames(self, participant: str, session: str, *, step: int, phase: str) -> Path:
        """Give the file of the frames that one step recorded."""
        return self.journals / f"sub-{participant}_ses-{session}" / f"{step:02d}_{phase}.frames"

    def motion(self, participant: str, session: str) -> Path:
        """Give the folder of a session's derived Motion-BIDS files."""
        return self.path / f"sub-{participant}" / f"ses-{session}" / "motion"

    def recorded(self) -> tuple[Path, ...]:
        """Give the journals of all sessions recorded here so far, in the order of their names.

        A journal whose very first line was cut off holds nothing and does not count; running or resuming
        that session takes it up.
        """
        journals = sorted(self.journals.glob("sub-*_ses-*.jsonl"))
        return tuple(path for path in journals if _has_a_line(path))

    def sessions(self) -> tuple[Path, ...]:
        """Give what to read for every session, in the order of participants.

        The journal where there is one; else the folder of the session's Motion-BIDS files, as in a study
        that was recorded elsewhere.
        """
        journals = {path.stem: path for path in self.recorded()}
        folders = {
            f"{subject.name}_{visit}": motion
            for subject in self.path.glob("sub-*")
            for visit, motion in _motion_folders(subject)
        }
        everything = folders | journals
        return tuple(everything[name] for name in sorted(everything))


def _motion_folders(subject: Path) -> list[tuple[str, Path]]:
    """Give each visit of a participant with its folder of movement; who came once may have no visits."""
    folders = [(visit.name, visit / "motion") for visit in subject.glob("ses-*")]
    folders.append((f"ses-{ONLY_SESSION}", subject / "motion"))
    return [(visit, folder) for visit, folder in folders if any(folder.glob("*_events.tsv"))]


def _has_a_line(path: Path) -> bool:
    with path.open("rb") as file:
        return file.readline().endswith(b"\n")
