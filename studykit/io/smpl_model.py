"""A body model of your own: joints of any shape, and the skin, from SMPL's official file.

The file is not part of studykit and may not be passed on: get it from its authors under their licence. Joints
need nothing else; the skin needs the packages smplx and torch, which are imported here and nowhere else.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.io.array_files import read_npz
from studykit.io.packed import PACKED
from studykit.io.restricted_pickle import read_pickle
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, Skeleton

MOST_BETAS = 10
"""How many numbers say what shape a body has; the official files have directions for no less."""

_ARRAYS = ("v_template", "shapedirs", "posedirs", "J_regressor", "weights", "kintree_table", "f")
_MOST_VERTICES = 50_000
_JOINTS = 24
_LARGEST_BYTES = 2**29
_FRAMES_AT_ONCE = 64
_INSTALL = "pip install torch smplx"


class Mesh(NamedTuple):
    """The skin of a moving body.

    Attributes
    ----------
    vertices : ndarray, shape (frame, vertex, 3), m
        Where the points of the skin are, Y up.
    faces : ndarray, shape (face, 3)
        Which three points make each triangle.
    """

    vertices: Floats
    faces: Integers


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BodyModel:
    """SMPL's statistical body; see `read_body_model`.

    Parameters
    ----------
    template : ndarray, shape (vertex, 3), m
        The skin of the mean shape in the rest pose.
    shape_directions : ndarray, shape (vertex, 3, beta), m
        How the skin changes with each number of shape.
    pose_directions : ndarray, shape (vertex, 3, 207), m
        How the skin bulges with the pose.
    joint_regressor : ndarray, shape (24, vertex)
        Of which points of the skin each joint is the mean.
    weights : ndarray, shape (vertex, 24)
        How far each point of the skin goes with each joint.
    faces : ndarray, shape (face, 3)
        Which three points make each triangle.
    path : Path
        The file.
    """

    template: Floats
    shape_directions: Floats
    pose_directions: Floats
    joint_regressor: Floats
    weights: Floats
    faces: Integers
    path: Path

    def rest_joints(self, *, betas: ArrayLike = ()) -> Floats:
        """Give where the model itself puts the joints of a body of that shape, shape (24, 3), m."""
        shape = self._betas(betas)
        skin = self.template + self.shape_directions[..., : len(shape)] @ shape
        return np.asarray(self.joint_regressor @ skin)

    def skeleton(self, *, betas: ArrayLike = ()) -> Skeleton:
        """Give the 24 joints of a body of that shape (the mean shape if none is given)."""
        joints = self.rest_joints(betas=betas)
        parents = np.array(NEUTRAL_BODY.parents[1:])
        offsets = np.zeros((_JOINTS, 3))
        offsets[1:] = joints[1:] - joints[parents]
        return replace(NEUTRAL_BODY, offsets=offsets)

    def pelvis(self, *, betas: ArrayLike = ()) -> Floats:
        """Give where the model itself puts the pelvis, shape (3,), m; SMPL's translations add to this."""
        return np.asarray(self.rest_joints(betas=betas)[0])

    def mesh(self, motion: Motion, *, betas: ArrayLike = ()) -> Mesh:
        """Give the skin of a movement, its pelvis where the movement has it.

        Raises
        ------
        InputError
            If smplx or torch is not installed, or the movement is not of SMPL's joints.
        """
        try:
            import smplx
            import torch
        except ImportError as error:
            remedy = f"install them with '{_INSTALL}'; the README says how to get a small torch"
            raise InputError(
                "the skin of a body needs the packages smplx and torch", remedy=remedy
            ) from error
        if motion.skeleton.joint_names != NEUTRAL_BODY.joint_names:
            raise InputError("the movement is not of SMPL's 24 joints", remedy="carry it over to SMPL first")
        shape = np.zeros(MOST_BETAS)
        given = self._betas(betas)
        shape[: len(given)] = given
        vectors = rotation.log(motion.rotations)
        places = motion.root_positions - self.pelvis(betas=betas)
        vertices = np.empty((len(motion), len(self.template), 3))
        with redirect_stdout(StringIO()):  # it prints how many numbers a shape has
            model = smplx.SMPL("", data_struct=smplx.utils.Struct(**self._struct()), dtype=torch.float64)
        for start in range(0, len(motion), _FRAMES_AT_ONCE):
            part = slice(start, start + _FRAMES_AT_ONCE)
            frames = len(vectors[part])
            with torch.no_grad():
                posed = model(
                    betas=torch.tensor(np.tile(shape, (frames, 1))),
                    global_orient=torch.tensor(vectors[part, 0]),
                    body_pose=torch.tensor(vectors[part, 1:].reshape(frames, -1)),
                    transl=torch.tensor(places[part]),
                )
            vertices[part] = posed.vertices.numpy()
        return Mesh(vertices, self.faces)

    def _betas(self, betas: ArrayLike) -> Floats:
        shape = np.asarray(betas, dtype=np.float64)
        most = min(MOST_BETAS, self.shape_directions.shape[2])
        if shape.ndim != 1 or len(shape) > most or not np.all(np.isfinite(shape)):
            raise InputError(
                f"betas are not up to {most} finite numbers", where=self.path, remedy="give a list of numbers"
            )
        return shape

    def _struct(self) -> dict[str, Any]:
        directions = np.zeros((len(self.template), 3, MOST_BETAS))
        there = self.shape_directions[..., :MOST_BETAS]
        directions[..., : there.shape[2]] = there
        return {
            "v_template": self.template,
            "shapedirs": directions,
            "posedirs": self.pose_directions,
            "J_regressor": self.joint_regressor,
            "weights": self.weights,
            "kintree_table": np.array([NEUTRAL_BODY.parents, range(_JOINTS)], dtype=np.int64),
            "f": self.faces,
        }


