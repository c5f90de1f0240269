"""Where a library comes from, as its manifest says."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True, slots=True)
class Origin:
    """What is written down of where a library comes from; names no place on a machine.

    Parameters
    ----------
    name : str
        What the library is called.
    data_sets : tuple of str
        Whose takes it holds.
    citations : dict of str to str
        What to cite, by data set.
    synthetic : dict of str to int or None
        Seed and number of segments of a library that studykit made up.
    """

    name: str
    data_sets: tuple[str, ...] = ()
    citations: dict[str, str] = field(default_factory=dict)
    synthetic: dict[str, int] | None = None

    def continues(self, older: Origin) -> bool:
        """Tell whether a library of this origin may take the place of an older one: it holds all of that."""
        seeds = [one.synthetic["seed"] if one.synthetic else None for one in (self, older)]
        return seeds[0] == seeds[1] and set(older.data_sets) <= set(self.data_sets)
