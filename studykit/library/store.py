"""A dance library as a folder: a manifest, an index and shards.

`manifest.json` says what it is; it names the index in use and is replaced last, at one stroke.
`index-DIGEST/` has one row a segment (Parquet), one row a take (CSV), small arrays and the calibration.
`takes/` has one shard for each file of takes: movement and features of its segments.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from studykit.choreography.dance_library import Calibration, DanceLibrary
from studykit.choreography.reduction import Reduced
from studykit.core import durable
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.io.datasets.recipe import Recipe
from studykit.library import shard
from studykit.library.measure import LARGE, SMALL
from studykit.library.origin import Origin
from studykit.library.rating.targets import RatedTargets
from studykit.library.shard import SegmentRows
from studykit.motion.features import FeatureScaler

if TYPE_CHECKING:
    import pandas as pd

VERSION = 3
MANIFEST = "manifest.json"
SEGMENTS = "segments.parquet"
TAKES = "takes.csv"
SHARDS = "shards.json"
CALIBRATION = "calibration.npz"
COORDINATES = "reduced-coordinates.npy"
RESIDUALS = "reduced-residuals.npy"
SOURCES = "sources.json"
LOCK = "building.lock"

_SCALER = ("kinetic_medians", "means", "deviations")
_AGAIN = "build it again"


def beside(library: Path, ending: str) -> Path:
    """Name a file that belongs to a library and lies beside its folder, so that it outlives it."""
    folder = library.resolve()
    return folder.with_name(f"{folder.name}.{ending}")


@contextmanager
def folder_to_build(out: Path, origin: Origin) -> Iterator[None]:
    """Make the folder of a library, or take up the one that is there; no other build works on it meanwhile.

    What cannot be built leaves nothing behind; what was interrupted stays, so that it can go on.

    Raises
    ------
    InputError
        If something else is in the folder, another build is at work on it, or it cannot be written.
    """
    from filelock import FileLock, Timeout

    if out.exists():
        _require_continuation(out, origin)
    made = [path for path in (out, *out.parents) if not path.exists()]
    lock = FileLock(out / LOCK, blocking=False)
    try:
        (out / shard.FOLDER).mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout as error:
        remedy = "wait until it is done"
        raise InputError("another build is at work on it", where=out, remedy=remedy) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written ({reason})", where=out, remedy="choose another folder"
        ) from error
    try:
        with lock:
            yield
    except InputError as error:
        # A disk that is full costs no work that was done.
        if made and not isinstance(error.__cause__, OSError):
            shutil.rmtree(out, ignore_errors=True)
            for parent in made[1:]:
                with suppress(OSError):  # somebody else has put something there
                    parent.rmdir()
        raise


def _require_continuation(out: Path, origin: Origin) -> None:
    if not (out / MANIFEST).exists():
        if out.is_dir() and all(_is_ours(path) for path in out.iterdir() if not path.name.startswith(".")):
            return
        remedy = "choose another folder or remove it"
        raise InputError("there is something already", where=out, remedy=remedy)
    try:
        manifest = read_manifest(out)
    except InputError as error:
        remedy = "remove it and build it again, or choose another folder"
        raise InputError(error.problem, where=error.where, remedy=remedy) from error
    if not origin.continues(Origin(**manifest["origin"])):
        raise InputError(
            f"holds a library of other takes ({manifest['name']})",
            where=out,
            remedy="give all its folders again, choose another folder or remove it",
        )


def _is_ours(path: Path) -> bool:
    """Tell whether an interrupted build left this."""
    if path.name == shard.FOLDER:
        return path.is_dir() and all(shard.is_part(part) for part in path.iterdir())
    return path.name == LOCK or is_index(path)


def is_index(path: Path) -> bool:
    """Tell whether this is an index that a build made, whole or not."""
    return re.fullmatch(r"index-[0-9a-f]{12}(\.partial)?", path.name) is not None


def read_manifest(library: str | Path) -> dict[str, Any]:
    """Read what a library says of itself.

    Raises
    ------
    InputError
        If the folder is not a library of this version, or its build was interrupted.
    """
    library = Path(library)
    path = library / MANIFEST
    if (library / shard.FOLDER).is_dir() and not path.exists():
        remedy = "run the same build again: it goes on where it was"
        raise InputError("a library that is not finished", where=library, remedy=remedy)
    try:
        manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        version = manifest["version"]
    except (OSError, ValueError, KeyError, TypeError):
        remedy = "build one with 'studykit library build' or 'studykit library sample'"
        raise InputError("not a dance library", where=library, remedy=remedy) from None
    if version != VERSION:
        raise InputError(
            f"a library of version {version}, this studykit reads {VERSION}",
            where=path,
            remedy="remove the library and build it again",
        )
    return manifest


def read_shards(index: Path) -> dict[str, dict[str, Any]]:
    """Read which shards an index is over, in the order of its segments."""
    shards: dict[str, dict[str, Any]] = json.loads((index / SHARDS).read_text(encoding="utf-8"))
    return shards


def read_takes(library: str | Path) -> pd.DataFrame:
    """Read what became of every take of a library, and why where nothing did; one row a take.

    Returns
    -------
    DataFrame
        `take, data_set, performer, genre, licence, partners, notes, status, reason, duration_s,
        frame_rate_hz, segments_possible, segments_kept, segments_paper, frames_RULE, frames_kept_by_hand,
        frames_cut_by_hand`; counts are missing where the status is "refused".
    """
    import pandas as pd

    table = pd.read_csv(index_folder(library) / TAKES, keep_default_na=False, dtype=str)
    counts = [name for name in table if str(name).startswith(("segments_", "frames_"))]
    numbers = table[[*counts, "duration_s", "frame_rate_hz"]].apply(pd.to_numeric, errors="coerce")
    return table.assign(**numbers.astype(dict.fromkeys(counts, "Int64")))


def write_calibration(path: Path, scaler: FeatureScaler, calibration: Calibration) -> None:
    """Save how features are scaled and what is light, intense, varied and smooth."""
    arrays = {name: getattr(scaler, name) for name in _SCALER}
    arrays |= {name: getattr(calibration, name) for name in Calibration.array_names()}
    np.savez(path, median_distance=calibration.median_distance, **arrays)


def read_calibration(path: Path) -> tuple[FeatureScaler, Calibration]:
    """Read what `write_calibration` saved."""
    # NumPy leaves an archive that it cannot read open; a file of our own is closed.
    with path.open("rb") as file, np.load(file, allow_pickle=False) as saved:
        scaler = FeatureScaler(**{name: saved[name] for name in _SCALER})
        calibration = Calibration(
            median_distance=float(saved["median_distance"]),
            **{name: saved[name] for name in Calibration.array_names()},
        )
    return scaler, calibration


def read_rated(library: Path) -> RatedTargets | None:
    """Read the raters' targets of a library, or None where its percentiles hold."""
    manifest = read_manifest(library)
    if manifest["rated"] is None:
        return None
    path = library / manifest["index"] / manifest["rated"]
    if sha256_of_file(path) != manifest["files"][path.name]:
        raise ValueError(f"{path.name} is not what was written")
    return RatedTargets.from_dict(json.loads(path.read_text(encoding="utf-8")))


