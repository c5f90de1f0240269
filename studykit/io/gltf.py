"""Binary glTF 2.0 (.glb): a dancing avatar for Blender, game engines and browsers."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studykit.core.arrays import Floats
from studykit.io.gltf_body import BodyMesh, body_mesh
from studykit.motion.motion import Motion
from studykit.motion.skeleton import Skeleton

_FLOAT, _BYTE, _SHORT = 5126, 5121, 5123
_KINDS = {np.dtype(np.float32): _FLOAT, np.dtype(np.uint8): _BYTE, np.dtype(np.uint16): _SHORT}
_SHAPES = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_VERTICES, _INDICES = 34962, 34963

# Okabe and Ito's colours, which every common kind of colour vision tells apart.
_COLOURS = {"left": 0x0072B2, "right": 0xE69F00, "middle": 0x9A9A9A, "spared": 0xCC79A7}
# Viridis without its darkest part, from the lowest value to the highest.
_SCALE = (0x3B528B, 0x2C728E, 0x21918C, 0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725)


@dataclass(slots=True)
class _Buffer:
    """The bytes of a file as they come together, and what says how to read them."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, values: NDArray[Any], *, target: int | None = None, has_range: bool = False) -> int:
        """Append an array; gives the number of its accessor."""
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.views.append(view | ({} if target is None else {"target": target}))
        accessor = {
            "bufferView": len(self.views) - 1,
            "componentType": _KINDS[values.dtype],
            "count": len(values),
            "type": _SHAPES[values.shape[1:]],
        }
        if has_range:
            accessor |= {
                name: np.atleast_1d(limit).tolist()
                for name, limit in (("min", values.min(axis=0)), ("max", values.max(axis=0)))
            }
        self.accessors.append(accessor)
        self.data += values.astype(values.dtype.newbyteorder("<")).tobytes()
        self.data += bytes(-len(self.data) % 4)
        return len(self.accessors) - 1


