"""What is light, intense, varied and smooth is measured on chains of the library's own segments."""

from __future__ import annotations

import shutil
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance_library import distances
from studykit.choreography.targets import goals
from studykit.core.errors import InputError
from studykit.core.seeding import stream
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.library import calibrate, index, open_library, store
from studykit.library.build import build
from studykit.library.calibrate import CHAINS
from studykit.library.rating import RatedTargets


def relabelled(library, **columns):
    return replace(library, segments=library.segments.assign(**columns))


def test_a_thousand_chains_of_eight(made_library) -> None:
    library = made_library(20)
    measured = calibrate.calibrate(library, stream(1, "calibration"))
    assert len(measured.chain_linear_energies) == len(measured.chain_varieties) == CHAINS
    assert len(measured.join_displacements) == 7 * CHAINS
    # Eight of twenty segments: the mean over chains is eight times the mean segment.
    each = library.linear_energies.sum(axis=1)
    assert measured.chain_linear_energies.mean() == pytest.approx(8.0 * each.mean(), rel=0.02)
    assert measured.chain_linear_energies.min() >= np.sort(each)[:8].sum() - 1e-12
    assert measured.chain_linear_energies.max() <= np.sort(each)[-8:].sum() + 1e-12
    pairs = [library.displacement(a, b) for a in range(20) for b in range(20) if a != b]
    assert measured.join_displacements.mean() == pytest.approx(np.mean(pairs), rel=0.02)
    assert set(np.round(measured.join_displacements, 9)) <= set(np.round(pairs, 9))
    between = distances(library, "euclidean_z")
    apart = [between.between([a], [b])[0, 0] for a, b in combinations(range(20), 2)]
    assert measured.chain_varieties.mean() == pytest.approx(np.mean(apart), rel=0.01)
    assert measured.transition_tolerance_m == pytest.approx(np.percentile(measured.join_displacements, 3.0))
    assert measured.energy_targets(25.0)[0] < measured.energy_targets(75.0)[0]


