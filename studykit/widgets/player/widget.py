"""The widget that plays a motion; imported only when one is made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets

from studykit.core.errors import InputError
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.widgets.player import material

_WIDGETS = Path(__file__).parents[1]
SPEEDS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0)
"""How many times faster than danced a player can play."""


class _Checked(traitlets.TraitType[Any, Any]):
    """A trait whose every new value goes through a function of the widget and the value."""

    def __init__(self, check: Callable[[Any, Any], Any], default: Any) -> None:
        super().__init__(default)
        self._check = check

    def validate(self, obj: Any, value: Any) -> Any:
        return self._check(obj, value)


def _poses(player: MotionPlayer, values: Any) -> material.Poses:
    return material.poses(_NOTHING if values is None else values, len(player.parents))


def _joint_values(player: MotionPlayer, values: Any) -> list[float]:
    return material.joint_values(values, len(player.parents))


def _rate(_: MotionPlayer, value: Any) -> float:
    if not isinstance(value, int | float) or not 0.0 < value < np.inf:
        raise InputError(
            f"the rate is {value!r}",
            where="frame_rate_hz",
            remedy="give a positive number",
        )
    return float(value)


def _time(_: MotionPlayer, value: Any) -> float:
    if not isinstance(value, int | float) or not 0.0 <= value < np.inf:
        raise InputError(f"the time is {value!r}", where="time_s", remedy="give seconds from the start")
    return float(value)


def _bytes(values: material.Poses, _: Any) -> memoryview:
    return memoryview(values.tobytes())


_NOTHING = np.zeros((0, len(NEUTRAL_BODY.parents), 3), dtype="<f4")


class MotionPlayer(anywidget.AnyWidget):
    """A figure that moves in the notebook: play, stop, step, go anywhere, see it from any side.

    The motion crosses to the browser once and plays there on the browser's own clock, each frame as it is.
    Every value below may be set again later; the picture follows.

    Parameters
    ----------
    positions : array_like, shape (frame, joint, 3), m, optional
        Where the joints are: right-handed, Y up, the floor at 0. Nothing is shown without them.
    parents : sequence of int, optional
        The parent of each joint, -1 for the root; fixed once made. The 24 joints of SMPL if not given.
    joint_names : sequence of str, optional
        Names that begin with left_ or right_ give the sides; "head" is drawn as a head. SMPL's if not given.
    **values
        `frame_rate_hz` (30); `joint_values`, one a joint, colour the joints, with their meaning in
        `joint_values_label`; `marks`, (start_s, stop_s, label, kind) with a kind of flag, keep, cut or note;
        `ghost`, the positions of a second figure, with its `ghost_name`; `title`; `is_synthetic`; `time_s`,
        `is_playing`, `speed`, `is_looping`, `is_mirrored` (as in a mirror, to dance along).

    Raises
    ------
    InputError
        If a value cannot be shown, when made and whenever it is set.
    """

    _esm = (_WIDGETS / "bundle.js").read_text(encoding="utf-8")
    _css = (_WIDGETS / "style.css").read_text(encoding="utf-8")

    room = traitlets.Unicode("player", read_only=True).tag(sync=True)
    parents = traitlets.Tuple(read_only=True).tag(sync=True)
    sides = traitlets.List(traitlets.Unicode(), read_only=True).tag(sync=True)
    head_joint = traitlets.Int(-1, read_only=True).tag(sync=True)

    positions = _Checked(_poses, _NOTHING).tag(sync=True, to_json=_bytes)
    ghost = _Checked(_poses, _NOTHING).tag(sync=True, to_json=_bytes)
    ghost_name = traitlets.Unicode("partner").tag(sync=True)
    frame_rate_hz = _Checked(_rate, 30.0).tag(sync=True)
    joint_values = _Checked(_joint_values, []).tag(sync=True)
    joint_values_label = traitlets.Unicode("intensity").tag(sync=True)
    marks = _Checked(lambda _, values: material.marks(values), []).tag(sync=True)
    title = traitlets.Unicode().tag(sync=True)
    is_synthetic = traitlets.Bool().tag(sync=True)

    time_s = _Checked(_time, 0.0).tag(sync=True)
    is_playing = traitlets.Bool().tag(sync=True)
    speed = traitlets.Enum(SPEEDS, 1.0).tag(sync=True)
    is_looping = traitlets.Bool(default_value=True).tag(sync=True)
    is_mirrored = traitlets.Bool().tag(sync=True)

    def __init__(
        self,
        *,
        positions: Any = None,
        parents: Sequence[int] = NEUTRAL_BODY.parents,
        joint_names: Sequence[str] = (),
        **values: Any,
    ) -> None:
        unknown = sorted(set(values) - set(self.trait_names()))
        if unknown:
            raise InputError(f"a player has no {unknown[0]!r}", remedy="see help(MotionPlayer)")
        names = _names(parents, joint_names)
        self.set_trait("parents", tuple(int(parent) for parent in parents))
        self.set_trait("sides", material.sides(names))
        self.set_trait("head_joint", names.index("head") if "head" in names else -1)
        empty = np.zeros((0, len(self.parents), 3))
        values = {"ghost": empty} | {name: value for name, value in values.items() if value is not None}
        super().__init__(positions=empty if positions is None else positions, **values)

    def show(self, positions: Any, **values: Any) -> None:
        """Play another motion on the same body from its start; everything crosses at once."""
        with self.hold_sync():
            self.positions = positions
            self.time_s = 0.0
            for name, value in values.items():
                self.set_trait(name, value)


def _names(parents: Sequence[int], joint_names: Sequence[str]) -> list[str]:
    if any(not -1 <= parent < joint for joint, parent in enumerate(parents)) or not parents:
        raise InputError(
            "a parent comes after its child",
            where="parents",
            remedy="give the root (-1) and every parent first",
        )
    if joint_names and len(joint_names) != len(parents):
        raise InputError(
            f"{len(joint_names)} names are given for {len(parents)} joints",
            where="joint_names",
            remedy="give one name a joint",
        )
    if not joint_names and tuple(parents) == NEUTRAL_BODY.parents:
        return list(NEUTRAL_BODY.joint_names)
    return list(joint_names) or [""] * len(parents)
