"""Dances around an arm that must be spared: calm arms of some segments on the bodies of others.

Section 8 of the paper names this as the way past its own limit, that a segment is danced whole or not at all.
An arm is taken from the collar down, so every joint keeps an angle that a person danced; what is new is how
arm and body go together, and that is what is judged here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from studykit.choreography.dance_library import DanceLibrary, Rows
from studykit.choreography.reduction import reduced
from studykit.core.arrays import Booleans, Floats, Integers
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_value
from studykit.core.seeding import stream
from studykit.motion import cleaning, energy, features, kinematics, rotation
from studykit.motion.joint_mask import JointMask, beyond
from studykit.motion.segmentation import FRAME_RATE_HZ
from studykit.motion.skeleton import NEUTRAL_BODY

if TYPE_CHECKING:
    from studykit.motion.clearance import Side

ROOM_M: Final = 0.02
"""A forearm keeps this far from the rest of the body, unless it came as near when it was danced."""
LEAN: Final = 0.5
"""How differently the trunks may lean: as a chord, 0.5 is 29 degrees, so that arms hang and reach alike."""
FREE_M: Final = 0.2
"""A hand that comes nearer to the floor carries the body or picks something up: such an arm stays."""

_SIDES: Final[tuple[Side, ...]] = ("left", "right")
_TOUCH_M: Final = 0.005  # two touches this much alike are the same touch
_TRIES: Final = 32
_BLOCK: Final = 128
_EVERY: Final = 4  # frames; arms and trunks are compared at 7.5 Hz
# What a donor may be off by, each as much as the others: where the arm goes, how the trunk leans, when the
# body moves, what is danced.
_PLACE_M: Final = 0.25
_OTHER_TIME: Final = 1.0  # of one minus the correlation
_OTHER_GENRE: Final = 0.5


def spliced(library: DanceLibrary, mask: JointMask, *, progress: Progress = silent) -> DanceLibrary:
    """Give the library with calm arms on the segments in which a spared arm breaks a limit.

    Parameters
    ----------
    library : DanceLibrary
        Whose segments; it is not changed.
    mask : JointMask
        What is spared, with limits: set them from this library (`JointMask.limited`), not from the result.
    progress : Progress
        Told of each block of segments.

    Returns
    -------
    DanceLibrary
        The same segments in the same order, in memory. Where an arm was replaced, all measures are those of
        the new movement, and the table says in `spliced_from` where the arm comes from (empty elsewhere).
        A segment for which no arm fits is left as it is. Scaler and calibration stay, so that light and
        intense, easy and hard mean the same.

    Raises
    ------
    InputError
        If the mask limits no joint of an arm. A leg carries the body and cannot be taken from elsewhere.
    """
    arms = {side: _arm(side) for side in _SIDES}
    limited = np.isfinite(mask.speed_limits_rad_s) | np.isfinite(mask.angle_limits_rad)
    sides = [side for side in _SIDES if limited[arms[side]].any()]
    if not sides:
        raise InputError(
            "the mask limits no joint of an arm, and only arms are taken from other segments",
            where="mask",
            remedy="spare a joint of an arm, or dance without splicing",
        )
    good = mask_keeps(library, mask)
    others = np.setdiff1d(np.arange(good.shape[1]), np.concatenate([arms[side] for side in sides]))
    hopeful = good[:, others].all(axis=1) & ~good.all(axis=1)
    blocks = _blocks(len(library))
    looks = [_look(library, rows) for rows in progress(blocks, label="Looking at arms", total=len(blocks))]
    look = {key: np.concatenate([one[key] for one in looks]) for key in looks[0]}
    splice = _Splice(
        library=library,
        donors={side: np.full(len(library), -1) for side in sides},
        turns_rad=np.zeros(len(library)),
    )
    for side in sides:
        calm, free = good[:, arms[side]].all(axis=1), look[f"{side} height"] >= FREE_M
        hosts, donors = np.flatnonzero(hopeful & free & ~calm), np.flatnonzero(calm & free)
        blocks = _blocks(len(hosts))
        for rows in progress(blocks, label=f"Trying {side} arms", total=len(blocks)):
            splice.donors[side][hosts[rows]] = _fitting(splice, look, hosts[rows], donors, side)
    # A segment that still breaks a limit is better left as it was danced.
    done = np.logical_and.reduce(
        [good[:, arms[side]].all(axis=1) | (splice.donors[side] >= 0) for side in sides]
    )
    for donors in splice.donors.values():
        donors[~done] = -1
    return _measured(splice, mask)


def mask_keeps(library: DanceLibrary, mask: JointMask) -> Booleans:
    """Tell which joints of which segments stay within the limits of a mask, shape (segment, 24)."""
    fast = library.peak_speeds > mask.speed_limits_rad_s
    return np.asarray(~(fast | (library.peak_angles > mask.angle_limits_rad)))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Splice:
    """What becomes of each segment: whose arms it gets, and how it turns to face ahead with them."""

    library: DanceLibrary
    donors: dict[Side, Integers]
    """Segments, one for each segment of the library; -1 where an arm stays."""
    turns_rad: Floats
    """About the vertical axis: new shoulders may face another way."""

    def is_new(self) -> Booleans:
        return np.asarray(np.any([donors >= 0 for donors in self.donors.values()], axis=0))

    def rotations(self, rows: Integers) -> Floats:
        values = np.array(self.library.rotations[rows], dtype=np.float64)
        for side, donors in self.donors.items():
            new = np.flatnonzero(donors[rows] >= 0)
            arm = _arm(side)
            values[np.ix_(new, np.arange(values.shape[1]), arm)] = np.asarray(
                self.library.rotations[donors[rows[new]]]
            )[:, :, arm]
        values[:, :, 0] = rotation.multiply(self._turns(rows), values[:, :, 0])
        return values

    def root_positions(self, rows: Integers) -> Floats:
        return rotation.rotate(self._turns(rows), np.asarray(self.library.root_positions[rows], np.float64))

    def positions(self, rows: Integers) -> Floats:
        return kinematics.centred_positions(NEUTRAL_BODY, self.rotations(rows))

    def features(self, rows: Integers) -> Floats:
        return np.array([features.pose_features(one, FRAME_RATE_HZ) for one in self.positions(rows)])

    def _turns(self, rows: Integers) -> Floats:
        return rotation.yaw(self.turns_rad[rows])[:, None]


def _arm(side: Side) -> Integers:
    return np.array(beyond(f"{side}_collar"))


def _blocks(count: int) -> list[Integers]:
    return [np.arange(start, min(start + _BLOCK, count)) for start in range(0, count, _BLOCK)]


def _look(library: DanceLibrary, rows: Integers) -> dict[str, Any]:
    """Describe segments as far as an arm's fit depends on it; vectors whose distances mean something."""
    from studykit.motion.clearance import clearance

    rotations = np.asarray(library.rotations[rows], dtype=np.float64)
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    world = kinematics.global_rotations(NEUTRAL_BODY, rotations[:, ::_EVERY])
    back = rotation.inverse(world[:, :, NEUTRAL_BODY.index("spine3")])
    told: dict[str, Any] = {"lean": rotation.rotate(back, np.array([0.0, 1.0, 0.0]))}
    for side in _SIDES:
        joints = [NEUTRAL_BODY.index(f"{side}_{name}") for name in ("elbow", "wrist")]
        collar = positions[:, ::_EVERY, NEUTRAL_BODY.index(f"{side}_collar")]
        reach = positions[:, ::_EVERY, joints] - collar[:, :, None]
        told[side] = rotation.rotate(back[:, :, None], reach)
        body = np.setdiff1d(np.arange(24), _arm(side))
        speeds = np.linalg.norm(np.diff(positions[:, :, body], axis=1), axis=-1).mean(axis=-1)
        pulse = speeds[:, : speeds.shape[1] // _EVERY * _EVERY].reshape(len(rows), -1, _EVERY).mean(axis=-1)
        pulse -= pulse.mean(axis=1, keepdims=True)
        norm = np.linalg.norm(pulse, axis=1, keepdims=True)
        told[f"{side} pulse"] = pulse / np.maximum(norm, 1e-9)
        told[f"{side} room"] = clearance(positions, side).astype(np.float32)
        told[f"{side} height"] = _height(positions, library.root_positions[rows], side)
    samples = np.sqrt(told["lean"].shape[1])
    for key, value in told.items():
        if "room" not in key and "height" not in key:
            flat = value.reshape(len(rows), -1).astype(np.float32)
            told[key] = flat if "pulse" in key else flat / (samples * np.sqrt(value[0, 0].size / 3))
    return told


def _fitting(
    splice: _Splice, look: dict[str, Any], hosts: Integers, donors: Integers, side: Side
) -> Integers:
    """Find the donor for each host that fits best and is plausible; -1 where none of the best is."""
    found = np.full(len(hosts), -1)
    if not len(donors) or not len(hosts):
        return found
    leans = _apart(look["lean"][hosts], look["lean"][donors])
    genres = splice.library.segments["genre"].to_numpy()
    cost = _apart(look[side][hosts], look[side][donors]) / _PLACE_M + leans / LEAN
    cost += _OTHER_TIME * (1.0 - look[f"{side} pulse"][hosts] @ look[f"{side} pulse"][donors].T)
    cost += _OTHER_GENRE * (genres[hosts][:, None] != genres[donors])
    cost = np.where(leans <= LEAN, cost, np.inf)
    order = np.argsort(cost, axis=1, kind="stable")[:, :_TRIES]
    for place in range(order.shape[1]):
        picks = order[:, place]
        trying = np.flatnonzero((found < 0) & np.isfinite(cost[np.arange(len(hosts)), picks]))
        if not len(trying):
            break
        splice.donors[side][hosts[trying]] = donors[picks[trying]]
        fits = _is_plausible(splice, look, hosts[trying], side)
        found[trying[fits]] = donors[picks[trying[fits]]]
    splice.donors[side][hosts] = -1
    return found


def _apart(first: Any, second: Any) -> Any:
    squares = (first**2).sum(axis=1)[:, None] + (second**2).sum(axis=1) - 2.0 * first @ second.T
    return np.sqrt(np.maximum(squares, 0.0))


def _is_plausible(splice: _Splice, look: dict[str, Any], hosts: Integers, side: Side) -> Booleans:
    """Tell which segments have room for their new arm, down to the floor, and nothing a take is cut for."""
    from studykit.motion.clearance import clearance

    positions = splice.positions(hosts)
    danced = look[f"{side} room"][splice.donors[side][hosts]] - _TOUCH_M
    roomy = np.all(clearance(positions, side) >= np.minimum(ROOM_M, danced), axis=1)
    still = np.zeros((positions.shape[1], 3))
    clean = [
        not cleaning.flagged(cleaning.excesses(one, still, FRAME_RATE_HZ), "robust").any()
        for one in positions
    ]
    high = _height(positions, splice.root_positions(hosts), side) >= FREE_M
    return np.asarray(roomy & high & np.array(clean))


def _height(positions: Floats, root_positions: Floats, side: Side) -> Floats:
    """Give how near a hand comes to the floor, shape (segment,), m."""
    hand = positions[:, :, NEUTRAL_BODY.index(f"{side}_hand"), 1]
    return np.asarray((hand + root_positions[..., 1]).min(axis=1))


class _Changed:
    """Rows of a library of which some are made anew when they are read."""

    def __init__(self, rows: Rows, is_new: Booleans, made: Callable[[Integers], Any]) -> None:
        self._rows, self._is_new, self._made = rows, is_new, made
        self.shape = rows.shape

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: Any, /) -> Any:
        numbers = np.arange(len(self))[rows if isinstance(rows, slice) else np.asarray(rows, dtype=np.int64)]
        wanted = np.atleast_1d(numbers)
        values = np.array(self._rows[wanted])
        new = self._is_new[wanted]
        if new.any():
            values[new] = self._made(wanted[new])
        return values if np.ndim(numbers) else values[0]


