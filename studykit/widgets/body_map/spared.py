"""Which joints are spared and how far: the state that the body map shows, checked as it is set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import traitlets

from studykit.core.errors import InputError
from studykit.motion.joint_mask import JointMask, beyond, joint_number
from studykit.motion.skeleton import JOINT_NAMES


class SparedJoints(traitlets.HasTraits):
    """What a widget with a body map holds.

    Only the joints that a person chose stand in `weights` and `speed_limits_rad_s`; each speaks for all
    beyond it too, and `mask` says what that makes of all 24.
    """

    weights = traitlets.Dict().tag(sync=True)
    speed_limits_rad_s = traitlets.Dict().tag(sync=True)
    suggested_speeds_rad_s = traitlets.Dict().tag(sync=True)
    joint_report = traitlets.List(traitlets.Dict()).tag(sync=True)

    @property
    def mask(self) -> JointMask:
        """What is asked for the joints, those beyond the chosen ones included."""
        return mask(self.weights, self.speed_limits_rad_s)

    @traitlets.validate("weights")
    def _weights_can_be_used(self, proposal: Any) -> dict[str, float]:
        return checked_weights(proposal["value"])

    @traitlets.validate("speed_limits_rad_s", "suggested_speeds_rad_s")
    def _speeds_can_be_used(self, proposal: Any) -> dict[str, float]:
        return checked_speeds(proposal["value"], where=proposal["trait"].name)


def checked_weights(values: Mapping[str, Any]) -> dict[str, float]:
    """Check how far each joint may work: 0 is spared, 1 is free.

    Raises
    ------
    InputError
        If a name is no joint or a weight is not between 0 and 1.

    Examples
    --------
    >>> checked_weights({"right_elbow": 0, "left_knee": 0.5})
    {'left_knee': 0.5, 'right_elbow': 0.0}
    """
    for joint, weight in values.items():
        if not (_is_number(weight) and 0.0 <= weight <= 1.0):
            raise InputError(
                f"the weight of {joint} is {weight!r}",
                where="weights",
                remedy="give a number from 0 (spared) to 1 (free)",
            )
    return _in_order(values)


def checked_speeds(values: Mapping[str, Any], *, where: str) -> dict[str, float]:
    """Check how fast each joint may turn, rad/s; a joint without a limit is left out.

    Raises
    ------
    InputError
        If a name is no joint or a speed is not positive and finite.
    """
    for joint, speed in values.items():
        if not (_is_number(speed) and 0.0 < speed < np.inf):
            raise InputError(
                f"the speed of {joint} is {speed!r}",
                where=where,
                remedy="give rad/s above 0, or nothing",
            )
    return _in_order(values)


def mask(weights: Mapping[str, float], speed_limits_rad_s: Mapping[str, float]) -> JointMask:
    """Let each chosen joint speak for itself and all beyond it that were not chosen themselves.

    Parameters
    ----------
    weights : mapping of str to float
        0 (spared) to 1 (free).
    speed_limits_rad_s : mapping of str to float, rad/s
        Fastest turn that is allowed.
    """
    free, limits = np.ones(len(JOINT_NAMES)), np.full(len(JOINT_NAMES), np.inf)
    for chosen, column in ((weights, free), (speed_limits_rad_s, limits)):
        for joint, value in _in_order(chosen).items():
            column[list(beyond(joint))] = value
    return JointMask(weights=free, speed_limits_rad_s=limits)


def _in_order(values: Mapping[str, Any]) -> dict[str, float]:
    """Give the values from the pelvis outwards; parents first."""
    return {joint: float(values[joint]) for joint in sorted(values, key=joint_number)}


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
