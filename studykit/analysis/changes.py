"""What differs between two results of the same study, and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

ROUNDING = 1e-9
"""Numbers that differ by less than this share were rounded otherwise, by another processor or library."""

_KEYS = ("name", "outcome", "condition", "effect", "choice")


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """One value that is not what it was.

    Parameters
    ----------
    where : str
        The way to it in results.json, such as ``tests.heart_rate.friedman.p``.
    old, new : Any
        A number, a word or None; None where it was not or is no longer there.
    """

    where: str
    old: Any
    new: Any

    def __str__(self) -> str:
        """Write the change as a person reads it."""
        return f"{self.where}: {_shown(self.old)} -> {_shown(self.new)}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Changes:
    """How new results differ from old ones.

    Parameters
    ----------
    causes : tuple of str
        What went in that is not what it was: visits, the protocol, the dances, versions.
    changes : tuple of Change
        Values that differ by more than rounding.
    rounded : int
        Numbers that differ by rounding alone.
    """

    causes: tuple[str, ...]
    changes: tuple[Change, ...]
    rounded: int

    def __str__(self) -> str:
        """Say what changed and why, a line each."""
        if not self.changes:
            same = "every result is as before"
            same += f" ({self.rounded} numbers but for rounding)" if self.rounded else ""
            return "\n".join([same, *(f"  although {cause}" for cause in self.causes)])
        why = self.causes or (
            "nothing that went in differs: the old file was changed, or is of another kind of computer",
        )
        head = f"{len(self.changes)} values differ because"
        return "\n".join([head, *(f"  {cause}" for cause in why), *(str(one) for one in self.changes)])

    def to_dict(self) -> dict[str, Any]:
        """Give everything as plain values, ready for JSON."""
        return {
            "causes": list(self.causes),
            "changes": [{"where": one.where, "old": one.old, "new": one.new} for one in self.changes],
            "rounded": self.rounded,
        }


def changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> Changes:
    """Compare two contents of results.json value by value.

    Parameters
    ----------
    old, new : mapping
        Contents of results.json; of an older version of studykit, too: what only one of them has is told.

    Examples
    --------
    >>> before = {"tests": [{"name": "pulse", "p": 0.04}], "provenance": {"protocol_sha256": "1f"}}
    >>> after = {"tests": [{"name": "pulse", "p": 0.06}], "provenance": {"protocol_sha256": "2e"}}
    >>> print(changes(before, after))
    1 values differ because
      the protocol is another
    tests.pulse.p: 0.04 -> 0.06
    """
    before, after = _values(old), _values(new)
    listed, rounded = [], 0
    for where in dict.fromkeys((*before, *after)):
        was, now = before.get(where), after.get(where)
        if was == now:
            continue
        if _is_rounding(was, now):
            rounded += 1
        else:
            listed.append(Change(where=where, old=was, new=now))
    causes = _causes(old.get("provenance", {}), new.get("provenance", {}))
    return Changes(causes=tuple(causes), changes=tuple(listed), rounded=rounded)


def _values(results: Mapping[str, Any]) -> dict[str, Any]:
    return dict(_leaves({key: value for key, value in results.items() if key != "provenance"}, ""))


def _leaves(value: Any, where: str) -> Iterator[tuple[str, Any]]:
    """Give every number and word with the way to it; entries of a list that have names go by them."""
    if isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _leaves(entry, f"{where}.{key}" if where else str(key))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for place, entry in enumerate(value):
            yield from _leaves(entry, f"{where}.{_name(entry, place)}")
    else:
        yield where, value


def _name(entry: Any, place: int) -> str:
    if isinstance(entry, Mapping):
        if {"a", "b"} <= entry.keys() and "name" not in entry:
            return f"{entry['a']} - {entry['b']}"
        for key in _KEYS:
            if isinstance(entry.get(key), str):
                return str(entry[key])
    return str(place + 1)


def _is_rounding(old: Any, new: Any) -> bool:
    if not all(isinstance(value, float | int) and not isinstance(value, bool) for value in (old, new)):
        return False
    return math.isclose(old, new, rel_tol=ROUNDING, abs_tol=1e-15)


def _causes(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Say what went in that differs."""
    if old.get("protocol_sha256") != new.get("protocol_sha256"):
        yield "the protocol is another"
    if old.get("dances_sha256") != new.get("dances_sha256"):
        yield "the dances are others"
    if "visits" not in old and old.get("data_sha256") != new.get("data_sha256"):
        yield "what was recorded is not the same"
    after = new.get("visits", {})
    before = old.get("visits", after)  # older results do not name them
    for words, visits in (
        ("are new", [visit for visit in after if visit not in before]),
        ("are gone", [visit for visit in before if visit not in after]),
        ("were recorded otherwise", [v for v in after if v in before and before[v] != after[v]]),
    ):
        if visits:
            yield f"visits {words}: {', '.join(visits)}"
    were, are = old.get("versions", {}), new.get("versions", {})
    for package in dict.fromkeys((*were, *are)):
        if were.get(package) != are.get(package):
            yield f"{package} was {were.get(package, 'absent')} and is {are.get(package, 'absent')}"


def _shown(value: Any) -> str:
    if value is None:
        return "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
