"""A dance says what was asked, what was found and what it asks of each joint, and is read back."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography.choreograph import dance
from studykit.choreography.dance import Dance, measured
from studykit.choreography.request import requested
from studykit.choreography.schedule import BlockPlan
from studykit.core.provenance import sha256_of_value
from studykit.motion import energy, kinematics
from studykit.motion.blending import joined
from studykit.motion.joint_mask import spare
from studykit.motion.skeleton import JOINT_NAMES

LIMIT_RAD_S = 3.4


@pytest.fixture(scope="module")
def library(swinging):
    return swinging(24)


@pytest.fixture(scope="module")
def made(library, within_reach) -> Dance:
    """Give a dance of two blocks that spares the right hand."""
    mask = spare("right_hand", weights=0.5, speed_limits_rad_s=LIMIT_RAD_S)
    plans = (BlockPlan(duration_s=16.0), BlockPlan(duration_s=24.0, intensity="intense"))
    asked = within_reach(requested(library, schedule=plans, spare=mask), library)
    return dance(asked, library, seed=3, is_preview=True)


def test_a_dance_comes_back_from_json(made) -> None:
    again = Dance.from_dict(json.loads(json.dumps(made.to_dict())), made.motion)
    assert again.to_dict() == made.to_dict()
    assert again.sha256 == made.sha256
    for name in ("blocks", "segments", "trace", "weights", "chain_costs", "asked", "achieved"):
        assert getattr(again, name) == getattr(made, name)
    assert again.mask is not None
    assert again.mask.to_dict() == made.mask.to_dict()
    free = replace(made, mask=None, is_interrupted=True)
    again = Dance.from_dict(json.loads(json.dumps(free.to_dict())), made.motion)
    assert (again.mask, again.is_interrupted) == (None, True)


def test_blocks_add_up_to_the_dance(made) -> None:
    assert [block.achieved.duration_s for block in made.blocks] == [16.0, 24.0]
    for which, total in (
        ("asked", made.asked),
        ("achieved", made.achieved),
        ("achieved_blended", made.achieved_blended),
    ):
        blocks = [getattr(block, which) for block in made.blocks]
        for name in ("duration_s", "linear_energy", "rotational_energy"):
            assert sum(getattr(block, name) for block in blocks) == pytest.approx(getattr(total, name))
        # Four segments and six.
        mean = (4 * blocks[0].variety + 6 * blocks[1].variety) / 10
        assert total.variety == pytest.approx(mean)


def test_every_joint_says_what_is_asked_of_it(made) -> None:
    joints = made.joints()
    assert list(joints) == list(JOINT_NAMES)
    speeds = kinematics.angular_speeds(made.motion.rotations, 30.0)
    energies = energy.rotational_energy(made.motion.rotations, 30.0)
    for number, said in enumerate(joints.values()):
        assert said["peak_rad_s"] == speeds[:, number].max()
        assert said["mean_rad_s"] == pytest.approx(speeds[:, number].mean())
        assert said["energy"] == pytest.approx(energies[number])
    assert joints["right_hand"]["limit_rad_s"] == LIMIT_RAD_S
    assert joints["right_hand"]["peak_rad_s"] <= LIMIT_RAD_S
    assert joints["left_hand"]["limit_rad_s"] is None
    assert sum(said["energy"] for said in joints.values()) == pytest.approx(
        made.achieved_blended.rotational_energy
    )
    # Degrees for radians would be noticed.
    assert joints["right_hand"]["peak_rad_s"] != pytest.approx(np.degrees(speeds[:, 23].max()), rel=0.01)


def version_1(made: Dance) -> dict:
    """Give what was written of a dance before blocks and masks came."""
    values = made.to_dict()
    told = ("iteration", "temperature", "width", "cost", "best_cost", "segments", "accepted")
    kept = {
        name: values[name]
        for name in (
            "condition", "seed", "preset", "targets_from", "is_synthetic",
            "asked", "achieved", "achieved_blended", "joins", "library_sha256",
        )
    }  # fmt: skip
    segments = [
        {name: value for name, value in segment.items() if name != "spliced_from"}
        for segment in values["segments"]
    ]
    digest = {
        "version": 1,
        "condition": made.condition,
        "library_sha256": made.library_sha256,
        "segments": [segment["id"] for segment in segments],
    }
    return kept | {
        "version": 1,
        "cost": {name: values["cost"][name] for name in ("total", "terms")},
        "segments": segments,
        "joints": {
            name: {key: said[key] for key in ("peak_rad_s", "mean_rad_s")}
            for name, said in values["joints"].items()
        },
        "trace": [{name: row[name] for name in told} for row in values["trace"]],
        "sha256": sha256_of_value(digest),
    }


def test_a_dance_of_version_1_is_still_read(made) -> None:
    older = version_1(made)
    again = Dance.from_dict(json.loads(json.dumps(older)), made.motion)
    assert again.sha256 == older["sha256"] != made.sha256
    assert again.version == 1
    assert (again.mask, again.weights, again.chain_costs, again.is_interrupted) == (None, {}, (), False)
    (block,) = again.blocks
    assert (block.asked, block.achieved, block.achieved_blended) == (
        made.asked,
        made.achieved,
        made.achieved_blended,
    )
    assert again.segments == made.segments
    assert [row.cost for row in again.trace] == [row.cost for row in made.trace]
    assert again.trace[0].terms == {}
    # Written again, it says the same and is the same dance.
    twice = Dance.from_dict(json.loads(json.dumps(again.to_dict())), made.motion)
    assert twice.to_dict() == again.to_dict()
    assert twice.sha256 == older["sha256"]


@pytest.mark.parametrize(("preset", "who"), [("paper", "paper"), ("studykit", "percentiles")])
def test_dances_written_before_raters_were_asked_do_not_say_so(made, preset, who) -> None:
    older = version_1(made) | {"preset": preset}
    del older["targets_from"]
    assert Dance.from_dict(older, made.motion).targets_from == who


def test_the_digest_tells_dances_apart(made) -> None:
    assert replace(made).sha256 == made.sha256
    assert replace(made, library_sha256="1" * 64).sha256 != made.sha256
    assert replace(made, segments=made.segments[::-1]).sha256 != made.sha256
    assert replace(made, condition="intense-hard-on").sha256 != made.sha256


def test_what_is_shown_is_measured_joins_included(library) -> None:
    motion = joined([library.motion(0), library.motion(5)])
    shown = measured(motion, (12.0,), (round(motion.duration_s / 4.0),))[0]
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    assert shown.linear_energy == pytest.approx(energy.linear_energy(positions, 30.0).sum())
    assert shown.rotational_energy == pytest.approx(energy.rotational_energy(motion.rotations, 30.0).sum())
    assert (shown.duration_s, shown.variety) == (8.0, 12.0)


def test_a_step_between_two_blocks_belongs_to_the_later_one(library) -> None:
    motions = [library.motion(segment) for segment in (0, 5)]
    both = replace(
        motions[0],
        rotations=np.concatenate([motion.rotations for motion in motions]),
        root_positions=np.concatenate([motion.root_positions for motion in motions]),
    )
    first, second = measured(both, (1.0, 2.0), (1, 1))
    alone = [measured(motion, (0.0,), (round(motion.duration_s / 4.0),))[0] for motion in motions]
    assert first.linear_energy == pytest.approx(alone[0].linear_energy)
    assert first.rotational_energy == pytest.approx(alone[0].rotational_energy)
    whole = measured(both, (0.0,), (round(both.duration_s / 4.0),))[0]
    jump = whole.rotational_energy - sum(one.rotational_energy for one in alone)
    assert jump > 0.0
    assert second.rotational_energy == pytest.approx(alone[1].rotational_energy + jump)
    assert (first.variety, second.variety) == (1.0, 2.0)