def test_the_unit_of_variety_is_between_takes(made_library) -> None:
    # Two segments a take: neighbours are left out of the median.
    library = made_library(8)
    features = np.array(library.features)
    features[1::2] = features[::2] + 0.001 * features[1::2]
    library = replace(library, features=features)
    between = distances(library, "euclidean_z")
    apart = [between.between([a], [b])[0, 0] for a, b in combinations(range(8), 2) if a // 2 != b // 2]
    measured = calibrate.calibrate(library, stream(1, "calibration"))
    assert measured.median_distance == pytest.approx(np.median(apart), rel=0.01)
    near = between.between([0], [1])[0, 0]
    assert near < 0.1 * measured.median_distance


def test_chains_keep_to_one_genre(made_library) -> None:
    # Eight slow segments and twelve wild ones: no chain mixes them.
    library = relabelled(made_library(20), genre=["slow"] * 8 + ["wild"] * 12)
    energies = np.where(np.arange(20) < 8, 1.0, 100.0)[:, None] / 24.0 * np.ones(24)
    library = replace(library, linear_energies=energies)
    sums = calibrate.calibrate(library, stream(2, "calibration")).chain_linear_energies
    assert set(np.round(sums, 6)) == {8.0, 800.0}
    assert np.mean(sums > 100.0) == pytest.approx(0.6, abs=0.05)  # genres by their number of segments


def test_small_genres_are_danced_together(made_library) -> None:
    library = relabelled(made_library(10), genre=["a"] * 5 + ["b"] * 5)
    assert len(calibrate.calibrate(library, stream(1, "calibration")).chain_varieties) == CHAINS


def test_the_same_seed_measures_the_same(made_library) -> None:
    library = made_library(12)
    first, again, other = (calibrate.calibrate(library, stream(seed, "calibration")) for seed in (3, 3, 4))
    assert np.array_equal(first.chain_varieties, again.chain_varieties)
    assert not np.array_equal(first.chain_varieties, other.chain_varieties)


@pytest.mark.parametrize(("segments", "take"), [(7, None), (12, "one")])
def test_too_little_to_calibrate_is_named(made_library, segments, take) -> None:
    library = made_library(segments)
    if take is not None:
        library = relabelled(library, take=take)
    with pytest.raises(InputError, match=r"^made-up: .* too few to calibrate; give at least 8 segments"):
        calibrate.calibrate(library, stream(1, "calibration"))


def test_windows_danced_in_one_go_are_measured_beside_the_chains(made_library) -> None:
    # Two takes of ten segments: three windows each; a gap in a third leaves it none.
    library = relabelled(
        made_library(30),
        take=["one"] * 10 + ["two"] * 10 + ["three"] * 10,
        start_s=[4.0 * n for n in range(10)] * 2 + [4.0 * n + (1.0 if n > 5 else 0.0) for n in range(10)],
    )
    measured = calibrate.calibrate(library, stream(1, "calibration"))
    each = library.linear_energies.sum(axis=1)
    expected = [each[first : first + 8].sum() for first in (0, 1, 2, 10, 11, 12)]
    assert measured.window_linear_energies == pytest.approx(expected)
    between = distances(library, "euclidean_z")
    apart = np.mean([between.between([a], [b])[0, 0] for a, b in combinations(range(10, 18), 2)])
    assert measured.window_varieties[3] == pytest.approx(apart)
    mirrored = relabelled(library, mirrored=[False] * 20 + [True] * 10)
    assert len(calibrate.calibrate(mirrored, stream(1, "calibration")).window_varieties) == 6


def test_chains_do_not_depend_on_the_windows(made_library) -> None:
    plain = calibrate.calibrate(made_library(20), stream(1, "calibration"))
    one = relabelled(made_library(20), start_s=[4.0 * n for n in range(20)])
    assert np.array_equal(
        calibrate.calibrate(one, stream(1, "calibration")).chain_varieties, plain.chain_varieties
    )


def test_the_scaler_does_not_depend_on_how_features_are_read(monkeypatch) -> None:
    monkeypatch.setattr(calibrate, "_CHUNK", 64)
    features = np.random.default_rng(1).gamma(2.0, size=(150, 120, 97)).astype(np.float32)
    features[:, :, :3] = 0.0
    scaler = calibrate.fit_scaler(features)
    poses = features.reshape(-1, 97).astype(float)
    assert scaler.kinetic_medians[3:] == pytest.approx(np.median(poses[:, 3:72], axis=0), rel=1e-6)
    assert (scaler.kinetic_medians[:3] == 1.0).all()
    logs = scaler.logarithmic(poses)
    assert scaler.means == pytest.approx(logs.mean(axis=0), rel=1e-9, abs=1e-12)
    assert scaler.deviations == pytest.approx(logs.std(axis=0), rel=1e-6, abs=1e-9)
    # Of more poses than are looked at, the median comes from evenly spaced ones, whatever the pieces.
    monkeypatch.setattr(calibrate, "_MEDIAN_POSES", 5_000)
    many = np.tile(np.arange(300, dtype=np.float32)[:, None, None] + 1.0, (1, 120, 97))
    assert calibrate.fit_scaler(many).kinetic_medians == pytest.approx(np.full(72, 150.0), rel=0.01)


def test_every_reading_of_the_paper_s_unit(built) -> None:
    table = calibrate.unit_readings(built, stream(0, "unit readings")).set_index("reading")
    assert len(table) == 6
    mean = 8.0 * built.linear_energies.sum() / len(built)
    assert table.loc["joints from the pelvis, mass as a share", "linear_energy"] == pytest.approx(
        mean, rel=1e-5
    )
    assert table.loc["joints from the pelvis, mass in kg (73.5)", "linear_energy"] == pytest.approx(
        73.5 * mean, rel=1e-5
    )
    walking = table.loc["joints in the room, mass as a share", "linear_energy"]
    # The takes drift at sqrt(0.3^2 + 0.1^2) m/s: on average that adds half its square over 24 for 119 steps.
    assert walking > mean
    assert table["rotational_energy"].nunique() == 2


def rated_targets(library_sha256: str) -> RatedTargets:
    return RatedTargets(
        linear_energy={"light": 1.0, "intense": 2.0},
        rotational_energy={"light": 0.3, "intense": 0.6},
        variety={"easy": 90.0, "hard": 150.0},
        spreads={"linear_energy": 0.5, "rotational_energy": 0.1, "variety": 20.0},
        counts={"light": 12, "intense": 12, "easy": 12, "hard": 12},
        agreement={},
        library_sha256=library_sha256,
    )


@pytest.mark.parametrize("harm", ["changed", "lost"])
def test_a_build_does_not_carry_broken_targets_over(takes_folder: Path, tmp_path: Path, harm: str) -> None:
    out = tmp_path / "out"
    before = build(takes_folder, out)
    index.adopt(out, rated_targets(before.sha256))
    path = next(out.glob("index-*/rated-targets-*.json"))
    path.write_text(path.read_text().replace("150.0", "105.0")) if harm == "changed" else path.unlink()
    with pytest.raises(InputError, match=r"broken library .*build it again"):
        open_library(out)
    assert build(takes_folder, out).calibration.rated is None
    assert store.read_manifest(out)["rated_dropped"]
    store.require_intact(out)


def test_raters_go_before_percentiles(built_folder: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(built_folder, copy)
    before = open_library(copy)
    index.adopt(copy, rated_targets(before.sha256))
    store.require_intact(copy)
    library = open_library(copy)
    assert library.sha256 != before.sha256
    assert library.calibration.energies_of("intense", 75.0) == (2.0, 0.6)
    assert library.calibration.variety_of("hard", 0.94) == 150.0
    goal = goals(read_protocol(default_protocol()), library)["intense-hard-on"]
    scale, aim = goal.duration_s / 32.0, goal.measures
    assert (aim.linear_energy, aim.rotational_energy) == pytest.approx((2.0 * scale, 0.6 * scale))
    assert aim.variety == 150.0
    index.adopt(copy, None)
    assert open_library(copy).sha256 == before.sha256
    assert open_library(copy).calibration.rated is None