def glb(
    motion: Motion,
    *,
    name: str = "dance",
    spared: Sequence[str] = (),
    joint_values: Sequence[float] | Floats | None = None,
    extras: Mapping[str, Any] | None = None,
) -> bytes:
    """Write a motion as binary glTF: an avatar with a skin, its 24 joints and one animation.

    Parameters
    ----------
    motion : Motion
        A movement of SMPL's 24 joints; glTF's axes are the same (metres, Y up, facing +Z).
    name : str
        Name of the animation and of the scene.
    spared : sequence of str
        Joints whose limbs have a colour of their own; the others are coloured by side.
    joint_values : array_like, shape (24,), optional
        Colour each limb by the value of the joint that moves it, from dark (zero) to light (the largest),
        instead of by side (the paper's Fig. 1).
    extras : mapping, optional
        Facts to keep in the file, under `asset.extras`.

    Returns
    -------
    bytes
        The same for equal arguments.

    Raises
    ------
    ValueError
        If a spared joint is none of the body's, or there is not one value of at least zero for each joint.
    """
    skeleton = motion.skeleton
    body = body_mesh(skeleton)
    buffer = _Buffer()
    primitives, materials = _surface(body, _paint(skeleton, spared, joint_values), buffer)
    joints = len(skeleton.joint_names)
    standing = np.array([0.0, -body.vertices[:, 1].min(), 0.0])
    document = {
        "asset": {
            "version": "2.0",
            "generator": f"studykit {version('studykit')}",
            "extras": dict(extras or {}),
        },
        "scene": 0,
        "scenes": [{"name": name, "nodes": [0, joints]}],
        "nodes": [*_joint_nodes(skeleton, standing), {"name": "avatar", "mesh": 0, "skin": 0}],
        "meshes": [{"name": "avatar", "primitives": primitives}],
        "materials": materials,
        "skins": [
            {
                "name": "body",
                "joints": list(range(joints)),
                "skeleton": 0,
                "inverseBindMatrices": buffer.add(_inverse_bind_matrices(skeleton)),
            }
        ],
        "animations": [_animation(motion, name, buffer)],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    return _binary(document, bytes(buffer.data))


def _joint_nodes(skeleton: Skeleton, root: Floats) -> list[dict[str, Any]]:
    nodes: list[dict[str, Any]] = []
    for joint, name in enumerate(skeleton.joint_names):
        place = skeleton.offsets[joint] if joint else root
        children = skeleton.children(joint)
        nodes.append(
            {"name": name, "translation": place.tolist()} | ({"children": children} if children else {})
        )
    return nodes


def _inverse_bind_matrices(skeleton: Skeleton) -> NDArray[np.float32]:
    """Give, for each joint, what leads from the resting body to the joint, column by column as glTF has it.

    The vertices stand about the pelvis, wherever the root is: a node's own place is not that of the mesh.
    """
    matrices = np.tile(np.eye(4), (len(skeleton.joint_names), 1, 1))
    for joint, parent in enumerate(skeleton.parents[1:], start=1):
        matrices[joint, 3, :3] = matrices[parent, 3, :3] - skeleton.offsets[joint]
    return matrices.astype(np.float32)


def _animation(motion: Motion, name: str, buffer: _Buffer) -> dict[str, Any]:
    """Write the turns of all joints and the way of the root."""
    steps = np.einsum("tjc,tjc->tj", motion.rotations[:-1], motion.rotations[1:])
    signs = np.cumprod(np.where(steps < 0.0, -1.0, 1.0), axis=0)
    turns = np.array(motion.rotations)
    turns[1:] *= signs[..., None]  # q and -q are one turn; a reader that goes between them needs the nearer
    scalar_last = np.roll(turns, -1, axis=-1).astype(np.float32)
    times = buffer.add((np.arange(len(motion)) / motion.frame_rate_hz).astype(np.float32), has_range=True)
    outputs = [(0, "translation", buffer.add(motion.root_positions.astype(np.float32)))]
    outputs += [
        (joint, "rotation", buffer.add(np.ascontiguousarray(scalar_last[:, joint])))
        for joint in range(len(motion.skeleton.joint_names))
    ]
    return {
        "name": name,
        "samplers": [
            {"input": times, "output": output, "interpolation": "LINEAR"} for _, _, output in outputs
        ],
        "channels": [
            {"sampler": number, "target": {"node": node, "path": path}}
            for number, (node, path, _) in enumerate(outputs)
        ],
    }


def _paint(
    skeleton: Skeleton, spared: Sequence[str], joint_values: Sequence[float] | Floats | None
) -> list[tuple[str, int]]:
    """Give the name and the colour of the material of each joint's limb."""
    names = skeleton.joint_names
    if strangers := sorted(set(spared) - set(names)):
        raise ValueError(f"no joints of the body: {', '.join(strangers)}")
    if joint_values is not None:
        values = np.asarray(joint_values, dtype=np.float64)
        if values.shape != (len(names),) or not np.all((values >= 0.0) & np.isfinite(values)):
            raise ValueError(f"joint_values must be {len(names)} numbers of at least zero")
        shares = values / max(float(values.max()), np.finfo(np.float64).tiny)
        return [(name, _shade(share)) for name, share in zip(names, shares, strict=True)]
    sides = [name.split("_")[0] if "_" in name else "middle" for name in names]
    kinds = [f"{side} spared" if name in spared else side for name, side in zip(names, sides, strict=True)]
    return [(kind, _COLOURS[kind.rsplit(" ", maxsplit=1)[-1]]) for kind in kinds]


def _shade(share: float) -> int:
    """Give the colour of a share from 0 to 1."""
    channels = np.array([[colour >> shift & 255 for shift in (16, 8, 0)] for colour in _SCALE])
    places = np.linspace(0.0, 1.0, len(_SCALE))
    red, green, blue = (round(float(np.interp(share, places, channel))) for channel in channels.T)
    return red << 16 | green << 8 | blue


def _linear(colour: int) -> list[float]:
    """Give a screen's colour (sRGB) as the light it stands for (IEC 61966-2-1), which glTF counts in."""
    shares = np.array([colour >> shift & 255 for shift in (16, 8, 0)]) / 255.0
    light = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return [*light.round(6).tolist(), 1.0]


def _surface(
    body: BodyMesh, paint: list[tuple[str, int]], buffer: _Buffer
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Write the surface; give its parts, one for each material, and the materials."""
    attributes = {
        "POSITION": buffer.add(body.vertices.astype(np.float32), target=_VERTICES, has_range=True),
        "NORMAL": buffer.add(body.normals.astype(np.float32), target=_VERTICES),
        "JOINTS_0": buffer.add(
            np.pad(np.where(body.weights > 0.0, body.joints, 0), ((0, 0), (0, 2))).astype(np.uint8),
            target=_VERTICES,
        ),
        "WEIGHTS_0": buffer.add(np.pad(body.weights, ((0, 0), (0, 2))).astype(np.float32), target=_VERTICES),
    }
    primitives: list[dict[str, Any]] = []
    materials: list[dict[str, Any]] = []
    for kind in dict.fromkeys(paint):
        joints = [joint for joint, own in enumerate(paint) if own == kind]
        triangles = body.triangles[np.isin(body.triangle_joints, joints)]
        indices = buffer.add(triangles.reshape(-1).astype(np.uint16), target=_INDICES)
        primitives.append({"attributes": attributes, "indices": indices, "material": len(materials)})
        name, colour = kind
        surface = {"baseColorFactor": _linear(colour), "metallicFactor": 0.0, "roughnessFactor": 0.7}
        materials.append({"name": name, "pbrMetallicRoughness": surface})
    return primitives, materials


def _binary(document: dict[str, Any], data: bytes) -> bytes:
    """Put JSON and bytes into one file: a header and two chunks, each filled up to a multiple of four."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    chunks = b"".join(
        struct.pack("<I4s", len(chunk), kind) + chunk
        for kind, chunk in ((b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", data))
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
