"""The real CMU dances: read, built into a library, and choreographed into the eight dances of the study."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studykit.choreography import choreograph
from studykit.choreography.choreograph import dance
from studykit.choreography.dance import Dance
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.targets import goals
from studykit.io.bvh import read_bvh
from studykit.io.datasets.read import find_recipe
from studykit.io.protocol_file import read_protocol
from studykit.io.skeletal_take import SkeletalTake
from studykit.io.skeleton_map import to_smpl
from studykit.library import open_library, store
from studykit.library.build import build
from studykit.library.measure import Settings
from studykit.motion import kinematics, rotation
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.skeleton import JOINT_NAMES, NEUTRAL_BODY
from studykit.protocol.study_protocol import StudyProtocol

PROTOCOL = Path(__file__).parents[2] / "protocols" / "dance-2x2x2.toml"
FOLDER = "motion/cmu-bvh-acrnn"
TAKES = ("salsa/01", "salsa/16", "indian/06", "martial/04")
LEVELS = (("light", "intense"), ("easy", "hard"), ("on", "off"))


@pytest.fixture(scope="session")
def cmu(shared_data: Callable[[str], Path]) -> Path:
    return shared_data(FOLDER)


@pytest.fixture(scope="session")
def takes(cmu: Path) -> dict[str, SkeletalTake]:
    return {name: read_bvh(cmu / f"{name}.bvh.xz") for name in TAKES}


@pytest.fixture(scope="session")
def library_folder(cmu: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "cmu"
    build({cmu: find_recipe(cmu)}, out)
    return out


@pytest.fixture(scope="session")
def library(library_folder: Path) -> DanceLibrary:
    return open_library(library_folder)


@pytest.fixture(scope="session")
def yields(library_folder: Path) -> pd.DataFrame:
    return pd.read_csv(store.index_folder(library_folder) / store.TAKES).set_index("take")


@pytest.fixture(scope="session")
def protocol() -> StudyProtocol:
    return read_protocol(PROTOCOL)


@pytest.fixture(scope="session")
def dances(library: DanceLibrary, protocol: StudyProtocol) -> dict[str, Dance]:
    return choreograph(protocol, library, seed=1)


# --- reading ---------------------------------------------------------------------------------------------


def smpl(take: SkeletalTake, rate: float | None = None) -> Motion:
    motion = to_smpl(take, "daz", units_m=0.01)
    return motion if rate is None else replace(motion, frame_rate_hz=rate)


def named(positions: np.ndarray) -> dict[str, np.ndarray]:
    return {name: positions[:, joint] for joint, name in enumerate(JOINT_NAMES)}


def bends_right(positions: np.ndarray) -> float:
    """Give the share of well bent knees (over 15 degrees) whose shank goes backwards, seen from the hips."""
    at = named(positions)
    left = at["left_hip"] - at["right_hip"]
    sines = []
    for side in ("left", "right"):
        thigh = at[f"{side}_knee"] - at[f"{side}_hip"]
        shank = at[f"{side}_ankle"] - at[f"{side}_knee"]
        unit = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in (thigh, shank, left)]
        sines.append(np.sum(np.cross(unit[0], unit[1]) * unit[2], axis=1))
    bent = np.concatenate(sines)
    return float(np.mean(bent[np.abs(bent) > np.sin(np.radians(15.0))] > 0.0))


@pytest.mark.parametrize("name", TAKES)
def test_knees_bend_the_right_way_and_toes_point_ahead(takes: dict[str, SkeletalTake], name: str) -> None:
    positions = kinematics.joint_positions(smpl(takes[name]))
    assert bends_right(positions) > 0.999
    at, facing = named(positions), kinematics.facing(positions)
    ahead = np.stack((np.sin(facing), np.zeros_like(facing), np.cos(facing)), axis=-1)
    toes = sum(at[f"{side}_foot"] - at[f"{side}_ankle"] for side in ("left", "right"))
    assert np.mean(np.sum(toes * ahead, axis=1) > 0.0) > 0.9


@pytest.mark.parametrize("name", ["85_12", "85_14", "135_01"])
def test_another_skeleton_of_the_same_people(shared_data: Callable[[str], Path], name: str) -> None:
    take = read_bvh(shared_data(f"motion/cmu-fbx-keijiro/bvh/{name}.bvh.xz"))
    positions = kinematics.joint_positions(to_smpl(take, "neo", units_m=0.01))
    assert bends_right(positions) > 0.999
    assert np.ptp(np.percentile(positions[:, 0, 1], [5, 95])) < 1.0  # metres, not centimetres


def test_left_is_left_in_the_added_t_pose(takes: dict[str, SkeletalTake]) -> None:
    for take in takes.values():
        t_pose = kinematics.centred_positions(NEUTRAL_BODY, smpl(take).rotations[0])
        side = {name: t_pose[joint, 0] for joint, name in enumerate(JOINT_NAMES)}
        assert side["left_wrist"] > 0.6 > -0.6 > side["right_wrist"]
        assert side["left_ankle"] > 0.05 > -0.05 > side["right_ankle"]
        assert kinematics.facing(t_pose) == pytest.approx(0.0, abs=0.15)


def test_rotations_the_wrong_way_round_would_be_noticed(takes: dict[str, SkeletalTake]) -> None:
    take = takes["salsa/16"]
    transposed = smpl(replace(take, rotations=rotation.inverse(take.rotations)))
    assert bends_right(kinematics.joint_positions(transposed)) < 0.5


def test_left_taken_for_right_would_be_noticed(takes: dict[str, SkeletalTake]) -> None:
    positions = kinematics.joint_positions(smpl(takes["salsa/16"]))
    assert bends_right(positions * [-1.0, 1.0, 1.0]) < 0.001  # the room mirrored
    assert bends_right(positions[:, NEUTRAL_BODY.mirror]) < 0.001  # the names swapped


def lifts_per_second(motion: Motion) -> float:
    """Give how often the left ankle is lifted by 6 cm."""
    height = kinematics.joint_positions(resampled(motion, 30.0))[:, JOINT_NAMES.index("left_ankle"), 1]
    up = height > np.percentile(height, 10.0) + 0.06
    return float(np.sum(up[1:] & ~up[:-1]) / motion.duration_s)


@pytest.mark.parametrize("name", ["salsa/01", "salsa/16"])
def test_salsa_is_danced_at_60_frames_a_second_not_120(takes: dict[str, SkeletalTake], name: str) -> None:
    # Salsa of 165 beats a minute lifts each foot at most three times in eight beats: 1.03 times a second.
    most = 3.0 / (8.0 * 60.0 / 165.0)
    assert takes[name].frame_rate_hz == pytest.approx(120.0, rel=1e-5)  # what the file says
    assert 0.5 < lifts_per_second(smpl(takes[name], 60.0)) < most
    assert lifts_per_second(smpl(takes[name])) > most


# --- the library -----------------------------------------------------------------------------------------


def test_every_take_has_its_true_duration(cmu: Path, yields: pd.DataFrame) -> None:
    with (cmu.parent / "INDEX.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["path"].startswith("cmu-bvh-acrnn/")]
    index = {row["path"].removeprefix("cmu-bvh-acrnn/").removesuffix(".bvh.xz"): row for row in rows}
    assert set(yields.index) == set(index)
    for name, row in index.items():
        skipped = int(row["skip_first_frames"])
        expected = (int(row["frames"]) - skipped) / float(row["fps_true"])
        assert yields.loc[name, "duration_s"] == pytest.approx(expected, abs=1e-6), name
        assert float(row["seconds"]) == pytest.approx(expected + skipped / float(row["fps_true"]), abs=0.01)


def test_most_segments_are_kept_and_the_paper_s_rule_keeps_few(
    library: DanceLibrary, yields: pd.DataFrame
) -> None:
    assert len(library) >= 150
    assert len(library) == yields["segments_kept"].sum()
    assert yields["segments_kept"].sum() > 0.95 * yields["segments_possible"].sum()
    assert yields["segments_paper"].sum() < 0.2 * yields["segments_possible"].sum()
    assert np.all(yields["segments_kept"] <= yields["segments_possible"])
    counted = library.segments.groupby("take").size()
    assert counted.to_dict() == yields["segments_kept"].to_dict()


def test_known_glitches_are_found_and_clean_takes_are_left_alone(yields: pd.DataFrame) -> None:
    flagged = yields["frames_speed"] + yields["frames_acceleration"]
    for glitchy in ("indian/07", "salsa/10", "indian/04"):
        assert flagged[glitchy] > 0
    assert yields.loc["indian/07", "segments_kept"] < yields.loc["indian/07", "segments_possible"]
    # One frame too hard, none too fast: it costs a segment all the same.
    assert yields.loc["salsa/03", ["frames_speed", "frames_acceleration"]].tolist() == [0, 1]
    assert yields.loc["salsa/03", "segments_kept"] < yields.loc["salsa/03", "segments_possible"]
    assert flagged["martial/08"] == 0  # a nearly still pose
    assert np.mean(flagged == 0) > 0.7
    # The printed rule flags every take, however clean.
    assert np.all(yields["frames_paper"] > 0)


def test_segments_are_apart_on_the_floor_and_face_ahead(library: DanceLibrary) -> None:
    for _, rows in library.segments.groupby("take"):
        assert np.all(np.diff(rows["start_s"]) >= 4.0 - 1e-9)
    assert library.rotations.shape == (len(library), 120, 24, 4)
    first = kinematics.centred_positions(NEUTRAL_BODY, library.rotations[:][:, 0].astype(float))
    assert np.abs(kinematics.facing(first)).max() < 1e-5
    assert np.abs(library.root_positions[:][:, 0, [0, 2]]).max() < 1e-5
    heights = library.root_positions[:][:, :, 1]
    assert 0.75 < np.median(heights) < 1.0  # a pelvis over a floor at 0
    assert set(library.segments["genre"]) == {"salsa", "indian", "martial-arts"}
    assert not library.is_synthetic


def test_features_are_standard_over_the_whole_library(library: DanceLibrary) -> None:
    unclipped = library.scaler.logarithmic(library.features[:]) - library.scaler.means
    assert library.standardised(slice(0, 2)).shape == (2, 11_640)
    alive = library.scaler.deviations > 1e-8
    assert alive.sum() == 94  # all but the three of the pelvis
    standard = (unclipped[..., alive] / library.scaler.deviations[alive]).reshape(-1, 94)
    assert standard.mean(axis=0) == pytest.approx(np.zeros(94), abs=1e-3)
    assert standard.std(axis=0) == pytest.approx(np.ones(94), abs=1e-3)
    clipped = library.standardised(slice(None)).reshape(len(library), 120, 97)
    assert np.abs(clipped).max() <= 5.0
    assert np.all(clipped[..., :3] == 0.0)
    # Independent vectors of that length lie about 150 apart; danced ones a little nearer.
    assert 120.0 < library.calibration.median_distance < 160.0


def test_six_takes_built_twice_give_the_same_bytes(cmu: Path, tmp_path: Path) -> None:
    names = ("salsa/10", "salsa/25", "indian/13", "martial/04", "martial/07", "martial/08")
    for name in names:
        link = tmp_path / "takes" / f"{name}.bvh.xz"
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(cmu / f"{name}.bvh.xz")
    for out in ("one", "two"):
        build({tmp_path / "takes": find_recipe(cmu)}, tmp_path / out, settings=Settings(seed=3))
    first, second = (
        {path.name: path.read_bytes() for path in (tmp_path / out).rglob("*") if path.is_file()}
        for out in ("one", "two")
    )
    assert first == second


# --- the eight dances ------------------------------------------------------------------------------------


def pairs(factor: int) -> list[tuple[str, str]]:
    """Give the pairs of conditions that differ in one factor alone."""
    others = [levels for place, levels in enumerate(LEVELS) if place != factor]

    def name(level: str, rest: tuple[str, ...]) -> str:
        return "-".join((*rest[:factor], level, *rest[factor:]))

    return [(name(LEVELS[factor][0], rest), name(LEVELS[factor][1], rest)) for rest in product(*others)]


def test_all_eight_dances_are_as_asked(dances: dict[str, Dance], protocol: StudyProtocol) -> None:
    assert list(dances) == list(protocol.order.labels)
    for name, found in dances.items():
        asked, achieved = found.asked, found.achieved
        assert len(found.motion) == 960, name
        assert achieved.duration_s == asked.duration_s == found.motion.duration_s == 32.0
        assert len(found.segments) == 8
        assert achieved.linear_energy == pytest.approx(asked.linear_energy, rel=0.05), name
        assert achieved.rotational_energy == pytest.approx(asked.rotational_energy, rel=0.05), name
        gap = dances["light-hard-on"].asked.variety - dances["light-easy-on"].asked.variety
        assert abs(achieved.variety - asked.variety) <= 0.1 * gap, name


def test_what_is_said_of_a_dance_is_measured_on_its_segments(
    dances: dict[str, Dance], library: DanceLibrary
) -> None:
    for found in dances.values():
        rows = [segment.id for segment in found.segments]
        assert found.achieved.linear_energy == pytest.approx(library.linear_energies[rows].sum())
        assert found.achieved.rotational_energy == pytest.approx(library.rotational_energies[rows].sum())
        vectors = library.standardised(np.array(rows)).astype(float)
        apart = [np.linalg.norm(vectors[a] - vectors[b]) for a in range(8) for b in range(a)]
        assert found.achieved.variety == pytest.approx(np.mean(apart), rel=1e-4)
        assert found.displacements_m == pytest.approx([library.displacement(a, b) for a, b in pairwise(rows)])
        # Blending adds and takes little.
        assert found.achieved_blended.linear_energy == pytest.approx(found.achieved.linear_energy, rel=0.25)


def test_intense_dances_have_more_energy_than_light_ones(dances: dict[str, Dance]) -> None:
    for light, intense in pairs(0):
        assert dances[intense].achieved.linear_energy > 1.2 * dances[light].achieved.linear_energy
        assert dances[intense].achieved.rotational_energy > 1.2 * dances[light].achieved.rotational_energy


def test_hard_dances_vary_and_easy_ones_repeat(dances: dict[str, Dance]) -> None:
    for intensity in LEVELS[0]:
        easy, hard = (
            [found for name, found in dances.items() if name.startswith(f"{intensity}-{level}")]
            for level in LEVELS[1]
        )
        assert max(e.achieved.variety for e in easy) < min(h.achieved.variety for h in hard)
        assert all(e.distinct_segments <= 4 for e in easy)
        assert all(h.distinct_segments == 8 for h in hard)


def jump(found: Dance) -> float:
    return float(np.mean(found.displacements_m))


def test_joins_are_smoother_with_the_transition_term(dances: dict[str, Dance]) -> None:
    for on, off in pairs(2):
        assert jump(dances[on]) < jump(dances[off]), on


def test_a_transition_term_without_weight_would_be_noticed(
    library: DanceLibrary, protocol: StudyProtocol, dances: dict[str, Dance]
) -> None:
    # Wrong: "on" searched with the weight of "off".
    wanted = goals(protocol, library)
    for condition in ("light-hard-on", "intense-hard-on"):
        without = replace(wanted[condition], weights=wanted[condition].weights | {"transition": 0.0})
        assert jump(dance(without, library, seed=1)) > 1.5 * jump(dances[condition])


def test_the_same_seed_gives_the_same_dance_and_another_another(
    library: DanceLibrary, protocol: StudyProtocol, dances: dict[str, Dance]
) -> None:
    wanted = goals(protocol, library)["light-hard-on"]
    again, other = (dance(wanted, library, seed=seed) for seed in (1, 2))
    assert again.sha256 == dances["light-hard-on"].sha256
    assert again.trace == dances["light-hard-on"].trace
    assert np.array_equal(again.motion.rotations, dances["light-hard-on"].motion.rotations)
    assert other.sha256 != again.sha256


def test_the_blended_dance_has_no_jump_that_its_segments_do_not_have(
    dances: dict[str, Dance], library: DanceLibrary
) -> None:
    for found in dances.values():
        positions = kinematics.joint_positions(found.motion)
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1) * 30.0
        own = max(
            np.linalg.norm(np.diff(kinematics.joint_positions(library.motion(s.id)), axis=0), axis=-1).max()
            for s in found.segments
        )
        assert steps.max() < max(12.0, 1.5 * 30.0 * own)
        assert np.abs(np.diff(found.motion.root_positions, axis=0)).max() * 30.0 < 5.0
