"""Where a library comes from, as its manifest says."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, kw_only=True, slots=True)
class Origin:
    """What is written down of where a library comes from.

    Parameters
    ----------
    name : str
        What the library is called.
    folders : dict of str to dict
        The folders of takes and the recipes by which they were read.
    citations : dict of str to str
        What to cite, by data set.
    synthetic_seed : int or None
        The seed of a library that studykit made up.
    """

    name: str
    folders: dict[str, dict[str, Any]] = field(default_factory=dict)
    citations: dict[str, str] = field(default_factory=dict)
    synthetic_seed: int | None = None

    def continues(self, older: Origin) -> bool:
        """Tell whether a library of this origin may take the place of an older one: it holds all of that."""
        return self.synthetic_seed == older.synthetic_seed and set(older.folders) <= set(self.folders)
