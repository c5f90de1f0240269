"""What the figures and tables of a study are made from, and what a figure is that can be asked for."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.io.protocol_file import read_protocol
from studykit.protocol.study_protocol import StudyProtocol
from studykit.recording.session_record import SessionRecord
from studykit.recording.study_folder import StudyFolder
from studykit.reports import readable

if TYPE_CHECKING:
    import pandas as pd

    from studykit.figures.canvas import PaperFigure


@dataclass(frozen=True, kw_only=True)
class Material:
    """What the figures and tables of a study are made from.

    Parameters
    ----------
    folder : StudyFolder
        Where it was recorded.
    trials : DataFrame
        One row a trial, with the columns of `trials.csv`.
    further : tuple of Dance
        Dances that are not of the study, for figures that its own cannot show.
    """

    folder: StudyFolder
    trials: pd.DataFrame
    further: tuple[Dance, ...] = ()

    @cached_property
    def protocol(self) -> StudyProtocol:
        """What was followed."""
        return read_protocol(self.folder.protocol)

    @cached_property
    def dances(self) -> Mapping[str, Dance]:
        """The dances that were shown, those that can be read."""
        return readable.dances(self.folder).by_condition

    @property
    def every_dance(self) -> tuple[Dance, ...]:
        """The dances that were shown, and the further ones."""
        return (*self.dances.values(), *self.further)

    @cached_property
    def records(self) -> tuple[SessionRecord, ...]:
        """The visits that can be read."""
        return readable.visits(self.folder).records

    @cached_property
    def results(self) -> Mapping[str, Any]:
        """What the analysis wrote.

        Raises
        ------
        InputError
            If the study was not analysed yet.
        """
        path = self.folder.derivatives / "results.json"
        if not path.exists():
            raise InputError(
                "the study was not analysed yet", where=path, remedy="run 'studykit analyse' first"
            )
        found: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return found

    @property
    def is_simulated(self) -> bool:
        """Whether any person or device was simulated."""
        return bool(self.trials["simulated"].any())


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawing:
    """A figure that can be asked for.

    Parameters
    ----------
    name : str
        Its number in the paper, or words.
    caption : str
        What it shows.
    of : callable
        Draws it.
    """

    name: str
    caption: str
    of: Callable[[Material], PaperFigure]

    @property
    def stem(self) -> str:
        """The name of its files, without ending."""
        return f"figure-{self.name}" if self.name[0].isdigit() else self.name

    @property
    def title(self) -> str:
        """What it is called on a page.

        Examples
        --------
        >>> [Drawing(name=name, caption="", of=print).title for name in ("10a", "targets-hit")]
        ['Figure 10a', 'Targets hit']
        """
        return self.stem.replace("-", " ").capitalize()
