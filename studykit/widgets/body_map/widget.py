"""The widget of the body map; imported only when one is made."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from studykit.widgets.body_map.spared import SparedJoints
from studykit.widgets.history import History

_WIDGETS = Path(__file__).parents[1]


def joint_picker(
    *,
    weights: Mapping[str, float] | None = None,
    speed_limits_rad_s: Mapping[str, float] | None = None,
) -> JointPicker:
    """Click on a drawn body the joints that are to be spared, and say how far.

    Parameters
    ----------
    weights : mapping of str to float, optional
        How far joints may work at the beginning: 0 is spared, 1 is free. A joint speaks for all beyond it.
    speed_limits_rad_s : mapping of str to float, rad/s, optional
        How fast joints may turn.

    Returns
    -------
    JointPicker
        Show it as the last line of a cell; `.mask` is what was chosen.

    Raises
    ------
    InputError
        If a name is no joint or a number cannot be used.
    """
    return JointPicker(weights=dict(weights or {}), speed_limits_rad_s=dict(speed_limits_rad_s or {}))


class JointPicker(SparedJoints, anywidget.AnyWidget):
    """A drawn body that faces you, with its joints to click.

    Parameters
    ----------
    **values
        `weights` and `speed_limits_rad_s` of chosen joints; `suggested_speeds_rad_s`, what to offer.
    """

    _esm = (_WIDGETS / "bundle.js").read_text(encoding="utf-8")
    _css = (_WIDGETS / "style.css").read_text(encoding="utf-8")

    room = traitlets.Unicode("body_map", read_only=True).tag(sync=True)
    can_undo = traitlets.Bool(read_only=True).tag(sync=True)
    can_redo = traitlets.Bool(read_only=True).tag(sync=True)

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        self._history = History((self.weights, self.speed_limits_rad_s))
        self.observe(self._remember, ["weights", "speed_limits_rad_s"])
        self.on_msg(lambda _, message, __: self._heed(message))

    def undo(self) -> None:
        """Take the last change back."""
        self._take(self._history.back())

    def redo(self) -> None:
        """Make a change again that was taken back."""
        self._take(self._history.forth())

    def _take(self, state: tuple[dict[str, float], dict[str, float]]) -> None:
        self.unobserve(self._remember, ["weights", "speed_limits_rad_s"])
        with self.hold_sync():
            self.weights, self.speed_limits_rad_s = state
            self._tell()
        self.observe(self._remember, ["weights", "speed_limits_rad_s"])

    def _remember(self, _: Any) -> None:
        self._history.record((self.weights, self.speed_limits_rad_s))
        self._tell()

    def _tell(self) -> None:
        self.set_trait("can_undo", self._history.can_go_back)
        self.set_trait("can_redo", self._history.can_go_forth)

    def _heed(self, message: Any) -> None:
        """Act on what was pressed in the browser."""
        match message:
            case {"deed": "undo"}:
                self.undo()
            case {"deed": "redo"}:
                self.redo()
