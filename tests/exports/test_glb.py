"""The avatar, read back by a program for glTF and posed by glTF's rules, stands where the dance stands."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pygltflib
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from studykit.io.gltf import glb
from studykit.io.gltf_body import body_mesh
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY

Numbers = NDArray[Any]
TYPES = {5121: np.uint8, 5123: np.uint16, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Scene:
    """A file, posed at a time as the specification of glTF says (nothing here is studykit's)."""

    def __init__(self, data: bytes) -> None:
        self.gltf = pygltflib.GLTF2.load_from_bytes(data)
        self.blob = self.gltf.binary_blob()

    def place(self, number: int) -> tuple[int, Any, int, int]:
        accessor = self.gltf.accessors[number]
        view = self.gltf.bufferViews[accessor.bufferView]
        width = WIDTHS[accessor.type]
        return view.byteOffset, np.dtype(TYPES[accessor.componentType]), accessor.count, width

    def array(self, number: int) -> Numbers:
        start, kind, count, width = self.place(number)
        values = np.frombuffer(self.blob, dtype=kind, count=count * width, offset=start)
        return values.reshape((count, width) if width > 1 else (count,))

    def rewrite(self, number: int, values: Numbers) -> None:
        start, kind, *_ = self.place(number)
        data = values.astype(kind).tobytes()
        self.blob = self.blob[:start] + data + self.blob[start + len(data) :]

    def matrices(self, time_s: float) -> Numbers:
        """Give where each node stands in the world, shape (node, 4, 4)."""
        nodes = self.gltf.nodes
        local = np.tile(np.eye(4), (len(nodes), 1, 1))
        for number, node in enumerate(nodes):
            local[number, :3, 3] = node.translation or (0.0, 0.0, 0.0)
        (animation,) = self.gltf.animations
        for channel in animation.channels:
            sampler = animation.samplers[channel.sampler]
            assert sampler.interpolation == "LINEAR"
            times, values = self.array(sampler.input), self.array(sampler.output).astype(np.float64)
            if channel.target.path == "translation":
                local[channel.target.node, :3, 3] = [np.interp(time_s, times, axis) for axis in values.T]
            else:
                assert np.abs(np.linalg.norm(values, axis=1) - 1.0).max() < 1e-6
                after = int(np.clip(np.searchsorted(times, time_s), 1, len(times) - 1))
                two = slice(after - 1, after + 1)
                turn = Slerp(times[two].astype(np.float64), Rotation.from_quat(values[two]))
                local[channel.target.node, :3, :3] = turn(np.clip(time_s, *times[two])).as_matrix()
        world = np.array(local)

        def settle(number: int) -> None:
            for child in nodes[number].children or ():
                world[child] = world[number] @ local[child]
                settle(child)

        for root in self.gltf.scenes[self.gltf.scene].nodes:
            settle(root)
        return world

    def joint_places(self, time_s: float) -> dict[str, Numbers]:
        world = self.matrices(time_s)
        return {self.gltf.nodes[joint].name: world[joint, :3, 3] for joint in self.gltf.skins[0].joints}

    def skin(self, time_s: float) -> Numbers:
        """Give where the vertices are, shape (vertex, 3)."""
        attributes = self.gltf.meshes[0].primitives[0].attributes
        bind = self.array(self.gltf.skins[0].inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
        moved = self.matrices(time_s)[self.gltf.skins[0].joints] @ bind
        vertices = self.array(attributes.POSITION)
        points = np.concatenate((vertices, np.ones((len(vertices), 1))), axis=1)
        mixed = np.einsum(
            "vk,vkab->vab", self.array(attributes.WEIGHTS_0), moved[self.array(attributes.JOINTS_0)]
        )
        return np.einsum("vab,vb->va", mixed, points)[:, :3]


def furthest(scene: Scene, joints: Numbers) -> float:
    """Give how far any joint stands from where it should, at several times, m."""
    return max(
        float(np.linalg.norm(scene.joint_places(frame / 30.0)[name] - joints[frame, joint]))
        for frame in (0, 7, 8, 21, 59)
        for joint, name in enumerate(JOINT_NAMES)
    )


def test_the_joints_are_where_they_dance(motion: Motion, joints: Numbers) -> None:
    assert furthest(Scene(glb(motion)), joints) < 1e-5


WRONG = {
    "turned backwards": lambda turns: turns * (-1.0, -1.0, -1.0, 1.0),
    "scalar first": lambda turns: np.roll(turns, 1, axis=1),
    "a frame late": lambda turns: np.roll(turns, 1, axis=0),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_turns_would_be_noticed(motion: Motion, joints: Numbers, wrong: str) -> None:
    scene = Scene(glb(motion))
    for sampler in scene.gltf.animations[0].samplers[1:]:
        scene.rewrite(sampler.output, WRONG[wrong](scene.array(sampler.output)))
    assert furthest(scene, joints) > 0.05


def test_centimetres_would_be_noticed(motion: Motion, joints: Numbers) -> None:
    scene = Scene(glb(motion))
    for node in scene.gltf.nodes[:24]:
        node.translation = [100.0 * one for one in node.translation]
    assert furthest(scene, joints) > 1.0


def test_between_frames_a_joint_takes_the_short_way(motion: Motion) -> None:
    middle = replace(
        motion,
        rotations=rotation.slerp(motion.rotations[:-1], motion.rotations[1:], np.array(0.5)),
        root_positions=0.5 * (motion.root_positions[:-1] + motion.root_positions[1:]),
    )
    wanted = kinematics.joint_positions(middle)
    scene = Scene(glb(motion))
    for frame in (6, 7, 20, 58):
        places = scene.joint_places((frame + 0.5) / 30.0)
        assert np.array(list(places.values())) == pytest.approx(wanted[frame], abs=1e-5)
    # Readers may go straight from number to number: signs must not jump.
    for sampler in scene.gltf.animations[0].samplers[1:]:
        turns = scene.array(sampler.output)
        assert np.einsum("tc,tc->t", turns[1:], turns[:-1]).min() > 0.0


def test_the_skin_goes_with_the_joints(motion: Motion, joints: Numbers) -> None:
    """Each vertex is where its joints carry it: x_j + G_j (v - r_j), by weight."""
    body = body_mesh(NEUTRAL_BODY)
    still = replace(motion, rotations=rotation.identity(1, 24), root_positions=np.zeros((1, 3)))
    rest = kinematics.joint_positions(still)[0]
    world = kinematics.global_rotations(NEUTRAL_BODY, motion.rotations)
    scene = Scene(glb(motion))
    for frame in (0, 33):
        carried = joints[frame, body.joints] + rotation.rotate(
            world[frame, body.joints], body.vertices[:, None] - rest[body.joints]
        )
        wanted = (body.weights[..., None] * carried).sum(axis=1)
        assert scene.skin(frame / 30.0) == pytest.approx(wanted, abs=1e-5)
        assert np.abs(scene.skin(frame / 30.0) - body.vertices).max() > 0.1


def test_the_time_line_is_that_of_the_motion(motion: Motion) -> None:
    scene = Scene(glb(motion, name="intense-easy-on"))
    (animation,) = scene.gltf.animations
    assert animation.name == "intense-easy-on"
    assert {channel.target.path for channel in animation.channels} == {"rotation", "translation"}
    assert [c.target.node for c in animation.channels if c.target.path == "rotation"] == list(range(24))
    for sampler in animation.samplers:
        times = scene.array(sampler.input)
        assert times == pytest.approx(np.arange(60) / 30.0, abs=1e-6)
        assert scene.gltf.accessors[sampler.input].max == [float(times[-1])]


def test_the_file_says_what_it_is(motion: Motion) -> None:
    facts = {"condition": "a-b-on", "is_synthetic": True, "licences": ["CC BY 4.0 – é"], "sha256": "0" * 64}
    data = glb(motion, extras=facts)
    magic, container, length = struct.unpack("<4sII", data[:12])
    assert (magic, container, length) == (b"glTF", 2, len(data))
    assert length % 4 == 0
    asset = Scene(data).gltf.asset
    assert asset.version == "2.0"
    assert asset.generator.startswith("studykit ")
    assert asset.extras == facts
    assert data == glb(motion, extras=facts)
    assert [node.name for node in Scene(data).gltf.nodes] == [*JOINT_NAMES, "avatar"]


def test_it_stays_small(motion: Motion) -> None:
    long = replace(
        motion,
        rotations=np.tile(motion.rotations, (16, 1, 1)),
        root_positions=np.tile(motion.root_positions, (16, 1)),
    )
    assert long.duration_s == 32.0
    assert len(glb(long)) < 1_000_000


def materials(data: bytes) -> dict[str, tuple[float, ...]]:
    return {
        material.name: tuple(material.pbrMetallicRoughness.baseColorFactor)
        for material in Scene(data).gltf.materials
    }


def painted(data: bytes) -> dict[str, int]:
    """Give how many triangles each material covers."""
    gltf = Scene(data).gltf
    return {
        gltf.materials[part.material].name: gltf.accessors[part.indices].count // 3
        for part in gltf.meshes[0].primitives
    }


def test_the_sides_and_what_is_spared_have_colours_of_their_own(motion: Motion) -> None:
    plain, spared = glb(motion), glb(motion, spared=("right_elbow", "right_wrist", "head"))
    assert list(materials(plain)) == ["middle", "left", "right"]
    assert set(materials(spared)) == {"middle", "left", "right", "right spared", "middle spared"}
    colours = materials(spared)
    assert colours["right spared"] == colours["middle spared"]
    assert len(set(colours.values())) == 4
    assert all(0.0 <= channel <= 1.0 for colour in colours.values() for channel in colour)
    before, after = painted(plain), painted(spared)
    assert before["left"] == before["right"]
    assert after["left"] == before["left"]
    assert after["right"] + after["right spared"] == before["right"]
    with pytest.raises(ValueError, match="no joints of the body: elbow, tail"):
        glb(motion, spared=("tail", "elbow"))


def test_limbs_can_be_coloured_by_value(motion: Motion) -> None:
    values = np.arange(24.0)
    colours = materials(glb(motion, joint_values=values))
    assert set(colours) == set(JOINT_NAMES)
    light = np.array([colours[name][:3] for name in JOINT_NAMES]) @ (0.2126, 0.7152, 0.0722)
    assert np.all(np.diff(light) > 0.0)
    # A screen's #fde725 as light: ((253 / 255 + 0.055) / 1.055) ** 2.4 and so on.
    assert colours["right_hand"] == pytest.approx((0.982251, 0.799103, 0.018500, 1.0), abs=1e-5)
    assert len(set(materials(glb(motion, joint_values=np.zeros(24))).values())) == 1
    for wrong in (values[:-1], -values, values * np.nan):
        with pytest.raises(ValueError, match="joint_values must be 24 numbers of at least zero"):
            glb(motion, joint_values=wrong)


# --- the surface -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("skeleton", [NEUTRAL_BODY, AIST_BODY], ids=["neutral", "aist"])
def test_the_surface_is_closed_and_faces_outwards(skeleton: Any) -> None:
    body = body_mesh(skeleton)
    edges = np.concatenate([body.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert set(map(tuple, edges)) == {(b, a) for a, b in edges}
    corners = body.vertices[body.triangles]
    volume = float(np.linalg.det(corners).sum()) / 6.0
    # Tubes overlap where limbs meet; a person of 1.7 m and 70 kg has 0.07 m3.
    assert 0.045 < volume < 0.09
    assert np.linalg.norm(body.normals, axis=1) == pytest.approx(1.0)
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.einsum("tc,tc->t", outwards, body.normals[body.triangles].mean(axis=1)).min() > 0.0
    inside_out = np.linalg.det(corners[:, ::-1]).sum() / 6.0
    assert inside_out == pytest.approx(-volume)


def test_the_surface_is_of_a_person() -> None:
    body = body_mesh(NEUTRAL_BODY)
    width, height, depth = np.ptp(body.vertices, axis=0)
    assert 1.55 < height < 1.85
    assert 0.9 < width / height < 1.1  # arms out, a person is as wide as tall
    assert depth < 0.4
    assert body.weights.sum(axis=1) == pytest.approx(1.0)
    assert body.weights.min() >= 0.0
    used = set(body.joints[body.weights > 0.0])
    assert used == set(range(24))
    # Both joints of a vertex are neighbours in the body: no limb drags another along.
    parents = NEUTRAL_BODY.parents
    for one, other in np.unique(body.joints[body.weights.min(axis=1) > 0.0], axis=0):
        assert parents[one] == other or parents[other] == one
    sides = np.array([name.startswith("left") for name in JOINT_NAMES])
    assert body.vertices[sides[body.joints[:, 0]], 0].min() > -0.03


def test_at_rest_the_avatar_stands_on_the_floor(motion: Motion) -> None:
    data = glb(motion)
    size = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + size])
    assert [node["translation"] for node in document["nodes"][1:24]] == NEUTRAL_BODY.offsets[1:].tolist()
    assert document["nodes"][0]["translation"][1] == pytest.approx(
        -body_mesh(NEUTRAL_BODY).vertices[:, 1].min()
    )