def write_folders(library: Path, folders: Mapping[str, Recipe]) -> None:
    """Remember, beside a library, which folders it was built from; no place is named within it."""
    told = {
        folder: recipe.model_dump(mode="json", exclude_defaults=True) for folder, recipe in folders.items()
    }
    durable.put(beside(library, SOURCES), json.dumps(told, indent=1, ensure_ascii=False) + "\n")


def read_folders(library: Path) -> dict[str, Recipe]:
    """Give the folders that a library was built from, and how each was read; none if nobody knows."""
    path = beside(library, SOURCES)
    if not path.exists():
        return {}
    told = json.loads(path.read_text(encoding="utf-8"))
    return {folder: Recipe.model_validate(recipe) for folder, recipe in told.items()}


def load(
    library: Path, folder: Path, *, name: str, scaler: FeatureScaler, calibration: Calibration, sha256: str
) -> DanceLibrary:
    """Put a library together from the files of an index; arrays stay on disk until rows are used."""
    import pandas as pd

    segments = pd.read_parquet(folder / SEGMENTS)
    shards = read_shards(folder)
    keys, counts = list(shards), [one["segments"] for one in shards.values()]
    arrays: dict[str, Any] = {key: _mapped(folder / f"{key}.npy") for key in (*SMALL, "successors")}
    arrays |= {key: SegmentRows(library, key, keys, counts) for key in LARGE}
    if any(len(array) != len(segments) for array in arrays.values()):
        raise ValueError("arrays of different length")
    for one in shards.values():
        for file, size in one["sizes"].items():
            if (library / shard.FOLDER / file).stat().st_size != size:
                raise ValueError(f"{shard.FOLDER}/{file} is cut off")
    if (folder / COORDINATES).exists():
        coordinates, residuals = _mapped(folder / COORDINATES), _mapped(folder / RESIDUALS)
        arrays["reduced"] = Reduced(coordinates=coordinates, residuals=residuals)
    return DanceLibrary(
        name=name, segments=segments, scaler=scaler, calibration=calibration, sha256=sha256, **arrays
    )