def read_body_model(path: str | Path) -> BodyModel:
    """Read SMPL's body model: the official pickle as it is, or an .npz of the same arrays.

    The pickle is not unpickled: nothing in it is run, and neither chumpy nor Python 2 is needed.

    Raises
    ------
    InputError
        If it cannot be read, would run code, lacks an array, or an array has another shape than SMPL's.
    """
    path = Path(path)
    endings = [ending for ending in path.suffixes if ending not in PACKED]
    is_archive = bool(endings) and endings[-1] == ".npz"
    values = read_npz(path, _ARRAYS) if is_archive else read_pickle(path, largest_bytes=_LARGEST_BYTES)
    if not isinstance(values, dict):
        raise InputError("holds no table of named arrays", where=path, remedy="name SMPL's own model file")
    missing = [name for name in _ARRAYS if not isinstance(values.get(name), np.ndarray)]
    if missing:
        problem = f"has no array {missing[0]}"
        raise InputError(problem, where=path, remedy="name SMPL's own model file, not SMPL-H's or SMPL-X's")
    vertices = len(values["v_template"]) if values["v_template"].ndim else 0
    if not 0 < vertices <= _MOST_VERTICES:
        raise InputError(f"v_template has {vertices} points", where=path, remedy="name SMPL's own model file")
    _check_parents(values["kintree_table"], path)
    model = BodyModel(
        template=_checked(values, "v_template", (vertices, 3), path),
        shape_directions=_checked(values, "shapedirs", (vertices, 3, None), path)[..., :MOST_BETAS],
        pose_directions=_checked(values, "posedirs", (vertices, 3, 9 * (_JOINTS - 1)), path),
        joint_regressor=_checked(values, "J_regressor", (_JOINTS, vertices), path),
        weights=_checked(values, "weights", (vertices, _JOINTS), path),
        faces=_faces(values, vertices, path),
        path=path,
    )
    with np.errstate(over="ignore", invalid="ignore"):  # what is no number is not close to 1
        sums = np.abs(model.joint_regressor.sum(axis=1) - 1.0)
    if not np.all(sums <= 0.01):
        problem = (
            f"J_regressor does not add up to 1 for {NEUTRAL_BODY.joint_names[int(np.argmin(sums <= 0.01))]}"
        )
        raise InputError(problem, where=path, remedy="copy the file again")
    return model


def _checked(values: dict[str, Any], name: str, shape: tuple[int | None, ...], path: Path) -> Floats:
    array = values[name]
    fits = array.ndim == len(shape) and all(w in (None, h) for h, w in zip(array.shape, shape, strict=True))
    if array.dtype.kind not in "iuf" or not fits or array.size == 0:
        wanted = ", ".join("any" if length is None else str(length) for length in shape)
        problem = f"{name} has the shape {array.shape} of {array.dtype}, expected numbers ({wanted})"
        raise InputError(problem, where=path, remedy="name SMPL's own model file")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name} has numbers that are not finite", where=path, remedy="copy the file again")
    return np.array(array, dtype=np.float64)


def _faces(values: dict[str, Any], vertices: int, path: Path) -> Integers:
    """Give the points of each triangle, which a file may have as any kind of number."""
    faces = _checked(values, "f", (None, 3), path)
    if faces.min() < 0 or faces.max() >= vertices or np.any(faces % 1.0):
        raise InputError("f names points that are not there", where=path, remedy="copy the file again")
    return faces.astype(np.int64)


def _check_parents(table: Any, path: Path) -> None:
    """Check that the joints hang together as SMPL's do; the root's parent is -1 in one way or another."""
    fits = table.shape == (2, _JOINTS) and table.dtype.kind in "iu"
    if not fits or tuple(int(parent) for parent in table[0, 1:]) != NEUTRAL_BODY.parents[1:]:
        problem = "its joints do not hang together as SMPL's 24 do (kintree_table)"
        raise InputError(problem, where=path, remedy="name SMPL's own model file, not SMPL-H's or SMPL-X's")
