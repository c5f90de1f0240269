"""Calm arms on the bodies of other segments: within the limits, with room, and measured as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography import splicing
from studykit.choreography.dance_library import distances
from studykit.choreography.neighbours import successors
from studykit.choreography.reduction import reduced
from studykit.choreography.splicing import mask_keeps, spliced
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.motion import energy, features, kinematics, rotation
from studykit.motion.clearance import clearance
from studykit.motion.joint_mask import beyond, spare
from studykit.motion.skeleton import NEUTRAL_BODY

SEGMENTS = 24
ARM = list(beyond("right_collar"))
REST = [joint for joint in range(24) if joint not in ARM]


def measured(library, rotations):
    """Give a library with all that is measured on these rotations."""
    positions = kinematics.centred_positions(NEUTRAL_BODY, rotations)
    turn = rotation.yaw(-kinematics.facing(positions[:, 0]))[:, None]
    rotations = np.array(rotations)
    rotations[:, :, 0] = rotation.multiply(turn, rotations[:, :, 0])
    rotations = rotations.astype(np.float32)
    exact = rotations.astype(float)
    positions = kinematics.centred_positions(NEUTRAL_BODY, exact)
    first_poses, last_poses = (kinematics.facing_ahead(positions[:, frame]) for frame in (0, -1))
    return replace(
        library,
        rotations=rotations,
        features=np.array([features.pose_features(one, 30.0) for one in positions], dtype=np.float32),
        linear_energies=np.array([energy.linear_energy(one, 30.0) for one in positions]),
        rotational_energies=np.array([energy.rotational_energy(one, 30.0) for one in exact]),
        peak_speeds=kinematics.angular_speeds(np.moveaxis(exact, 1, 0), 30.0).max(axis=0),
        peak_angles=kinematics.rest_angles(exact).max(axis=1),
        first_poses=first_poses,
        last_poses=last_poses,
        successors=successors(first_poses, last_poses),
    )


@pytest.fixture(scope="module")
def turns() -> np.ndarray:
    """Rotation vectors of dances; in two of three segments the right elbow is quick."""
    rng = np.random.default_rng(8)
    times = np.arange(120)[:, None, None] / 30.0
    swings = rng.normal(scale=0.15, size=(SEGMENTS, 1, 24, 3)) * np.sin(
        rng.uniform(1.0, 4.0, size=(SEGMENTS, 1, 24, 3)) * times
    )
    turns = rng.normal(scale=0.1, size=(SEGMENTS, 1, 24, 3)) + swings
    index = NEUTRAL_BODY.index
    turns[..., index("left_shoulder"), 2] -= 0.7  # arms half lowered
    turns[..., index("right_shoulder"), 2] += 0.7
    quick = np.arange(SEGMENTS) % 3 > 0
    turns[quick, :, index("right_elbow"), 1] += 0.6 * np.sin(9.0 * times[:, 0, 0])
    return turns


@pytest.fixture(scope="module")
def library(made_library, turns):
    made = made_library(SEGMENTS)
    table = made.segments.assign(genre=["salsa", "tango"] * (SEGMENTS // 2))
    return measured(replace(made, segments=table), rotation.exp(turns))


@pytest.fixture(scope="module")
def mask():
    return spare("right_elbow", speed_limits_rad_s=2.5)


@pytest.fixture(scope="module")
def new(library, mask):
    return spliced(library, mask)


def rows_of(library) -> np.ndarray:
    return np.flatnonzero(library.segments["spliced_from"] != "")


def donors_of(library) -> list[int]:
    """Read the donors from what the table says."""
    places = {
        f"right arm: {row.take} at {row.start_s:.2f} s": int(row.id) for row in library.segments.itertuples()
    }
    return [places[library.segments["spliced_from"][row]] for row in rows_of(library)]


def test_every_spliced_segment_keeps_the_limits(library, mask, new) -> None:
    before, after = (mask_keeps(one, mask).all(axis=1) for one in (library, new))
    assert before.sum() == SEGMENTS // 3
    assert after.sum() > 0.8 * SEGMENTS
    assert np.array_equal(np.flatnonzero(after & ~before), rows_of(new))
    for row in np.flatnonzero(after):
        speeds = kinematics.angular_speeds(new.motion(int(row)).rotations, 30.0).max(axis=0)
        assert np.all(speeds <= mask.speed_limits_rad_s * (1.0 + 1e-12))


def test_the_arm_is_the_donor_s_and_all_else_the_dancer_s(library, new) -> None:
    rows, donors = rows_of(new), donors_of(new)
    inner = [joint for joint in REST if joint]
    assert np.array_equal(new.rotations[rows][:, :, ARM], library.rotations[donors][:, :, ARM])
    assert np.array_equal(new.rotations[rows][:, :, inner], library.rotations[rows][:, :, inner])
    same = np.setdiff1d(np.arange(SEGMENTS), rows)
    for name in ("rotations", "root_positions", "features", "linear_energies", "first_poses", "peak_speeds"):
        assert np.array_equal(getattr(new, name)[same], getattr(library, name)[same]), name
    assert (new.segments["spliced_from"][same] == "").all()


def test_what_is_measured_is_the_new_movement(library, new) -> None:
    again = measured(library, np.asarray(new.rotations[slice(None)], dtype=float))
    for name in (
        "rotations", "features", "linear_energies", "rotational_energies", "peak_speeds", "peak_angles",
        "first_poses", "last_poses",
    ):  # fmt: skip
        found, expected = np.asarray(getattr(new, name)[:]), np.asarray(getattr(again, name)[:])
        np.testing.assert_allclose(found, expected, rtol=1e-4, atol=2e-5, err_msg=name)
    assert np.array_equal(new.successors, successors(new.first_poses, new.last_poses))
    assert new.segments["linear_energy"].to_numpy() == pytest.approx(again.linear_energies.sum(axis=1))
    assert new.segments["rotational_energy"].to_numpy() == pytest.approx(
        again.rotational_energies.sum(axis=1)
    )
    # It is another movement, so nothing may be left of the old one.
    rows = rows_of(new)
    assert np.all(
        np.abs(new.rotational_energies[rows] - library.rotational_energies[rows]).sum(axis=1) > 1e-5
    )
    assert np.all(distances(new, "euclidean_z").between(rows, rows)[0, 1:] > 0.0)


def test_segments_still_face_ahead_and_walk_the_same_way(library, new) -> None:
    for row in rows_of(new):
        motion, before = new.motion(int(row)), library.motion(int(row))
        positions = kinematics.joint_positions(motion)
        assert kinematics.facing(positions[0]) == pytest.approx(0.0, abs=1e-6)
        assert motion.root_positions[:, 1] == pytest.approx(before.root_positions[:, 1], abs=1e-6)
        # Feet stay where they were in the dancer's own room, turned as a whole.
        feet = positions[:, [NEUTRAL_BODY.index("left_foot"), NEUTRAL_BODY.index("right_foot")]]
        old = kinematics.joint_positions(before)[
            :, [NEUTRAL_BODY.index("left_foot"), NEUTRAL_BODY.index("right_foot")]
        ]
        ways = [np.linalg.norm(np.diff(one, axis=0), axis=-1) for one in (feet, old)]
        assert ways[0] == pytest.approx(ways[1], abs=1e-6)


def crossing(turns: np.ndarray) -> np.ndarray:
    """Let quick dancers hold the left forearm where calm ones have the right."""
    turns = np.array(turns)
    index = NEUTRAL_BODY.index
    calm = np.arange(SEGMENTS) % 3 == 0
    turns[calm, :, index("right_shoulder")] = [0.0, 1.2, 0.3]
    turns[calm, :, index("right_elbow")] = [0.0, 1.3, 0.0]
    turns[~calm, :, index("left_shoulder")] = [0.0, -1.2, -0.3]
    turns[~calm, :, index("left_elbow")] = [0.0, -1.3, 0.0]
    return turns


def test_an_arm_without_room_is_not_taken(library, mask, turns, monkeypatch: pytest.MonkeyPatch) -> None:
    def gaps(one):
        rows = np.arange(SEGMENTS)
        positions = kinematics.centred_positions(NEUTRAL_BODY, np.asarray(one.rotations[rows], dtype=float))
        return clearance(positions, "right")

    folded = measured(library, rotation.exp(crossing(turns)))
    danced = gaps(folded)
    new = spliced(folded, mask)
    for row, donor in zip(rows_of(new), donors_of(new), strict=True):
        assert np.all(gaps(new)[row] >= np.minimum(0.02, danced[donor] - 0.005) - 1e-6)
    # Were it not asked for, there would be arms through arms.
    monkeypatch.setattr(splicing, "ROOM_M", -1.0)
    careless = spliced(folded, mask)
    assert len(rows_of(careless)) > len(rows_of(new))
    assert gaps(careless)[rows_of(careless)].min() < -0.01


def test_an_arm_of_a_body_that_leans_another_way_is_not_taken(library, mask, turns) -> None:
    leaning = np.array(turns)
    leaning[::3, :, NEUTRAL_BODY.index("spine1"), 0] += 1.2  # all calm ones bow
    assert len(rows_of(spliced(measured(library, rotation.exp(leaning)), mask))) == 0


def test_an_arm_that_carries_the_body_is_neither_replaced_nor_taken(library, mask, new) -> None:
    # Closer to the floor, hands reach it.
    hands = np.array([kinematics.joint_positions(library.motion(row))[:, 23, 1].min() for row in range(24)])
    sunk = np.array(library.root_positions)
    row, donor = int(rows_of(new)[0]), donors_of(new)[0]
    for lowered in (row, donor):
        sunk[lowered, :, 1] -= hands[lowered] - 0.1
    made = spliced(replace(library, root_positions=sunk), mask)
    assert made.segments["spliced_from"][row] == ""
    assert donor not in donors_of(made)
    # Nor may a new arm reach where neither reached before.
    heights = [kinematics.joint_positions(made.motion(int(low)))[:, 23, 1].min() for low in rows_of(made)]
    assert min(heights) >= 0.2


def calmed(turns: np.ndarray, host: int, donors: list[int]) -> np.ndarray:
    """Let donors do what a host does, but for its quick elbow."""
    turns = np.array(turns)
    turns[donors] = turns[host]
    elbow = NEUTRAL_BODY.index("right_elbow")
    turns[donors, :, elbow, 1] -= 0.6 * np.sin(9.0 * np.arange(120) / 30.0)
    return turns


def test_the_donor_is_the_one_whose_arm_is_nearest(library, mask, turns) -> None:
    made = spliced(measured(library, rotation.exp(calmed(turns, 7, [3]))), mask)
    assert made.segments["spliced_from"][7] == "right arm: take-1 at 4.00 s"


@pytest.mark.parametrize("donor", [3, 6, 9])
def test_of_donors_alike_the_one_of_the_same_genre_is_taken(library, mask, turns, donor: int) -> None:
    genres = library.segments["genre"].copy()
    genres[[7, donor]] = "waltz"
    twins = measured(library, rotation.exp(calmed(turns, 7, [3, 6, 9])))
    made = spliced(replace(twins, segments=twins.segments.assign(genre=genres)), mask)
    expected = f"right arm: take-{donor // 2} at {4.0 * (donor % 2):.2f} s"
    assert made.segments["spliced_from"][7] == expected


def test_a_mirrored_donor_is_named_as_such(library, mask) -> None:
    mirrored = replace(library, segments=library.segments.assign(mirrored=True))
    assert spliced(mirrored, mask).segments["spliced_from"].max().endswith(" s, mirrored")


def test_both_arms_may_come_from_different_segments(library, turns) -> None:
    quick = np.array(turns)
    quick[1::2, :, NEUTRAL_BODY.index("left_elbow"), 1] += 0.6 * np.sin(9.0 * np.arange(120) / 30.0)
    both = measured(library, rotation.exp(quick))
    mask = spare(("right_elbow", "left_elbow"), speed_limits_rad_s=2.5)
    made = spliced(both, mask)
    kept = mask_keeps(made, mask).all(axis=1)
    assert kept.sum() > 2 * mask_keeps(both, mask).all(axis=1).sum()
    words = made.segments["spliced_from"]
    assert words.str.contains("left arm: .*; right arm: ").any()
    # A segment that would still break a limit is left as it was.
    assert (words[~kept] == "").all()


def test_a_segment_that_breaks_a_limit_elsewhere_is_left_as_it_is(library) -> None:
    mask = spare(("right_elbow", "left_knee"), speed_limits_rad_s=(2.5, 1e-6))
    assert len(rows_of(spliced(library, mask))) == 0


def test_the_same_splice_twice_and_nothing_changed(library, mask, new) -> None:
    before = {name: np.array(getattr(library, name)) for name in ("rotations", "peak_speeds", "successors")}
    again = spliced(library, mask)
    assert again.sha256 == new.sha256 != library.sha256
    assert spliced(library, spare("right_elbow", speed_limits_rad_s=2.4)).sha256 != new.sha256
    assert again.segments.equals(new.segments)
    assert "spliced_from" not in library.segments
    for name, array in before.items():
        assert np.array_equal(getattr(library, name), array)


def test_rows_are_read_as_of_any_library(new) -> None:
    whole = new.features[slice(None)]
    assert whole.shape == new.features.shape == (len(new.features), 120, 97)
    assert np.array_equal(new.features[[5, 2, 2]], whole[[5, 2, 2]])
    assert np.array_equal(new.features[5], whole[5])
    assert new.features[[]].shape == (0, 120, 97)
    assert new.features[np.zeros(0, dtype=int)].shape == (0, 120, 97)


def test_reduced_distances_are_made_anew(library, mask) -> None:
    large = spliced(replace(library, reduced=reduced(library, stream(0, "axes"))), mask)
    every = range(SEGMENTS)
    assert large.reduced is not None
    assert large.reduced.between(every, every) == pytest.approx(
        distances(large, "euclidean_z").between(every, every), rel=1e-3, abs=1e-2
    )


@pytest.mark.parametrize("mask", [spare("left_knee", speed_limits_rad_s=1.0), spare("right_elbow")])
def test_a_mask_that_limits_no_arm_is_refused(library, mask) -> None:
    with pytest.raises(InputError, match=r"limits no joint of an arm, .*; spare a joint of an arm"):
        spliced(library, mask)


def test_a_limit_that_no_segment_keeps_leaves_everything(library) -> None:
    made = spliced(library, spare("right_elbow", speed_limits_rad_s=1e-6))
    assert len(rows_of(made)) == 0
    assert np.array_equal(made.rotations[slice(None)], library.rotations)