def _mapped(path: Path) -> Any:
    return np.asarray(np.load(path, mmap_mode="r", allow_pickle=False))


def write_reduced(folder: Path, said: Reduced) -> None:
    """Write down where the segments lie along few axes."""
    np.save(folder / COORDINATES, said.coordinates, allow_pickle=False)
    np.save(folder / RESIDUALS, said.residuals, allow_pickle=False)


def open_library(path: str | Path) -> DanceLibrary:
    """Open a dance library; its large arrays stay on disk until rows are used.

    Parameters
    ----------
    path : str or Path
        The folder that 'studykit library build' or 'sample' made.

    Raises
    ------
    InputError
        If the folder is not a library or one of its files is missing or broken.
    """
    library = Path(path).resolve()
    manifest = read_manifest(library)
    try:
        folder = library / manifest["index"]
        scaler, calibration = read_calibration(folder / CALIBRATION)
        rated = read_rated(library)
        if rated is not None:
            means = {name: getattr(rated, name) for name in ("linear_energy", "rotational_energy", "variety")}
            calibration = replace(calibration, rated=means)
        return load(
            library,
            folder,
            name=manifest["name"],
            scaler=scaler,
            calibration=calibration,
            sha256=manifest["sha256"],
        )
    except InputError as error:
        raise InputError(f"broken library ({error.problem})", where=library, remedy=_AGAIN) from error
    except (OSError, ValueError, EOFError, KeyError, TypeError, AttributeError, BadZipFile) as error:
        raise InputError(f"broken library ({error})", where=library, remedy=_AGAIN) from error


def index_folder(library: str | Path) -> Path:
    """Give the folder of the index in use."""
    return Path(library) / str(read_manifest(library)["index"])


def require_intact(library: Path) -> None:
    """Compare every file of a library with its digest.

    Raises
    ------
    InputError
        Names the first file that is not what was written.
    """
    manifest = read_manifest(library)
    shards = read_shards(index_folder(library))
    expected = {library / manifest["index"] / name: digest for name, digest in manifest["files"].items()}
    expected |= {
        library / shard.FOLDER / name: digest
        for one in shards.values()
        for name, digest in one["sha256"].items()
    }
    for path, digest in expected.items():
        if not path.exists() or sha256_of_file(path) != digest:
            raise InputError("is not what was written", where=path, remedy=_AGAIN)
