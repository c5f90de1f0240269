"""Glitches are found, dancing and standing still are not."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.motion import cleaning

RATE = 30.0
FRAMES = 300


def swinging() -> np.ndarray:
    """Give joints that swing 0.4 m, some faster than others, and stand still for the last third."""
    times = np.minimum(np.arange(FRAMES), 200) / RATE
    positions = np.zeros((FRAMES, 24, 3))
    for joint in range(1, 24):
        positions[:, joint, 0] = 0.4 * np.sin(2.0 * np.pi * (0.3 + 0.05 * joint) * times)
    return positions


def excesses(positions, way=None) -> dict[str, np.ndarray]:
    return cleaning.excesses(positions, np.zeros((len(positions), 3)) if way is None else way, RATE)


def broken(positions, way=None) -> dict[str, list[int]]:
    """Give the frames in which each rule is broken."""
    over = excesses(positions, way)
    return {rule: np.flatnonzero((shares > 1.0).any(axis=1)).tolist() for rule, shares in over.items()}


def flagged_frames(positions, rule="robust") -> list[int]:
    return np.flatnonzero(cleaning.flagged(excesses(positions), rule)).tolist()


def test_dancing_and_standing_still_are_clean() -> None:
    assert flagged_frames(swinging()) == []


@pytest.mark.parametrize("jump_m", [0.5, 2.0])
def test_a_marker_that_jumps_for_one_frame_is_found(jump_m) -> None:
    positions = swinging()
    positions[100, 7] += [0.0, jump_m, 0.0]
    flags = broken(positions)
    # Into the jump and out of it: 15 m/s and more, 450 m/s2 and more.
    assert flags["speed"] == [100, 101]
    assert flags["acceleration"] == [99, 100, 101]
    assert flags["root"] == []
    assert np.argmax(excesses(positions)["speed"][100]) == 7


def test_a_short_jump_is_too_hard_without_being_too_fast() -> None:
    positions = swinging()
    positions[250, 9] += [0.0, 0.36, 0.0]  # while standing still: 10.8 m/s, 324 m/s2 and twice that
    assert broken(positions)["speed"] == []
    assert broken(positions)["acceleration"] == [249, 250, 251]


def test_a_marker_that_jumps_and_stays_is_found() -> None:
    positions = swinging()
    positions[150:, 20] += [0.0, 0.0, 0.6]
    assert flagged_frames(positions) == [149, 150]


def test_the_limits_are_those_of_a_breakdancer() -> None:
    positions = np.zeros((60, 24, 3))
    positions[:, 3, 0] = np.arange(60) * 11.9 / RATE
    assert broken(positions)["speed"] == []
    positions[:, 3, 0] = np.arange(60) * 12.1 / RATE
    assert broken(positions)["speed"] == list(range(1, 60))


def test_a_body_that_jumps_through_the_room_is_found_though_no_joint_moves_from_the_pelvis() -> None:
    still = np.zeros((60, 24, 3))
    way = np.zeros((60, 3))
    way[:, 2] = np.arange(60) * 11.9 / RATE
    assert broken(still, way) == {"speed": [], "acceleration": [], "root": [], "paper": []}
    way[30:, 0] += 0.5
    assert broken(still, way)["root"] == [29, 30]
    assert cleaning.flagged(excesses(still, way), "robust").sum() == 2
    assert cleaning.flagged(excesses(still, way), "paper").sum() == 0


def test_the_paper_s_rule_by_its_definition() -> None:
    rng = np.random.default_rng(2)
    positions = np.cumsum(rng.standard_t(4, size=(FRAMES, 24, 3)) * 0.01, axis=0)
    acceleration = np.zeros((FRAMES, 24))
    for frame in range(1, FRAMES - 1):
        for joint in range(24):
            change = positions[frame + 1, joint] - 2 * positions[frame, joint] + positions[frame - 1, joint]
            acceleration[frame, joint] = np.sqrt((change**2).sum()) * RATE**2
    inner = acceleration[1:-1]
    limit = inner.mean(axis=0) + 2.0 * inner.std(axis=0)
    expected = [frame for frame in range(FRAMES) if (acceleration[frame] > limit).any()]
    assert flagged_frames(positions, "paper") == expected
    assert len(expected) > 0.3 * FRAMES  # why it is not the rule in use: nothing was wrong


def test_the_paper_s_rule_spares_a_joint_that_never_moves() -> None:
    positions = np.zeros((FRAMES, 24, 3)) + 1e-17 * np.random.default_rng(0).normal(size=(FRAMES, 24, 3))
    assert flagged_frames(positions, "paper") == []


@pytest.mark.parametrize("frames", [1, 2, 3])
@pytest.mark.parametrize("rule", ["robust", "paper"])
def test_takes_of_hardly_a_frame(frames, rule) -> None:
    assert flagged_frames(np.zeros((frames, 24, 3)), rule) == []


@pytest.mark.parametrize(
    ("bad", "runs"),
    [
        ("", []),
        ("....", [(0, 4)]),
        ("xxx", []),
        ("..x.", [(0, 2), (3, 4)]),
        ("x..xx.x", [(1, 3), (5, 6)]),
    ],
)
def test_clean_runs(bad, runs) -> None:
    assert cleaning.clean_runs(np.array([mark == "x" for mark in bad], dtype=bool)) == runs
