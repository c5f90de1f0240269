"""How long a library takes to build; measurements without a verdict (make benchmark)."""

from __future__ import annotations

import os
import pickle
import time
from pathlib import Path

import pytest

from studykit.io.datasets.read import find_recipe
from studykit.library import build, make_sample, open_library
from studykit.library.build import make_shard
from studykit.library.measure import Settings
from studykit.library.sample import synthetic_takes
from studykit.library.source import take_files
from studykit.motion import rotation
from studykit.motion.resampling import resampled

pytestmark = pytest.mark.benchmark

TAKES = 48
TAKE_S = 10.0


@pytest.fixture(scope="module")
def aist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write takes of 10 s as AIST++ has them: pickles of SMPL parameters at 60 Hz."""
    import numpy as np

    folder = tmp_path_factory.mktemp("aist") / "motions"
    folder.mkdir()
    frames = round(60.0 * TAKE_S)
    for number, source in enumerate(synthetic_takes(10 * (16 * TAKES // 4), seed=0)):
        motion = resampled(source.takes()[0].motion, 60.0)
        for part in range(4):
            rows, count = slice(part * frames, (part + 1) * frames), 4 * number + part
            values = {
                "smpl_poses": rotation.log(motion.rotations[rows]).reshape(-1, 72),
                "smpl_trans": motion.root_positions[rows] * 93.0,
                "smpl_scaling": np.array([93.0]),
            }
            name = f"gBR_sBM_cAll_d{count % 30 + 1:02d}_mBR{count // 30 % 6}_ch{count // 180 + 1:02d}.pkl"
            (folder / name).write_bytes(pickle.dumps(values))
    return folder


def test_takes_of_smpl_parameters_by_size_and_processes(aist: Path, tmp_path: Path) -> None:
    from joblib import Parallel, delayed

    files = take_files(aist, find_recipe(aist))
    rates = {}
    for workers in (1, 2):
        Parallel(n_jobs=workers)(
            delayed(os.getpid)() for _ in range(8)
        )  # processes are there before we count
        for times in (1, 4, 16):
            out = tmp_path / f"{workers}-{times}"
            jobs = files[: times * TAKES]
            start = time.perf_counter()
            Parallel(n_jobs=workers)(delayed(make_shard)(file, out, Settings(), {}) for file in jobs)
            taken = time.perf_counter() - start
            rates[workers, times] = len(jobs) * TAKE_S / taken
            print(
                f"{workers} process(es), {len(jobs)} takes, {len(jobs) * TAKE_S / 60:.0f} min: {taken:.2f} s,"
                f" {rates[workers, times]:.0f} times real time, {1e3 * taken / len(jobs):.1f} ms a take"
            )
    for workers in (1, 2):
        # Cost grows linearly: sixteen times the takes at hardly another rate.
        assert 0.5 < rates[workers, 16] / rates[workers, 4] < 2.0
    print(f"two processes against one: {rates[2, 16] / rates[1, 16]:.2f} times as fast")


def test_a_whole_build_and_one_that_has_nothing_to_do(aist: Path, tmp_path: Path) -> None:
    out = tmp_path / "library"
    for words in ("from nothing", "again"):
        start = time.perf_counter()
        library = build([aist], out, workers=2)
        print(f"{len(library)} segments, {words}: {time.perf_counter() - start:.2f} s")


def test_opening_and_asking(tmp_path: Path) -> None:
    make_sample(tmp_path / "library", segments=2400, seed=0, workers=2)
    start = time.perf_counter()
    library = open_library(tmp_path / "library")
    opened = time.perf_counter()
    found = library.find(genre="synthetic-kick", linear_energy=(0.1, 0.2))
    print(f"opened in {opened - start:.3f} s, asked in {1e3 * (time.perf_counter() - opened):.2f} ms")
    assert len(found) > 0
