"""A library of many takes: killed and begun again, on several processes, on a cluster, and at full scale."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from studykit.library import make_sample, open_library, store

SEGMENTS = 90


def contents(library: Path) -> dict[str, bytes]:
    return {
        path.relative_to(library).as_posix(): path.read_bytes()
        for path in sorted(library.rglob("*"))
        if path.is_file()
    }


def begin(out: Path, *, workers: int = 1, segments: int = SEGMENTS) -> subprocess.Popen[bytes]:
    """Start a build in a process group of its own, so that it can be killed with its workers or without."""
    command = [sys.executable, "-m", "studykit", "library", "sample", "--out", str(out)]
    return subprocess.Popen(
        [*command, "--segments", str(segments), "--seed", "3", "--workers", str(workers)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, bytes], float]:
    """Build once without a kill; give the library's bytes and how long it took."""
    out = tmp_path_factory.mktemp("whole") / "library"
    start = time.perf_counter()
    assert begin(out).wait() == 0
    return contents(out), time.perf_counter() - start


def test_two_processes_make_the_same_bytes(tmp_path: Path) -> None:
    for workers in (1, 2):
        make_sample(tmp_path / str(workers), segments=40, seed=3, workers=workers)
    assert contents(tmp_path / "1") == contents(tmp_path / "2")


@pytest.mark.slow  # the cohort's, which goes the same way, is in the default run
def test_a_dask_cluster_makes_the_same_bytes_by_the_same_call(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    from joblib import parallel_config

    make_sample(tmp_path / "here", segments=40, seed=3)
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client, parallel_config(backend="dask"):
        make_sample(tmp_path / "there", segments=40, seed=3)
        worked = client.run(lambda: "studykit.library.build" in sys.modules)
    assert any(worked.values())  # elsewhere: the workers are processes of their own
    assert contents(tmp_path / "here") == contents(tmp_path / "there")


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("seed", range(12))
def test_killed_at_any_moment_and_begun_again_it_is_the_same_to_the_byte(
    whole: tuple[dict[str, bytes], float], tmp_path: Path, workers: int, seed: int
) -> None:
    out = tmp_path / "library"
    rng = np.random.default_rng([seed, workers])
    kills, longest_s = 0, whole[1]
    while kills < 3:
        process = begin(out, workers=workers)
        time.sleep(rng.uniform(0.02, 0.9) * longest_s)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            kills += 1
        else:  # the machine was busier when it was timed: kill the next one sooner, from the beginning
            longest_s /= 2.0
            shutil.rmtree(out)
        process.wait()
    assert begin(out, workers=workers).wait() == 0
    assert contents(out) == whole[0]
    store.require_intact(out)


@pytest.mark.slow
def test_killed_while_it_grows_the_older_library_is_whole_until_the_new_one_is(tmp_path: Path) -> None:
    out, grown = tmp_path / "library", tmp_path / "grown"
    make_sample(out, segments=40, seed=3)
    older = open_library(out).sha256
    make_sample(grown, segments=SEGMENTS, seed=3)
    seen = set()
    for seed in range(10):
        work = tmp_path / f"work-{seed}"
        shutil.copytree(out, work)
        process = begin(work)
        time.sleep(np.random.default_rng(seed).uniform(0.5, 6.0))
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        library = open_library(work)  # opens, whatever was going on
        seen.add(library.sha256)
        assert library.sha256 in {older, open_library(grown).sha256}
        assert np.isfinite(library.features[len(library) - 1]).all()
        assert begin(work).wait() == 0
        assert contents(work) == contents(grown)
    assert older in seen


@pytest.mark.slow
def test_a_full_library_is_built_in_little_memory_and_opened_without_reading_it(tmp_path: Path) -> None:
    psutil = pytest.importorskip("psutil", reason="psutil is not installed")
    out = tmp_path / "full"
    process = begin(out, workers=2, segments=34_613)
    peak = 0
    while process.poll() is None:
        with contextlib.suppress(psutil.Error):
            family = [psutil.Process(process.pid), *psutil.Process(process.pid).children(recursive=True)]
            peak = max(peak, sum(one.memory_info().rss for one in family))
        time.sleep(0.2)
    assert process.returncode == 0
    print(f"built with at most {peak / 2**30:.2f} GiB in all processes")
    assert peak < 3 * 2**30
    script = (
        "import os, psutil, sys, time\n"
        "import pandas, pyarrow.parquet\n"
        "from studykit.library import open_library, store\n"
        "before = psutil.Process().memory_info().rss\n"
        "start = time.perf_counter(); library = open_library(sys.argv[1]); opened = time.perf_counter()\n"
        "found = library.find(genre='synthetic-kick', linear_energy=(0.1, 0.2)); end = time.perf_counter()\n"
        "grown = psutil.Process().memory_info().rss - before\n"
        "print(len(library), len(found), opened - start, end - opened, grown)\n"
    )
    command = [sys.executable, "-c", script, str(out)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    segments, found, opened_s, query_s, grown = (float(word) for word in done.stdout.split())
    print(f"opened in {opened_s:.3f} s, queried in {query_s * 1000:.1f} ms, {grown / 2**20:.0f} MiB")
    assert segments == 34_613
    assert 0 < found < segments
    assert grown < 0.1 * sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
