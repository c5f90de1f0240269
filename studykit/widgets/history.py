"""What was set before, so that it can be taken back and set again."""

from __future__ import annotations

from typing import Generic, TypeVar

State = TypeVar("State")


class History(Generic[State]):
    """The states that something went through.

    Parameters
    ----------
    first : State
        How it begins.

    Examples
    --------
    >>> history = History("free")
    >>> history.record("reduced"), history.record("spared"), history.back(), history.back()
    (None, None, 'reduced', 'free')
    >>> history.forth(), history.can_go_forth
    ('reduced', True)
    """

    def __init__(self, first: State) -> None:
        self._states = [first]
        self._now = 0
        self._change = ""

    @property
    def can_go_back(self) -> bool:
        """Whether there is a state before this one."""
        return self._now > 0

    @property
    def can_go_forth(self) -> bool:
        """Whether a state was taken back."""
        return self._now + 1 < len(self._states)

    def record(self, state: State, *, change: str = "") -> None:
        """Remember a new state; what was taken back is forgotten.

        States that follow each other under the same name of a `change`, as while a slider moves, are one.
        """
        if state == self._states[self._now]:
            return
        del self._states[self._now + 1 :]
        if change and change == self._change and self._now > 0:
            self._states[self._now] = state
            return
        self._states.append(state)
        self._now += 1
        self._change = change

    def back(self) -> State:
        """Give the state before this one, or the first."""
        return self._go(-1)

    def forth(self) -> State:
        """Give the state that was taken back last, or this one."""
        return self._go(1)

    def _go(self, by: int) -> State:
        self._now = min(max(self._now + by, 0), len(self._states) - 1)
        self._change = ""
        return self._states[self._now]
