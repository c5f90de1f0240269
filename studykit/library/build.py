"""Building a dance library: takes in, clean segments with all their measures out (section 4 of the paper)."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import versions
from studykit.core.seeding import stream
from studykit.io.datasets.read import files_in, read_takes
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.take import Take
from studykit.library import store
from studykit.library.calibrate import calibrate, fit_scaler
from studykit.motion import cleaning, energy, features, kinematics
from studykit.motion.motion import Motion
from studykit.motion.resampling import resampled
from studykit.motion.segmentation import (
    FRAME_RATE_HZ,
    SEGMENT_FRAMES,
    floor_height,
    segment,
    segment_starts,
)

if TYPE_CHECKING:
    import pandas as pd

_ROW_SHAPES: dict[str, tuple[tuple[int, ...], str]] = {
    "rotations": ((SEGMENT_FRAMES, 24, 4), "<f4"),
    "root_positions": ((SEGMENT_FRAMES, 3), "<f4"),
    "features": ((SEGMENT_FRAMES, 97), "<f4"),
    "linear_energies": ((24,), "<f8"),
    "rotational_energies": ((24,), "<f8"),
    "first_poses": ((24, 3), "<f8"),
    "last_poses": ((24, 3), "<f8"),
}


@dataclass(frozen=True, kw_only=True, slots=True)
class TakeYield:
    """What became of one take: how much of it was kept, and what each noise rule flagged.

    Parameters
    ----------
    take : str
        Name of the take.
    duration_s : float
        Length at the true frame rate, without the frames skipped at the start.
    segments_possible, segments_kept, segments_paper : int
        Segments that fit into the whole take, that survive the rule in use, and that would survive the
        paper's literal rule.
    frames_speed, frames_acceleration, frames_paper : int
        Frames (30 Hz) flagged by each criterion.
    """

    take: str
    duration_s: float
    segments_possible: int
    segments_kept: int
    segments_paper: int
    frames_speed: int
    frames_acceleration: int
    frames_paper: int


def write_library(
    takes: Iterable[Take], out: Path, *, name: str, noise_rule: cleaning.NoiseRule = "robust", seed: int = 0
) -> DanceLibrary:
    """Build a library from takes and open it.

    Takes are read one after the other and never held together, so the library may be larger than memory.
    The folder appears only when all went well.

    Parameters
    ----------
    takes : iterable of Take
        Recordings.
    out : Path
        The folder to make.
    name : str
        What the library is called.
    noise_rule : {"robust", "paper"}
        Which frames are cut out.
    seed : int
        For the random chains of the calibration.

    Raises
    ------
    InputError
        If `out` exists or cannot be written, or too little is left after cleaning.
    """
    with store.new_folder(Path(out)) as folder:
        rows: list[dict[str, Any]] = []
        yields: list[TakeYield] = []
        with ExitStack() as files:
            writers = {
                key: files.enter_context(closing(store.ArrayWriter(folder / f"{key}.npy", *form)))
                for key, form in _ROW_SHAPES.items()
            }
            for take in takes:
                measured, outcome = _measured(take, noise_rule)
                yields.append(outcome)
                for start_s, arrays in measured:
                    for key, writer in writers.items():
                        writer.append(arrays[key][None])
                    rows.append(_index_row(len(rows), take, start_s))
        _finish(folder, rows, yields, name=name, noise_rule=noise_rule, seed=seed)
    return store.open_library(out)


def _measured(take: Take, rule: cleaning.NoiseRule) -> tuple[list[tuple[float, dict[str, Any]]], TakeYield]:
    """Clean and cut one take; give its segments (start in s, arrays) and what became of it."""
    motion = resampled(take.motion, FRAME_RATE_HZ)
    positions = kinematics.centred_positions(motion.skeleton, motion.rotations)
    flags = cleaning.flagged(positions, FRAME_RATE_HZ, "robust") | cleaning.flagged(
        positions, FRAME_RATE_HZ, "paper"
    )
    runs = {
        "robust": cleaning.clean_runs(flags["speed"] | flags["acceleration"]),
        "paper": cleaning.clean_runs(flags["paper"]),
    }
    pose_features = np.zeros((len(motion), 97))
    for start, stop in runs[rule]:
        if stop - start >= SEGMENT_FRAMES:
            pose_features[start:stop] = features.pose_features(positions[start:stop], FRAME_RATE_HZ)
    floor = floor_height(motion)
    segments = []
    for start in segment_starts(runs[rule]):
        cut = segment(motion, start, floor)
        segments.append((start / FRAME_RATE_HZ, _arrays(cut, pose_features[start : start + SEGMENT_FRAMES])))
    outcome = TakeYield(
        take=take.name,
        duration_s=round(take.motion.duration_s, 6),
        segments_possible=len(motion) // SEGMENT_FRAMES,
        segments_kept=len(segments),
        segments_paper=len(segment_starts(runs["paper"])),
        frames_speed=int(flags["speed"].sum()),
        frames_acceleration=int(flags["acceleration"].sum()),
        frames_paper=int(flags["paper"].sum()),
    )
    return segments, outcome


def _arrays(cut: Motion, pose_features: np.ndarray[Any, Any]) -> dict[str, Any]:
    positions = kinematics.centred_positions(cut.skeleton, cut.rotations)
    ends = [
        kinematics.centred_positions(cut.skeleton, kinematics.turned(cut, -float(angle)).rotations[frame])
        for frame, angle in ((0, kinematics.facing(positions[0])), (-1, kinematics.facing(positions[-1])))
    ]
    return {
        "rotations": cut.rotations,
        "root_positions": cut.root_positions,
        "features": pose_features,
        "linear_energies": energy.linear_energy(positions, FRAME_RATE_HZ),
        "rotational_energies": energy.rotational_energy(cut.rotations, FRAME_RATE_HZ),
        "first_poses": ends[0],
        "last_poses": ends[1],
    }


def _index_row(number: int, take: Take, start_s: float) -> dict[str, Any]:
    source = take.source
    return {
        "id": number,
        "take": take.name,
        "data_set": source.data_set,
        "performer": source.performer,
        "genre": source.genre,
        "licence": source.licence,
        "start_s": start_s,
        "is_synthetic": source.is_synthetic,
        "take_sha256": source.sha256,
    }


def _finish(
    folder: Path,
    rows: list[dict[str, Any]],
    yields: list[TakeYield],
    *,
    name: str,
    noise_rule: str,
    seed: int,
) -> None:
    """Write the index, the calibration and the manifest of a library whose arrays are written."""
    import pandas as pd

    if not rows:
        raise InputError(
            "no segment is left after cleaning", where=name, remedy="give longer or cleaner takes"
        )
    table = pd.DataFrame(rows)
    table.to_parquet(folder / "segments.parquet", index=False)
    pd.DataFrame([{f: getattr(y, f) for f in TakeYield.__slots__} for y in yields]).to_csv(
        folder / "yield.csv", index=False
    )
    scaler = fit_scaler(np.load(folder / "features.npy", mmap_mode="r", allow_pickle=False))
    library = store.load(folder, name=name, scaler=scaler, calibration=store.UNCALIBRATED, sha256="")
    store.write_calibration(folder, scaler, calibrate(library, stream(seed, "calibration")))
    manifest = {
        "version": store.VERSION,
        "name": name,
        "sha256": store.digest(folder),
        "is_synthetic": library.is_synthetic,
        "noise_rule": noise_rule,
        "seed": seed,
        "segments": len(library),
        "hours": round(len(library) * SEGMENT_FRAMES / FRAME_RATE_HZ / 3600.0, 6),
        "takes": len(yields),
        "segments_possible": sum(y.segments_possible for y in yields),
        "segments_paper": sum(y.segments_paper for y in yields),
        "data_sets": _count(table, "data_set"),
        "genres": _count(table, "genre"),
        "performers": _count(table, "performer"),
        "licences": _count(table, "licence"),
        "versions": versions(),
    }
    text = json.dumps(manifest, indent=1, ensure_ascii=False)
    (folder / "manifest.json").write_text(text + "\n", encoding="utf-8")


def _count(table: pd.DataFrame, column: str) -> dict[str, int]:
    return {str(key): int(value) for key, value in sorted(table[column].value_counts().items())}


def build(
    sources: Mapping[Path, Recipe], out: Path, *, progress: Progress = silent, **options: Any
) -> DanceLibrary:
    """Build one library from folders of takes and how each is read; see `write_library` for the options.

    Takes of several folders are told apart by the name of their data set.
    """
    total = sum(len(files_in(Path(folder), recipe)) for folder, recipe in sources.items())
    takes = (
        take if len(sources) == 1 else replace(take, name=f"{recipe.data_set}/{take.name}")
        for folder, recipe in sources.items()
        for path in files_in(Path(folder), recipe)
        for take in read_takes(path, Path(folder), recipe)
    )
    name = "+".join(dict.fromkeys(recipe.data_set for recipe in sources.values()))
    return write_library(progress(takes, label="Reading takes", total=total), out, name=name, **options)
