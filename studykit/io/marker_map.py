"""Which markers on a dancer's skin tell where SMPL's joints are."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, field_validator

from studykit.core.arrays import Floats
from studykit.core.errors import InputError
from studykit.io.marker_table import MarkerTable
from studykit.io.toml_file import read_model
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY, Skeleton

NEEDED = (
    *(f"{side}_{part}" for part in ("hip", "knee", "ankle", "foot") for side in ("left", "right")),
    *(f"{side}_{part}" for part in ("shoulder", "elbow", "wrist") for side in ("left", "right")),
    "head",
)
PLACED = ("spine1", "spine3", "left_collar", "right_collar")
"""Joints that no marker tells; they are put between those that do."""
_HEAD_OVER_NECK = np.array([0.0, 0.2, 0.03])
# m; markers are round the skull, not at its joint.


class MarkerMap(BaseModel):
    """The markers whose mean is a joint.

    A map of your own is a TOML file beside the recipe that names it (``skeleton = "mine.toml"``). It names
    hips, knees, ankles, feet (the toes), shoulders, elbows and wrists of both sides and the head; it may name
    the pelvis (else between the hips), the neck (else between the shoulders), spine2 (mid torso) and hands.

    Examples
    --------
    The beginning of one::

        [joints]
        left_hip = ["LASI", "LPSI"]
        right_hip = ["RASI", "RPSI"]
        left_knee = ["LKNE"]
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    joints: dict[str, tuple[str, ...]]
    """SMPL's joint to markers."""

    @property
    def markers(self) -> frozenset[str]:
        """Name the markers that tell a joint."""
        return frozenset(one for markers in self.joints.values() for one in markers)

    @field_validator("joints")
    @classmethod
    def _are_joints(cls, joints: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
        for name, markers in joints.items():
            if name not in JOINT_NAMES or name in PLACED or not markers:
                allowed = ", ".join(joint for joint in JOINT_NAMES if joint not in PLACED)
                raise InputError(
                    f"no joint {name!r} with markers", where=name, remedy=f"name markers of {allowed}"
                )
        lacking = [name for name in NEEDED if name not in joints]
        if lacking:
            raise InputError(
                f"no markers for {lacking[0]}", remedy=f"name some for each of {', '.join(NEEDED)}"
            )
        return joints


def marker_names() -> tuple[str, ...]:
    """Name the sets of markers that studykit knows by itself."""
    return tuple(sorted(path.stem for path in Path(str(files("studykit.io") / "markers")).glob("*.toml")))


def marker_map(name: str) -> MarkerMap:
    """Give a map of markers by its name, or from a TOML file.

    Raises
    ------
    InputError
        If there is no such map or the file has a mistake; names the line and the remedy.
    """
    if name.endswith(".toml"):
        return read_model(Path(name), MarkerMap)
    if name not in marker_names():
        raise InputError(
            f"no set of markers called {name!r}",
            where="skeleton",
            remedy=f"choose {', '.join(marker_names())}, or name a map file that ends in .toml",
        )
    return read_model(Path(str(files("studykit.io") / "markers" / f"{name}.toml")), MarkerMap)


def joints_of(table: MarkerTable, chosen: MarkerMap, path: Path) -> tuple[Floats, Skeleton]:
    """Give where SMPL's joints are, and the body of the dancer, in the table's unit.

    Returns
    -------
    tuple of ndarray, shape (frame, 24, 3), and Skeleton
        The bones of the body are as long as they are seen in the median; between what is seen its joints lie
        where they are put in every frame, so that at rest it stands like SMPL.

    Raises
    ------
    InputError
        If the table lacks a marker of the map.
    """
    lacking = sorted(chosen.markers - set(table.names))
    if lacking:
        remedy = f"choose the set of markers that fits ({', '.join(marker_names())}) or write a map file"
        raise InputError(f"has no marker {lacking[0]!r}", where=path, remedy=remedy)
    seen = {
        joint: np.mean(table.positions[:, [table.names.index(one) for one in markers]], axis=1)
        for joint, markers in chosen.joints.items()
    }
    positions = _completed(seen)
    places = _at_rest(dict(zip(JOINT_NAMES, np.moveaxis(positions, 1, 0), strict=True)))
    parents = np.maximum(np.array(NEUTRAL_BODY.parents), 0)
    body = Skeleton(
        joint_names=JOINT_NAMES,
        parents=NEUTRAL_BODY.parents,
        offsets=places - places[parents],
        mirror=NEUTRAL_BODY.mirror,
    )
    return positions, body


_TREE = (
    ("pelvis", "spine2"),
    ("spine2", "neck"),
    ("neck", "head"),
    *(
        (above if above in ("pelvis", "neck") else f"{side}_{above}", f"{side}_{joint}")
        for side in ("left", "right")
        for above, joint in (
            ("pelvis", "hip"),
            ("hip", "knee"),
            ("knee", "ankle"),
            ("ankle", "foot"),
            ("neck", "shoulder"),
            ("shoulder", "elbow"),
            ("elbow", "wrist"),
            ("wrist", "hand"),
        )
    ),
)


def _at_rest(seen: dict[str, Floats]) -> Floats:
    """Put a body with the lengths that were seen into SMPL's rest pose, shape (24, 3)."""
    rest = kinematics.centred_positions(NEUTRAL_BODY, rotation.identity(24))
    like = dict(zip(JOINT_NAMES, rest, strict=True))
    like["pelvis"] = (like["left_hip"] + like["right_hip"]) / 2.0
    like["neck"] = (like["left_shoulder"] + like["right_shoulder"]) / 2.0
    like["head"] = like["neck"] + _HEAD_OVER_NECK
    at = {"pelvis": np.zeros(3)}
    for above, joint in _TREE:
        way = like[joint] - like[above]
        length = np.median(np.linalg.norm(seen[joint] - seen[above], axis=-1))
        at[joint] = at[above] + way / np.linalg.norm(way) * length
    return _completed(at)


def _completed(seen: dict[str, Floats]) -> Floats:
    """Put the joints between those that were seen, shape (..., 24, 3)."""
    at = dict(seen)
    at.setdefault("pelvis", (at["left_hip"] + at["right_hip"]) / 2.0)
    at.setdefault("neck", (at["left_shoulder"] + at["right_shoulder"]) / 2.0)
    at.setdefault("spine2", at["pelvis"] + 0.5 * (at["neck"] - at["pelvis"]))
    at["spine1"] = (at["pelvis"] + at["spine2"]) / 2.0
    at["spine3"] = at["spine2"] + 0.2 * (at["neck"] - at["spine2"])
    for side in ("left", "right"):
        at[f"{side}_collar"] = (at["neck"] + at[f"{side}_shoulder"]) / 2.0
        along = at[f"{side}_wrist"] - at[f"{side}_elbow"]
        at.setdefault(f"{side}_hand", at[f"{side}_wrist"] + along / 3.0)
    return np.stack([at[name] for name in JOINT_NAMES], axis=-2)
