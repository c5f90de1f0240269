"""How fast dances are found: ratios in one run, seconds beside them (make benchmark).

At full scale, with a library that lies at STUDYKIT_LARGE_LIBRARY, or made here (some minutes).
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import thread_time

import numpy as np
import pytest

from studykit.choreography import dance_library
from studykit.choreography.choreograph import dance
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.reduction import reduced
from studykit.choreography.request import requested
from studykit.choreography.rjmcmc import reference
from studykit.choreography.rjmcmc.annealing import STOP_ITERATIONS, STOP_TEMPERATURE, Annealing
from studykit.choreography.rjmcmc.chain import Search, kernel_chances, kernel_targets
from studykit.choreography.rjmcmc.kernel import arrays
from studykit.choreography.rjmcmc.kernel.running import run
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.library import make_sample, open_library
from studykit.library.build import build
from studykit.library.measure import Settings
from tests.benchmarks import incremental

pytestmark = pytest.mark.benchmark

ITERATIONS = 100_000
ANNEALING = Annealing.geometric(iterations=ITERATIONS, start=0.3, end=0.002, start_width=6.0)


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> DanceLibrary:
    there = os.environ.get("STUDYKIT_LARGE_LIBRARY")
    return (
        open_library(there)
        if there
        else make_sample(tmp_path_factory.mktemp("large") / "library", segments=34_613)
    )


def chain_seconds(search: Search, *, runs: int = 5) -> float:
    """Give the median processor time of one chain, after the compiler has done its work."""
    tables = search.repertoire.tables
    targets = kernel_targets(search.objective, search.moves, search.repertoire)
    cooling = (ANNEALING.temperatures, ANNEALING.widths, 0.0, STOP_TEMPERATURE)
    seconds = []
    for seed in range(runs + 1):
        rng = np.random.default_rng(seed)
        draws = rng.random((ITERATIONS, arrays.DRAWS))
        now = arrays.state(search.start(rng), int(targets.highest.max()), len(targets.weights))
        kept = arrays.record(now, len(ANNEALING.temperatures), STOP_ITERATIONS)
        begun = thread_time()
        run(tables, targets, kernel_chances(search.moves), now, cooling, draws, kept)
        seconds.append(thread_time() - begun)
    return median(seconds[1:])


def searching(library: DanceLibrary, **words) -> Search:
    goal = requested(library, **words)
    return Search(goal=goal, repertoire=Repertoire(library, goal.preset), annealing=ANNEALING)


def plain_seconds(search: Search, *, iterations: int = 300) -> float:
    """Give what so many iterations of the plain search would take a chain."""
    rng = np.random.default_rng(0)
    short = Annealing(temperatures=[0.05] * 10, widths=[1.0] * 10, stage_iterations=iterations // 10)
    steps = reference.steps(
        search.repertoire,
        search.objective,
        search.moves,
        short,
        search.start(rng),
        rng.random((iterations, arrays.DRAWS)),
    )
    begun = thread_time()
    list(steps)
    return (thread_time() - begun) * ITERATIONS / iterations


def incremental_seconds(search: Search, *, iterations: int = 3000) -> float:
    tables = search.repertoire.tables
    targets = kernel_targets(search.objective, search.moves, search.repertoire)
    begun = thread_time()
    incremental.run(tables, targets, ANNEALING.temperatures, iterations, np.random.default_rng(0))
    return (thread_time() - begun) * ITERATIONS / iterations


@pytest.mark.parametrize("words", [{"variety": "easy"}, {"variety": "hard", "intensity": "intense"}])
def test_one_chain_at_full_scale(large: DanceLibrary, words: dict[str, str], monkeypatch) -> None:
    monkeypatch.setattr(dance_library, "DENSE_LIMIT", 0)  # reduced distances for the small one too
    search = searching(large, **words)
    small = first_of(large, 1000)
    compiled, few = chain_seconds(search), chain_seconds(searching(small, **words))
    plain, peer = plain_seconds(search), incremental_seconds(search)
    print(
        f"\n{words}: {len(large)} segments {compiled:.3f} s a chain of {ITERATIONS} iterations, "
        f"1,000 segments {few:.3f} s ({compiled / few:.1f} times)"
    )
    print(f"plain {plain / compiled:.0f} times as long, NumPy {peer / compiled:.0f} times")
    assert plain / compiled >= 100.0
    assert peer / compiled >= 8.0
    assert compiled / few <= 3.0


def first_of(library: DanceLibrary, count: int) -> DanceLibrary:
    """Give the first segments of a library, on reduced distances as the whole."""
    rows = slice(0, count)
    assert library.reduced is not None
    return replace(
        library,
        segments=library.segments.iloc[rows].reset_index(drop=True),
        linear_energies=library.linear_energies[rows],
        rotational_energies=library.rotational_energies[rows],
        first_poses=library.first_poses[rows],
        last_poses=library.last_poses[rows],
        peak_speeds=library.peak_speeds[rows],
        peak_angles=library.peak_angles[rows],
        successors=np.asarray(library.successors[rows]) % count,
        reduced=replace(
            library.reduced,
            coordinates=library.reduced.coordinates[rows],
            residuals=library.reduced.residuals[rows],
        ),
    )


def test_reduced_distances_are_off_by_little(large: DanceLibrary) -> None:
    from studykit.choreography.dance_library import SegmentDistances

    rng = np.random.default_rng(0)
    between = SegmentDistances(large, "euclidean_z")
    pairs = rng.choice(len(large), size=(300, 2))
    off = [between.guide(a, b) - between.exact([a, b])[0, 1] for a, b in pairs.tolist() if a != b]
    print(f"\nreduced distances: RMS {np.sqrt(np.mean(np.square(off))):.2f}, bias {np.mean(off):+.2f}")
    found = [
        dance(requested(large, variety=level), large, seed=s) for level in ("easy", "hard") for s in (1, 2, 3)
    ]
    errors = [one.variety_error for one in found]
    print(f"varieties of dances: off by at most {np.max(np.abs(errors)):.2f} while searching")
    for one in found:
        rows = [segment.id for segment in one.segments]
        told = between.exact(rows).sum() / (len(rows) * (len(rows) - 1))
        assert one.achieved.variety == pytest.approx(told, rel=1e-9)


def test_a_first_look(large: DanceLibrary, benchmark: Callable[..., object]) -> None:
    goal = requested(large, intensity="intense")
    dance(goal, large, is_preview=True)
    benchmark(dance, goal, large, is_preview=True)


def test_eight_dances_from_a_cold_process(shared_data: Callable[[str], Path], tmp_path: Path) -> None:
    folders = [shared_data(name) for name in ("motion/cmu-bvh-acrnn", "motion/cmu-fbx-keijiro")]
    build(folders, tmp_path / "real", settings=Settings(mirrored=True))
    script = (
        "import sys, time; begun = time.perf_counter()\n"
        "import studykit as sk\n"
        "library = sk.open_library(sys.argv[1])\n"
        "from studykit.io.protocol_file import default_protocol\n"
        "made = sk.choreograph(sk.read_protocol(default_protocol()), library, seed=int(sys.argv[2]))\n"
        "print(len(made), time.perf_counter() - begun)\n"
    )
    seconds = []
    for seed in range(4):
        command = [sys.executable, "-c", script, str(tmp_path / "real"), str(seed)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        count, taken = done.stdout.split()
        assert count == "8"
        seconds.append(float(taken))
    print(f"\neight dances from a cold process: {median(seconds[1:]):.2f} s")


def test_reducing_a_library(large: DanceLibrary, benchmark: Callable[..., object]) -> None:
    small = first_of(large, 2048)
    benchmark.pedantic(reduced, args=(small, np.random.default_rng(0)), rounds=1)
