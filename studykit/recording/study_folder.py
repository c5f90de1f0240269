"""Where everything lies in the folder of a study."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


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

    def sessions(self) -> tuple[Path, ...]:
        """Give the journals of all sessions recorded so far, in the order of their names.

        A journal whose very first line was cut off holds nothing and does not count; running or resuming
        that session takes it up.
        """
        journals = sorted(self.journals.glob("sub-*_ses-*.jsonl"))
        return tuple(path for path in journals if _has_a_line(path))


def _has_a_line(path: Path) -> bool:
    with path.open("rb") as file:
        return file.readline().endswith(b"\n")