def _measured(splice: _Splice, mask: JointMask) -> DanceLibrary:
    """Make the library of what was spliced."""
    from studykit.choreography.neighbours import successors

    library, is_new = splice.library, splice.is_new()
    arrays: dict[str, Any] = _arrays(splice)
    made = replace(
        library,
        segments=library.segments.assign(
            linear_energy=arrays["linear_energies"].sum(axis=1),
            rotational_energy=arrays["rotational_energies"].sum(axis=1),
            spliced_from=_told(splice),
            licence=_licences(splice),
        ),
        rotations=_Changed(library.rotations, is_new, splice.rotations),
        root_positions=_Changed(library.root_positions, is_new, splice.root_positions),
        features=_Changed(library.features, is_new, splice.features),
        successors=successors(arrays["first_poses"], arrays["last_poses"]),
        sha256=sha256_of_value(
            [library.sha256, mask.to_dict(), {side: rows.tolist() for side, rows in splice.donors.items()}]
        ),
        **arrays,
    )
    return made if library.reduced is None else replace(made, reduced=reduced(made, stream(0, "axes")))


def _arrays(splice: _Splice) -> dict[str, Floats]:
    """Measure the new segments, and turn them ahead."""
    own = ("peak_speeds", "peak_angles", "rotational_energies")
    arrays = {
        name: np.array(getattr(splice.library, name))
        for name in (*own, "linear_energies", "first_poses", "last_poses")
    }
    for side, donors in splice.donors.items():
        # These know a joint's own turns alone, so they come with the arm.
        new, arm = np.flatnonzero(donors >= 0), _arm(side)
        for name in own:
            arrays[name][np.ix_(new, arm)] = getattr(splice.library, name)[np.ix_(donors[new], arm)]
    every = np.flatnonzero(splice.is_new())
    for rows in (every[block] for block in _blocks(len(every))):
        positions = splice.positions(rows)
        splice.turns_rad[rows] = -kinematics.facing(positions[:, 0])
        arrays["linear_energies"][rows] = [energy.linear_energy(one, FRAME_RATE_HZ) for one in positions]
        arrays["first_poses"][rows] = kinematics.facing_ahead(positions[:, 0])
        arrays["last_poses"][rows] = kinematics.facing_ahead(positions[:, -1])
    return arrays


def _licences(splice: _Splice) -> list[str]:
    """Give the licences that every segment is under: its own and those of its arms."""
    own = splice.library.segments["licence"].to_numpy()
    under = [[licence] for licence in own]
    for donors in splice.donors.values():
        for row in np.flatnonzero(donors >= 0):
            under[row].append(own[donors[row]])
    return ["; ".join(dict.fromkeys(licences)) for licences in under]


def _told(splice: _Splice) -> list[str]:
    """Say where the arms of every segment come from."""
    takes, starts_s, mirrored = (
        splice.library.segments[name].to_numpy() for name in ("take", "start_s", "mirrored")
    )
    words: list[list[str]] = [[] for _ in takes]
    for side, donors in splice.donors.items():
        for row in np.flatnonzero(donors >= 0):
            donor = donors[row]
            image = ", mirrored" if mirrored[donor] else ""
            words[row].append(f"{side} arm: {takes[donor]} at {starts_s[donor]:.2f} s{image}")
    return ["; ".join(word) for word in words]
