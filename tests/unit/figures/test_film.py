"""Film strips: what comes back looks and is called the same; what jumps is measured."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.colors import to_hex

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.figures import film_strip, film_strips, style
from studykit.figures.canvas import PaperFigure
from studykit.figures.film import SEGMENTS_A_ROW, at_joins, letters, middles
from studykit.motion import kinematics, rotation
from studykit.motion.joint_mask import spare
from studykit.motion.motion import Motion


def bands(figure: PaperFigure) -> dict[str, set[str]]:
    """Give the colours of the bands of each letter."""
    found: dict[str, set[str]] = {}
    for axes in figure.axes:
        for patch in axes.patches:
            if str(patch.get_gid()).startswith("segment "):
                found.setdefault(patch.get_gid()[8:], set()).add(to_hex(patch.get_facecolor()))
    return found


def turned(dance: Dance, angles_rad: np.ndarray) -> Motion:
    """Let each segment of a dance face another way."""
    rotations = np.array(dance.motion.rotations)
    rotations[:, 0] = rotation.multiply(
        rotation.exp(np.repeat(angles_rad, 120)[:, None] * [0.0, 1.0, 0.0]), rotations[:, 0]
    )
    return Motion(
        skeleton=dance.motion.skeleton,
        rotations=rotations,
        root_positions=dance.motion.root_positions,
        frame_rate_hz=30.0,
    )


def test_the_same_segment_has_the_same_letter_and_its_mirror_image_a_prime(made_dance) -> None:
    assert letters(made_dance("CACcB")) == ("A", "B", "A", "A′", "C")
    assert letters(made_dance("cC")) == ("A", "A′")


def test_only_what_comes_back_has_a_colour(made_dance) -> None:
    found = bands(film_strip(made_dance("ABaC")))
    assert found["A"] == found["A′"] != {"#ffffff"}
    assert found["B"] == found["C"] == {"#ffffff"}


def test_a_segment_looks_the_same_whichever_way_it_faces(made_dance) -> None:
    dance = made_dance("ABAA")
    spun = made_dance("ABAA", motion=turned(dance, np.array([0.0, 0.5, 2.0, -3.0])))
    for poses in (middles(dance), middles(spun)):
        assert poses[0] == pytest.approx(poses[2], abs=1e-12)
        assert poses[0] == pytest.approx(poses[3], abs=1e-12)
        assert kinematics.facing(poses) == pytest.approx(0.0, abs=1e-12)
    frames = spun.motion.rotations[[60, 300]]  # Wrong: as the camera sees them
    seen = kinematics.centred_positions(spun.motion.skeleton, frames)
    assert np.abs(seen[0] - seen[1]).max() > 0.1


def test_bodies_stand_on_the_floor(made_dance) -> None:
    poses = middles(made_dance())
    assert poses[..., 1].min() == pytest.approx(0.0, abs=1e-9)
    assert np.allclose(poses[:, 0, [0, 2]], 0.0)


def test_both_sides_of_a_join_are_the_poses_beside_its_blend(made_dance) -> None:
    dance = made_dance("AB")
    (before, after), *others = at_joins(dance)
    assert not others
    motion = dance.motion
    expected = kinematics.centred_positions(motion.skeleton, motion.rotations[[114, 125]])
    turn = rotation.exp(np.array([0.0, -kinematics.facing(expected[0]), 0.0]))  # both as the first faces
    assert before == pytest.approx(rotation.rotate(turn, expected[0]), abs=1e-12)
    assert after == pytest.approx(rotation.rotate(turn, expected[1]), abs=1e-12)


def test_every_join_says_how_far_joints_jump(made_dance) -> None:
    dance = made_dance("A" * (SEGMENTS_A_ROW + 2))
    figure = film_strip(dance)
    assert len(figure.axes) == 2  # rows
    said = [
        text.get_text() for axes in figure.axes for text in axes.texts if text.get_gid() == "displacement"
    ]
    assert said == [f"{1000.0 * jump:.0f} mm" for jump in dance.displacements_m]


def test_spared_joints_have_a_colour_of_their_own(made_dance) -> None:
    def colours(dance: Dance) -> set[str]:
        drawn = film_strip(dance).axes[0].collections
        return {to_hex(colour) for lines in drawn for colour in lines.get_colors()}

    spared = style.SPARED.lower()
    assert spared in colours(made_dance(mask=spare("right_elbow")))
    assert spared not in colours(made_dance())


def test_a_film_strip_says_what_is_made_up_and_needs_a_dance(made_dance: Callable[..., Dance]) -> None:
    pair = [made_dance(), made_dance(condition="light-easy-off", is_synthetic=False)]
    assert film_strips(pair).get_suptitle() == style.SYNTHETIC
    assert film_strip(pair[1]).get_suptitle() == ""
    assert [axes.get_title("left") for axes in film_strips(pair).axes] == [
        "Light – Easy, transition on",
        "Light – Easy, transition off",
    ]
    assert len(film_strip(made_dance("A")).axes) == 1  # a dance without joins
    with pytest.raises(InputError, match="no dance to show"):
        film_strips([])
