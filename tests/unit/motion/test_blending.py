"""Segments are joined without a jump, without a frame more or less, and nothing else is touched."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import blending, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

FRAMES = 60
ELBOW = NEUTRAL_BODY.index("left_elbow")


def dancing(seed: int, frames: int = FRAMES, *, gap: float = 0.5) -> Motion:
    """Give a smooth segment that walks and turns, with poses of its own."""
    rng = np.random.default_rng(seed)
    phase = np.arange(frames)[:, None, None] / 30.0
    turns = rng.normal(scale=gap, size=(1, 24, 3)) + rng.normal(scale=0.3, size=(1, 24, 3)) * np.sin(
        2.0 * phase + rng.uniform(0.0, 6.0, size=(1, 24, 3))
    )
    rotations = rotation.exp(turns)
    # Upright, and turning to one side.
    rotations[:, 0] = rotation.yaw(rng.uniform(-3.0, 3.0) + 0.5 * rng.normal() * phase[:, 0, 0])
    way = rng.normal(scale=0.3, size=(1, 3)) * phase[:, 0] + [0.0, 0.9 + rng.normal(scale=0.03), 0.0]
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=way, frame_rate_hz=30.0)


def unblended(segments: list[Motion]) -> tuple[np.ndarray, np.ndarray]:
    """Give the segments on one path, as they are."""
    walked = blending._one_path(segments)
    return (
        np.concatenate([segment.rotations for segment in walked]),
        np.concatenate([segment.root_positions for segment in walked]),
    )


@pytest.mark.parametrize("blend", ["offset", "bridge"])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_the_duration_is_exact_and_only_ten_frames_at_a_join_change(blend, count) -> None:
    segments = [dancing(seed, FRAMES + 7 * seed) for seed in range(count)]
    motion = blending.joined(segments, blend=blend)
    assert len(motion) == sum(len(segment) for segment in segments)
    rotations, roots = unblended(segments)
    changed = np.zeros(len(motion), dtype=bool)
    for join in np.cumsum([len(segment) for segment in segments])[:-1]:
        changed[join - 5 : join + 5] = True
    assert rotation.between(rotations[~changed], motion.rotations[~changed]) == pytest.approx(
        np.zeros((int((~changed).sum()), 24, 3)), abs=1e-12
    )
    assert motion.root_positions[~changed] == pytest.approx(roots[~changed], abs=1e-12)
    if count > 1:
        moved = np.abs(rotation.between(rotations[changed], motion.rotations[changed])).max(axis=(1, 2))
        assert np.all(moved > 1e-4)


def one_hinge(angle: float, spin: float, height: float, climb: float) -> Motion:
    """Give a body that turns one elbow evenly about one axis, while its root climbs evenly."""
    times = np.arange(FRAMES) / 30.0
    rotations = rotation.identity(FRAMES, 24)
    rotations[:, ELBOW] = rotation.exp((angle + spin * times)[:, None] * np.array([0.0, 1.0, 0.0]))
    roots = np.zeros((FRAMES, 3))
    roots[:, 1] = height + climb * times
    return Motion(skeleton=NEUTRAL_BODY, rotations=rotations, root_positions=roots, frame_rate_hz=30.0)


def sides(values: np.ndarray) -> tuple[float, float]:
    """Give how far two sides miss each other at a join, in place and in speed (a frame).

    Even movement with a cubic on top is a cubic, which five frames on one side determine to the last digit.
    """
    moments = np.arange(-5, 5) + 0.5  # the join is at 0
    cubics = [np.polynomial.Polynomial.fit(moments[s], values[s], 3) for s in (slice(0, 5), slice(5, 10))]
    before, after = cubics
    return abs(after(0.0) - before(0.0)), abs(after.deriv()(0.0) - before.deriv()(0.0))


def test_place_and_speed_are_continuous_at_a_join() -> None:
    segments = [one_hinge(0.0, 1.0, 0.9, 0.2), one_hinge(0.7, -2.0, 1.0, -0.3)]
    motion = blending.joined(segments)
    window = slice(FRAMES - 5, FRAMES + 5)
    rotations, roots = unblended(segments)
    for curve, raw in (
        (rotation.log(motion.rotations)[window, ELBOW, 1], rotation.log(rotations)[window, ELBOW, 1]),
        (motion.root_positions[window, 1], roots[window, 1]),
    ):
        gap, speed_gap = sides(curve)
        assert gap < 1e-9
        assert speed_gap < 1e-9
        # Not blended, the mismatch is there.
        raw_gap, raw_speed_gap = sides(raw)
        assert raw_gap > 0.05
        assert raw_speed_gap > 0.01


def test_spreading_places_alone_would_be_noticed() -> None:
    # Wrong: the mismatch of places spread by a smooth step, that of speeds forgotten.
    segments = [one_hinge(0.0, 1.0, 0.9, 0.2), one_hinge(0.7, -2.0, 1.0, -0.3)]
    angles = rotation.log(unblended(segments)[0])[FRAMES - 5 : FRAMES + 5, ELBOW, 1]
    near = 1.0 - (np.arange(5) + 0.5) / 5
    step = near**2 * (3.0 - 2.0 * near)
    gap = (angles[5] - (-2.0 / 60.0)) - (angles[4] + 1.0 / 60.0)
    angles = angles + 0.5 * gap * np.concatenate((step[::-1], -step))
    place, speed = sides(angles)
    assert place < 1e-9
    assert speed == pytest.approx(3.0 / 30.0, abs=1e-3)


def join_mismatch(rotations: np.ndarray, refined: int) -> tuple[float, float]:
    """Give the mismatch of places (rad) and speeds (rad/s, seen from the parent), mean over joints."""
    half = len(rotations) // 2
    before, after = rotations[half - 2 : half], rotations[half : half + 2]
    turns = rotation.between(*before), rotation.between(*after)
    meet = (
        rotation.multiply(before[1], rotation.exp(0.5 * turns[0])),
        rotation.multiply(after[0], rotation.exp(-0.5 * turns[1])),
    )
    speeds = [rotation.rotate(m, t) * 30.0 * refined for m, t in zip(meet, turns, strict=True)]
    return (
        float(np.linalg.norm(rotation.between(*meet), axis=-1)[1:].mean()),
        float(np.linalg.norm(speeds[1] - speeds[0], axis=-1)[1:].mean()),
    )


@pytest.mark.parametrize("seed", range(6))
def test_turns_about_changing_axes_meet_as_well(seed, monkeypatch) -> None:
    # Sampled 40 times finer, with a window as long in seconds, slopes can be read off at the join.
    refined = 40
    monkeypatch.setattr(blending, "HALF_WINDOW", 5 * refined)

    def fine(number: int, gap: float) -> Motion:
        rng = np.random.default_rng(100 * seed + number)
        phase = np.arange(30 * refined)[:, None, None] / (30.0 * refined)
        turns = rng.normal(scale=gap, size=(1, 24, 3)) + rng.normal(scale=0.5, size=(1, 24, 3)) * np.sin(
            3.0 * phase + rng.uniform(0.0, 6.0, size=(1, 24, 3))
        )
        rotations = rotation.exp(turns)
        rotations[:, 0] = rotation.identity()
        return Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotations,
            root_positions=np.zeros((len(rotations), 3)),
            frame_rate_hz=30.0 * refined,
        )

    segments = [fine(0, 0.2), fine(1, 0.2)]
    before = join_mismatch(unblended(segments)[0], refined)
    after = join_mismatch(np.asarray(blending.joined(segments).rotations), refined)
    assert before[0] > 0.3
    assert before[1] > 1.0
    assert after[0] < 0.01 * before[0]
    # With each side's speed in its own frame instead of the one halfway, a third of it stays.
    assert after[1] < 0.1 * before[1]


def test_a_bridge_is_the_straight_way() -> None:
    segments = [dancing(1), dancing(2)]
    motion = blending.joined(segments, blend="bridge")
    rotations, roots = unblended(segments)
    start, end = FRAMES - 6, FRAMES + 5
    way = rotation.between(rotations[start], rotations[end])
    for number in range(1, 11):
        along = rotation.between(rotations[start], motion.rotations[start + number])
        assert along == pytest.approx(way * number / 11.0, abs=1e-9)
        assert motion.root_positions[start + number] == pytest.approx(
            roots[start] + (roots[end] - roots[start]) * number / 11.0
        )


def test_the_way_goes_on_where_and_which_way_it_went() -> None:
    segments = [dancing(seed) for seed in range(4)]
    rotations, roots = unblended(segments)
    facing = kinematics.facing(kinematics.centred_positions(NEUTRAL_BODY, rotations))
    for number, join in enumerate(range(FRAMES, 4 * FRAMES, FRAMES)):
        turn = facing[join] - facing[join - 1]
        assert np.sin(turn) == pytest.approx(0.0, abs=1e-9)
        assert np.cos(turn) > 0.0
        # The first frame comes a frame after the last: one step further, as wide as those around it.
        steps = np.diff(roots[join - 2 : join + 2], axis=0)[:, [0, 2]]
        assert steps[1] == pytest.approx(0.5 * (steps[0] + steps[2]), abs=1e-9)
        # Heights are left to the blend: segments keep their floor.
        own = segments[number + 1].root_positions[:, 1]
        assert roots[join : join + FRAMES, 1] == pytest.approx(own)
        # The dancing itself is carried along unchanged.
        assert rotations[join : join + FRAMES, 1:] == pytest.approx(
            np.asarray(segments[number + 1].rotations)[:, 1:], abs=1e-12
        )


def test_beginning_again_at_the_origin_would_be_noticed() -> None:
    segments = [dancing(1), dancing(2)]
    raw = np.concatenate([segment.root_positions for segment in segments])
    step = np.linalg.norm(np.diff(raw, axis=0)[:, [0, 2]], axis=1)
    joined = np.linalg.norm(np.diff(blending.joined(segments).root_positions, axis=0)[:, [0, 2]], axis=1)
    assert step[FRAMES - 1] > 5.0 * step[: FRAMES - 1].max()
    assert joined[FRAMES - 1] < 2.0 * joined.mean()
