"""Synthetic movement is smooth, rhythmic, possible for a person and as hard as asked."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.core.seeding import stream
from studykit.library import joint_limit, synthesis
from studykit.motion import energy, kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY

PHRASES = 4
GRADES = (0.08, 0.2, 0.5)
index = NEUTRAL_BODY.index


def danced(style: synthesis.Style, grade: float) -> Motion:
    drawn = synthesis.figures(style, PHRASES, stream(5, style.name, str(grade)))
    return synthesis.dance(drawn, np.full(PHRASES, grade))


@pytest.fixture(scope="module")
def dances() -> dict[tuple[str, float], Motion]:
    return {(style.name, grade): danced(style, grade) for style in synthesis.STYLES for grade in GRADES}


def test_styles_say_that_they_are_synthetic() -> None:
    assert len({style.name for style in synthesis.STYLES}) == len(synthesis.STYLES) >= 6
    for style in synthesis.STYLES:
        assert style.name.startswith("synthetic-")
        assert 90 <= style.tempo_bpm[0] < style.tempo_bpm[1] <= 130


def test_joints_stay_strictly_within_their_limits(dances) -> None:
    moves = joint_limit.HIGH > joint_limit.LOW
    for motion in dances.values():
        angles = joint_limit.angles(motion.rotations)
        angles[:, 0, 1] = 0.0  # the pelvis may face anywhere
        moving = moves.copy()
        moving[0, 1] = False
        assert np.all((angles > joint_limit.LOW - 1e-9)[:, moving])
        assert np.all((angles < joint_limit.HIGH + 1e-9)[:, moving])
        assert np.abs(angles[:, ~moving]).max() < 1e-9


def test_knees_and_elbows_bend_one_way_only(dances) -> None:
    for motion in dances.values():
        vectors = rotation.log(motion.rotations)
        for side, sign in (("left", -1.0), ("right", 1.0)):
            assert vectors[:, index(f"{side}_knee"), 0].min() > 0.0  # heels go back
            bent = joint_limit.angles(motion.rotations)[:, index(f"{side}_elbow"), 1]
            assert (sign * bent).min() > 0.0  # hands come forward


def test_nothing_moves_faster_than_a_dancer(dances) -> None:
    for motion in dances.values():
        world = kinematics.joint_positions(motion)
        assert np.linalg.norm(np.diff(world, axis=0), axis=-1).max() * 30.0 < 6.0
        assert np.linalg.norm(np.diff(world, n=2, axis=0), axis=-1).max() * 900.0 < 100.0
        centred = world - world[:, :1]
        assert np.linalg.norm(np.diff(centred, axis=0), axis=-1).max() * 30.0 < 12.0
        assert np.linalg.norm(np.diff(centred, n=2, axis=0), axis=-1).max() * 900.0 < 300.0


def test_feet_stay_on_the_floor_and_the_dancer_in_the_room(dances) -> None:
    for motion in dances.values():
        lowest = kinematics.joint_positions(motion)[..., 1].min(axis=1)
        assert lowest.min() > -0.05
        assert lowest.max() < 0.10
        assert np.abs(motion.root_positions[:, [0, 2]]).max() < 4.0


def test_energies_are_those_asked_for(dances) -> None:
    for (_, grade), motion in dances.items():
        centred = kinematics.centred_positions(NEUTRAL_BODY, motion.rotations)
        reached = [energy.linear_energy(part, 30.0).sum() for part in np.split(centred, PHRASES)]
        if grade < 0.4:  # above, the speed limit may hold a phrase back
            assert reached == pytest.approx(np.full(PHRASES, grade), rel=0.15)
        assert np.max(reached) < 1.15 * grade
        assert np.median(reached) > 0.5 * grade


def test_each_phrase_has_a_figure_of_its_own(dances) -> None:
    motion = dances["synthetic-step", 0.2]
    angles = joint_limit.angles(motion.rotations)[:, 1:]
    phrases = np.split(angles, PHRASES)
    for first in range(PHRASES):
        for second in range(first):
            assert np.abs(phrases[first] - phrases[second]).mean() > np.radians(2.0)


def test_movement_keeps_the_beat() -> None:
    style = synthesis.STYLES[1]
    drawn = synthesis.figures(style, 1, stream(3, "beat"))
    motion = synthesis.perform(drawn, np.ones(1), 120.0)
    knees = joint_limit.angles(motion.rotations)[:, [index("left_knee"), index("right_knee")], 0].sum(axis=1)
    spectrum = np.abs(np.fft.rfft((knees - knees.mean()) * np.hanning(len(knees)), 1 << 14))
    strongest_hz = np.argmax(spectrum) * 120.0 / (1 << 14)
    beats = strongest_hz * 60.0 / drawn.tempo_bpm
    assert beats == pytest.approx(1.0, abs=0.1)  # both knees together bounce on every beat


def largest_jump(motion: Motion) -> float:
    """Largest change of a joint's acceleration from one frame to the next, m/s2."""
    acceleration = np.diff(kinematics.joint_positions(motion), n=2, axis=0) * motion.frame_rate_hz**2
    return float(np.linalg.norm(np.diff(acceleration, axis=0), axis=-1)[4:-4].max())


def test_accelerations_do_not_jump_even_where_phrases_join() -> None:
    # Sampled twice as finely, what is continuous changes half as much a frame, a jump as much as ever.
    drawn = synthesis.figures(synthesis.STYLES[2], 3, stream(2, "smooth"))
    coarse, fine = (largest_jump(synthesis.perform(drawn, np.full(3, 0.5), rate)) for rate in (480.0, 960.0))
    assert fine < 0.6 * coarse


def test_a_join_with_a_corner_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        synthesis, "_smooth_step", lambda share: 3 * (x := np.clip(share, 0, 1)) ** 2 - 2 * x**3
    )
    drawn = synthesis.figures(synthesis.STYLES[2], 3, stream(2, "smooth"))
    coarse, fine = (largest_jump(synthesis.perform(drawn, np.full(3, 0.5), rate)) for rate in (480.0, 960.0))
    assert fine > 0.6 * coarse


def test_joint_angles_and_rotations_undo_each_other() -> None:
    angles = np.random.default_rng(0).uniform(joint_limit.LOW, joint_limit.HIGH, (20, 24, 3))
    assert joint_limit.angles(joint_limit.rotations(angles)) == pytest.approx(angles, abs=1e-12)
    expected = rotation.from_euler("XZY", angles[:, index("left_hip")][:, [0, 2, 1]])
    assert joint_limit.rotations(angles)[:, index("left_hip")] == pytest.approx(expected, abs=1e-12)


def test_limits_mirror_and_hold_whatever_is_wished() -> None:
    flip = np.array([1.0, -1.0, -1.0])
    mirrored = joint_limit.NEUTRAL[list(NEUTRAL_BODY.mirror)] * flip
    np.testing.assert_allclose(mirrored, joint_limit.NEUTRAL)
    wild = joint_limit.within(np.random.default_rng(1).normal(scale=20.0, size=(50, 24, 3)))
    moves = joint_limit.HIGH > joint_limit.LOW
    assert np.all((wild > joint_limit.LOW)[:, moves] & (wild < joint_limit.HIGH)[:, moves])
    np.testing.assert_allclose(joint_limit.within(joint_limit.NEUTRAL), joint_limit.NEUTRAL)
