"""Which joints a dance spares and how far: for an injury, an operation, a pain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from studykit.core.arrays import Booleans, Floats, frozen
from studykit.core.errors import InputError, nearest
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY

_JOINTS = len(JOINT_NAMES)


def _unlimited() -> Floats:
    return np.full(_JOINTS, np.inf)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class JointMask:
    """Which joints are spared: how little they should do, and what they must never do.

    Parameters
    ----------
    weights : array_like, shape (24,)
        a_j of Eq. 11, 0 to 1: at 1 a joint is free, at 0 none of its energy is wanted.
    speed_limits_rad_s : array_like, shape (24,), rad/s
        Highest angular speed at which each joint may turn relative to its parent; infinite where it is free.
    angle_limits_rad : array_like, shape (24,), rad
        Furthest that each joint may turn from its rest pose; infinite where it is free.

    Raises
    ------
    InputError
        If a weight lies outside 0-1, or a limit is not above 0.
    """

    weights: Floats = field(default_factory=lambda: np.ones(_JOINTS))
    speed_limits_rad_s: Floats = field(default_factory=_unlimited)
    angle_limits_rad: Floats = field(default_factory=_unlimited)

    def __post_init__(self) -> None:
        for name in ("weights", "speed_limits_rad_s", "angle_limits_rad"):
            object.__setattr__(self, name, frozen(getattr(self, name), shape=(_JOINTS,), name=name))
        _require((self.weights >= 0.0) & (self.weights <= 1.0), "a weight", self.weights, "say 0 to 1")
        for name, limits in (
            ("a speed limit", self.speed_limits_rad_s),
            ("an angle limit", self.angle_limits_rad),
        ):
            _require(limits > 0.0, name, limits, "say a number above 0, or none")

    def _key(self) -> tuple[bytes, ...]:
        return tuple(
            getattr(self, name).tobytes() for name in ("weights", "speed_limits_rad_s", "angle_limits_rad")
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, JointMask) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    @property
    def spared(self) -> tuple[str, ...]:
        """Names of the joints that are not free, in the order of the body."""
        limited = np.isfinite(self.speed_limits_rad_s) | np.isfinite(self.angle_limits_rad)
        return tuple(JOINT_NAMES[joint] for joint in np.flatnonzero(limited | (self.weights < 1.0)))

    def stricter(self, other: JointMask) -> JointMask:
        """Give a mask that spares what either spares, each joint as far as the one that spares it more."""
        return JointMask(
            weights=np.minimum(self.weights, other.weights),
            speed_limits_rad_s=np.minimum(self.speed_limits_rad_s, other.speed_limits_rad_s),
            angle_limits_rad=np.minimum(self.angle_limits_rad, other.angle_limits_rad),
        )

    def keeps(self, speeds_rad_s: Floats, angles_rad: Floats) -> Booleans:
        """Tell which joints stay within their limits.

        Parameters
        ----------
        speeds_rad_s, angles_rad : ndarray, shape (..., 24), rad/s and rad
            Peaks of each joint.
        """
        return np.asarray((speeds_rad_s <= self.speed_limits_rad_s) & (angles_rad <= self.angle_limits_rad))

    @property
    def is_limited(self) -> Booleans:
        """Which joints have a limit, shape (24,)."""
        return np.asarray(np.isfinite(self.speed_limits_rad_s) | np.isfinite(self.angle_limits_rad))

    def limited(self, speed_limits_rad_s: Floats) -> JointMask:
        """Give the same mask with a speed limit for every spared joint that has none.

        Parameters
        ----------
        speed_limits_rad_s : ndarray, shape (24,), rad/s
            For example what the joints of a library do: `DanceLibrary.speed_limits`.
        """
        is_open = np.isinf(self.speed_limits_rad_s) & np.isin(JOINT_NAMES, self.spared)
        return replace(
            self, speed_limits_rad_s=np.where(is_open, speed_limits_rad_s, self.speed_limits_rad_s)
        )

    def to_dict(self) -> dict[str, dict[str, float | None]]:
        """Give the spared joints as plain values, by name; None stands for no limit."""
        columns = {"weight": self.weights} | {name: getattr(self, name) for name in _LIMITS}
        return {
            name: {
                key: float(values[joint]) if np.isfinite(values[joint]) else None
                for key, values in columns.items()
            }
            for name in self.spared
            for joint in [JOINT_NAMES.index(name)]
        }

    @classmethod
    def from_dict(cls, spared: Mapping[str, Mapping[str, Any]]) -> JointMask:
        """Undo `to_dict`; what is left out is free.

        Raises
        ------
        InputError
            If there is no such joint or field, or a number is none that a mask can have.
        """
        columns = {"weight": np.ones(_JOINTS)} | {name: _unlimited() for name in _LIMITS}
        for name, said in spared.items():
            joint = joint_number(name)
            for key, value in said.items():
                if key not in columns:
                    raise InputError(
                        f'"{key}" says nothing of a joint', where=name, remedy=nearest(key, columns)
                    )
                try:
                    columns[key][joint] = columns[key][joint] if value is None else float(value)
                except (TypeError, ValueError):
                    problem = f"a {key} of {value!r}"
                    raise InputError(problem, where=name, remedy="say a number") from None
        return cls(weights=columns.pop("weight"), **columns)


_LIMITS = ("speed_limits_rad_s", "angle_limits_rad")


def spare(
    joints: str | Sequence[str],
    *,
    weights: float | Sequence[float] = 0.0,
    speed_limits_rad_s: float | Sequence[float] | None = None,
    angle_limits_rad: float | Sequence[float] | None = None,
) -> JointMask:
    """Spare joints and all that hangs on them, as a physiotherapist says "the right elbow".

    A joint that is named itself keeps what is said of it, whatever is said of a joint that it hangs on.

    Parameters
    ----------
    joints : str or sequence of str
        Names of joints, such as "right_elbow".
    weights : float or one for each name
        0 (spared altogether) to 1 (free).
    speed_limits_rad_s : float or one for each name, rad/s, optional
        Highest angular speed; none if not given: see `JointMask.limited`.
    angle_limits_rad : float or one for each name, rad, optional
        Furthest from the rest pose; none if not given.

    Raises
    ------
    InputError
        If there is no such joint, a number is none that a mask can have, or two are said of one joint.

    Examples
    --------
    >>> spare("right_elbow", speed_limits_rad_s=2.0).spared
    ('right_elbow', 'right_wrist', 'right_hand')
    """
    names = [joints] if isinstance(joints, str) else list(joints)
    if not names:
        raise InputError("no joint is named", where="spare", remedy="name one, such as right_elbow")
    said = {
        "weights": (np.ones(_JOINTS), weights),
        "speed_limits_rad_s": (_unlimited(), np.inf if speed_limits_rad_s is None else speed_limits_rad_s),
        "angle_limits_rad": (_unlimited(), np.inf if angle_limits_rad is None else angle_limits_rad),
    }
    for key, (column, numbers) in said.items():
        own = _by_joint(names, numbers, key)
        for joint in sorted(own):  # parents first: what hangs on them may say otherwise
            column[list(beyond(joint))] = own[joint]
    return JointMask(**{key: column for key, (column, _) in said.items()})


def beyond(joint: str | int) -> tuple[int, ...]:
    """Give the numbers of a joint and of all joints that hang on it, parents first.

    Examples
    --------
    >>> [JOINT_NAMES[number] for number in beyond("left_ankle")]
    ['left_ankle', 'left_foot']
    """
    found = [joint_number(joint) if isinstance(joint, str) else joint]
    for other in range(found[0] + 1, _JOINTS):
        if NEUTRAL_BODY.parents[other] in found:
            found.append(other)
    return tuple(found)


def joint_number(name: str) -> int:
    """Give the number of a joint from its name.

    Raises
    ------
    InputError
        If the body has no such joint; names the nearest that it has.
    """
    if name not in JOINT_NAMES:
        sides = [f"{side}_{name}" for side in ("left", "right") if f"{side}_{name}" in JOINT_NAMES]
        remedy = f"say {' or '.join(sides)}" if sides else nearest(name, JOINT_NAMES)
        if len(remedy) > 200:
            remedy = "name one of SMPL's 24 joints, such as right_elbow, left_knee or neck"
        raise InputError(f'the body has no joint "{name}"', remedy=remedy)
    return JOINT_NAMES.index(name)


def _by_joint(names: Sequence[str], numbers: float | Sequence[float], key: str) -> dict[int, float]:
    given = list(np.atleast_1d(np.asarray(numbers, dtype=np.float64)))
    if len(given) not in (1, len(names)):
        raise InputError(
            f"{len(given)} numbers for {len(names)} joints",
            where=key,
            remedy="give one, or one for each joint",
        )
    own: dict[int, float] = {}
    for name, number in zip(names, given * (len(names) // len(given)), strict=True):
        joint = joint_number(name)
        if joint in own and own[joint] != number:
            raise InputError(
                f"{name} is given both {own[joint]:g} and {number:g}", where=key, remedy="name it once"
            )
        own[joint] = float(number)
    return own


def _require(is_good: Any, what: str, values: Floats, remedy: str) -> None:
    if not np.all(is_good):
        joint = int(np.argmin(is_good))
        raise InputError(f"{what} of {values[joint]:g}", where=JOINT_NAMES[joint], remedy=remedy)
