"""Where two segments meet: distances are those between the poses drawn."""

from __future__ import annotations

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.figures import body, meeting_segments
from studykit.figures.film import at_joins
from studykit.figures.meeting import displacements_m, turned_to_show


def test_the_join_with_the_largest_displacement_is_shown(made_dance) -> None:
    dance = made_dance("ADCB", displacements_m=(0.1, 0.3, 0.2))
    assert "B to C: Δ = 300 mm" in meeting_segments(dance).axes[0].get_title(loc="left")


def test_every_joint_has_its_distance_and_the_line_is_their_mean(made_dance) -> None:
    dance = made_dance("ADCB", displacements_m=(0.1, 0.3, 0.2))
    expected = 1000.0 * np.sort(displacements_m(at_joins(dance))[1])
    axes = meeting_segments(dance).axes[1]
    (points,) = (one for one in axes.collections if one.get_gid() == "distances")
    (mean,) = (one for one in axes.lines if one.get_gid() == "mean")
    assert np.asarray(points.get_offsets())[:, 0] == pytest.approx(expected)
    assert float(np.asarray(mean.get_xdata())[0]) == pytest.approx(expected.mean())


def test_distances_are_lengths_in_space_not_on_the_screen() -> None:
    poses = np.zeros((1, 2, 24, 3))
    poses[0, 1, 5] = [0.0, 0.3, 0.4]
    assert displacements_m(poses)[0, 5] == pytest.approx(0.5)
    assert displacements_m(poses).sum() == pytest.approx(0.5)


def test_a_dance_of_one_segment_is_refused(made_dance) -> None:
    with pytest.raises(InputError, match="has no join"):
        meeting_segments(made_dance("A"))


def test_poses_are_turned_until_the_jump_shows(made_dance) -> None:
    poses = np.zeros((2, 24, 3))
    poses[:, 22] = [[0.0, 1.0, 0.0], [0.0, 1.2, 0.5]]  # towards the reader
    turned = turned_to_show(poses, 22)
    assert np.linalg.norm(turned[1, 22] - turned[0, 22]) == pytest.approx(np.hypot(0.2, 0.5))
    before, after = (np.diff(body.seen(pose)[0][:, 22], axis=0)[0] for pose in (poses, turned))
    assert np.linalg.norm(after) > 0.95 * np.hypot(0.2, 0.5) > np.linalg.norm(before)
