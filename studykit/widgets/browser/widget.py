"""The widget that browses a library; imported only when one is made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import traitlets

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.kinematics import joint_positions
from studykit.motion.segmentation import FRAME_RATE_HZ
from studykit.widgets.browser.segment_table import COLUMNS, Filters, SegmentTable, check_sort
from studykit.widgets.player.widget import MotionPlayer

if TYPE_CHECKING:
    import pandas as pd

PAGE = 10
"""Rows of a page: only these cross to the browser."""
_MASS = f"{DEFAULT_BODY_MASS_KG:g} kg"


def library_browser(library: DanceLibrary) -> LibraryBrowser:
    """Look through a dance library in the notebook: filter it, sort it, play what you choose.

    Parameters
    ----------
    library : DanceLibrary
        As `studykit.open_library` gives it.

    Returns
    -------
    LibraryBrowser
        Show it as the last line of a cell. `.selected` is the segment that plays, `.found` all that the
        filters let through.
    """
    return LibraryBrowser(library)


class LibraryBrowser(MotionPlayer):
    """A player with the table of a library's segments.

    Parameters
    ----------
    library : DanceLibrary
        Whose segments.
    """

    columns = traitlets.List(traitlets.List(), read_only=True).tag(sync=True)
    choices = traitlets.Dict(read_only=True).tag(sync=True)
    rows = traitlets.List(traitlets.Dict()).tag(sync=True)
    facts = traitlets.List(traitlets.List()).tag(sync=True)
    total = traitlets.Int().tag(sync=True)
    pages = traitlets.Int().tag(sync=True)

    filters = traitlets.Dict().tag(sync=True)
    sort = traitlets.List(traitlets.Unicode(), default_value=["take", "ascending"]).tag(sync=True)
    page = traitlets.Int().tag(sync=True)
    selected = traitlets.Int(-1).tag(sync=True)

    def __init__(self, library: DanceLibrary) -> None:
        self._library = library
        self._table = SegmentTable(library)
        self._found = self._table.found(Filters(), ["take", "ascending"])
        self.set_trait("room", "browser")
        self.set_trait("columns", [list(column) for column in COLUMNS])
        self.set_trait("choices", self._table.choices)
        super().__init__(
            title=library.name,
            is_synthetic=library.is_synthetic,
            joint_values_label="energy, J",
            frame_rate_hz=FRAME_RATE_HZ,
        )
        self._turn_page()

    @property
    def found(self) -> pd.DataFrame:
        """The segments that the filters let through, in the order of the table."""
        found = self._library.segments.iloc[self._found]
        return found.assign(
            linear_j=self._table.columns["linear_j"][self._found],
            rotational_j=self._table.columns["rotational_j"][self._found],
        )

    @traitlets.validate("filters")
    def _filters_can_be_used(self, proposal: Any) -> Any:
        Filters.read(proposal["value"])
        return proposal["value"]

    @traitlets.validate("sort")
    def _sort_can_be_used(self, proposal: Any) -> Any:
        return list(check_sort(proposal["value"]))

    @traitlets.validate("page")
    def _page_is_there(self, proposal: Any) -> int:
        return min(max(int(proposal["value"]), 0), max(self._page_count() - 1, 0))

    @traitlets.validate("selected")
    def _segment_is_there(self, proposal: Any) -> int:
        segment = int(proposal["value"])
        if not -1 <= segment < len(self._table):
            raise InputError(
                f"there is no segment {segment}",
                where=self._library.name,
                remedy=f"choose 0 to {len(self._table) - 1}, or -1 for none",
            )
        return segment

    @traitlets.observe("filters", "sort")
    def _find(self, _: Any) -> None:
        self._found = self._table.found(Filters.read(self.filters), self.sort)
        self.page = 0
        self._turn_page()

    @traitlets.observe("page")
    def _turn_page(self, _: Any = None) -> None:
        with self.hold_sync():
            self.total = len(self._found)
            self.pages = self._page_count()
            self.rows = self._table.rows(self._found[PAGE * self.page : PAGE * (self.page + 1)])

    def _page_count(self) -> int:
        return -(-len(self._found) // PAGE)

    @traitlets.observe("selected")
    def _play(self, _: Any) -> None:
        if self.selected < 0:
            self.show(np.zeros((0, len(self.parents), 3)), is_playing=False, facts=[], joint_values=[])
            return
        library, segment = self._library, self.selected
        energies = library.linear_energies[segment] + library.rotational_energies[segment]
        cell = {name: self._table.cell(name, segment) for name, _, _ in COLUMNS}
        partners = str(library.segments["partners"].iloc[segment]) if "partners" in library.segments else ""
        self.show(
            joint_positions(library.motion(segment)),
            joint_values=energies * DEFAULT_BODY_MASS_KG,
            title=f"{cell['take']}, from {cell['start_s']} s",
            is_synthetic=bool(library.segments["is_synthetic"].iloc[segment]),
            is_playing=True,
            facts=[
                ["segment", str(segment)],
                ["take", cell["take"]],
                ["start", f"{cell['start_s']} s"],
                ["genre", cell["genre"]],
                ["performer", cell["performer"]],
                *([["danced with", partners]] if partners else []),
                ["data set", cell["data_set"]],
                ["licence", cell["licence"]],
                ["linear energy", f"{cell['linear_j']} J"],
                ["rotational energy", f"{cell['rotational_j']} J"],
                ["unit", f"summed over the frames of the segment, times {_MASS}, as in the paper"],
            ],
        )
