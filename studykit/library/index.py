"""The index over the shards of a library: tables, small arrays, calibration, manifest."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file, sha256_of_value, versions
from studykit.core.seeding import stream
from studykit.library import shard, store
from studykit.library.calibrate import UNCALIBRATED, calibrate, fit_scaler
from studykit.library.measure import SMALL, Settings
from studykit.library.origin import Origin
from studykit.library.rating.targets import RatedTargets
from studykit.library.shard import SegmentRows
from studykit.motion.segmentation import SEGMENT_S

if TYPE_CHECKING:
    import pandas as pd

    from studykit.choreography.dance_library import DanceLibrary

Outcome = dict[str, Any]
"""What `build.make_shard` gives of one source, with its `name`, `prefix` and `data_set`."""


def write(library: Path, outcomes: Sequence[Outcome], origin: Origin, settings: Settings) -> None:
    """Write the index over the shards and make it the one in use; does nothing if it is so already.

    Raises
    ------
    InputError
        If no segment is left, or too few to calibrate.
    """
    kept = [told for told in outcomes if any(take["starts_s"] for take in told["takes"])]
    if not kept:
        _refuse(outcomes, origin)
    causes = {
        "version": store.VERSION,
        "shards": [told.get("key") or told["refused"] for told in outcomes],
        "names": [told["name"] for told in outcomes],
        "origin": asdict(origin),
        "settings": asdict(settings),
        "versions": versions(),
    }
    folder = library / f"index-{sha256_of_value(causes)[:12]}"
    if not (folder.exists() and _in_use(library) == folder.name):
        partial = folder.with_name(f"{folder.name}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir()
        manifest = _write_files(library, partial, outcomes, origin, seed=settings.seed)
        manifest |= {**asdict(settings), "index": folder.name}
        for path in partial.iterdir():
            _put_on_disk(path)
        shutil.rmtree(folder, ignore_errors=True)
        partial.rename(folder)
        put_manifest(library, manifest)
    _clean(library, folder.name, {told["key"] for told in outcomes if "key" in told})


def _refuse(outcomes: Sequence[Outcome], origin: Origin) -> None:
    refused = [told["refused"] for told in outcomes if "refused" in told]
    if refused and len(refused) == len(outcomes):
        raise InputError(refused[0]["problem"], where=refused[0]["where"], remedy=refused[0]["remedy"])
    raise InputError(
        "no segment is left after cleaning", where=origin.name, remedy="give longer or cleaner takes"
    )


def _in_use(library: Path) -> str | None:
    if not (library / store.MANIFEST).exists():
        return None
    return str(store.read_manifest(library)["index"])


def _write_files(
    library: Path, folder: Path, outcomes: Sequence[Outcome], origin: Origin, *, seed: int
) -> dict[str, Any]:
    """Write all files of an index but the manifest, which is given back."""
    shards = {
        told["key"]: {
            "prefix": told["prefix"],
            "segments": sum(len(take["starts_s"]) for take in told["takes"]),
            "size": told["sizes"].get(f"{told['key']}.npy"),
            "sha256": told["sha256"].get(f"{told['key']}.npy"),
        }
        for told in outcomes
        if "key" in told
    }
    (folder / store.SHARDS).write_text(json.dumps(shards) + "\n", encoding="utf-8")
    counts = [one["segments"] for one in shards.values()]
    small = [
        np.load(shard.small_path(library, key), allow_pickle=False)
        for key, count in zip(shards, counts, strict=True)
        if count
    ]
    arrays = {name: np.concatenate([rows[name] for rows in small]) for name in SMALL}
    for name, array in arrays.items():
        np.save(folder / f"{name}.npy", array, allow_pickle=False)
    segments = segment_table(outcomes)
    for kind in ("linear", "rotational"):
        segments[f"{kind}_energy"] = arrays[f"{kind}_energies"].sum(axis=1)
    segments.to_parquet(folder / store.SEGMENTS, index=False)
    takes = take_table(outcomes)
    takes.to_csv(folder / store.TAKES, index=False)
    scaler = fit_scaler(SegmentRows(library, "features", list(shards), counts))
    store.write_calibration(folder / store.CALIBRATION, scaler, UNCALIBRATED)
    uncalibrated = store.load(
        library, folder, name=origin.name, scaler=scaler, calibration=UNCALIBRATED, sha256=""
    )
    calibration = calibrate(uncalibrated, stream(seed, "calibration"))
    store.write_calibration(folder / store.CALIBRATION, scaler, calibration)
    return _manifest(folder, uncalibrated, takes, origin)


def segment_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Give one row a segment: its number, take, source and place, in the order of the shards."""
    import pandas as pd

    columns: dict[str, list[Any]] = {
        name: []
        for name in (
            "take", "data_set", "performer", "genre", "licence", "start_s", "is_synthetic", "mirrored",
            "partners", "take_sha256",
        )
    }  # fmt: skip
    for told in outcomes:
        for take in told["takes"]:
            source, count = take["source"], len(take["starts_s"])
            columns["take"] += [told["prefix"] + take["name"]] * count
            for name in ("data_set", "performer", "genre", "licence", "is_synthetic"):
                columns[name] += [source[name]] * count
            columns["start_s"] += take["starts_s"]
            columns["mirrored"] += take["is_mirrored"]
            columns["partners"] += [_joined(told, source["partners"])] * count
            columns["take_sha256"] += [source["sha256"]] * count
    return pd.DataFrame({"id": np.arange(len(columns["take"])), **columns})


def _joined(told: Outcome, names: Sequence[str]) -> str:
    return " ".join(told["prefix"] + name for name in names)


def take_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Give one row a take: what became of it, and why where nothing did."""
    import pandas as pd

    rows: list[dict[str, Any]] = []
    for told in outcomes:
        if "refused" in told:
            refused = told["refused"]
            reason = f"{refused['where']}: {refused['problem']}; {refused['remedy']}."
            rows.append(
                {"take": told["name"], "data_set": told["data_set"], "status": "refused", "reason": reason}
            )
        for take in told["takes"]:
            source = {name: take["source"][name] for name in ("data_set", "performer", "genre", "licence")}
            kept = bool(take["starts_s"])
            rows.append(
                {"take": told["prefix"] + take["name"]}
                | source
                | {"partners": _joined(told, take["source"]["partners"])}
                | {"notes": take["source"]["notes"]}
                | {"status": "kept" if kept else "empty", "reason": "" if kept else _why(take["outcome"])}
                | take["outcome"]
            )
    table = pd.DataFrame(rows)
    counts = [name for name in table if str(name).startswith(("segments_", "frames_"))]
    return table.astype(dict.fromkeys(counts, "Int64"))


def _why(outcome: dict[str, Any]) -> str:
    if not outcome["segments_possible"]:
        return f"shorter than {SEGMENT_S:g} s"
    return f"no {SEGMENT_S:g} s without a flagged frame"


def _manifest(folder: Path, library: DanceLibrary, takes: pd.DataFrame, origin: Origin) -> dict[str, Any]:
    table = library.segments
    files = {path.name: sha256_of_file(path) for path in sorted(folder.iterdir())}

    def counts(column: str) -> dict[str, int]:
        return {str(key): int(value) for key, value in sorted(table[column].value_counts().items())}

    used = takes[takes["status"] != "refused"]
    return {
        "version": store.VERSION,
        "name": origin.name,
        "sha256": sha256_of_value(files),
        "is_synthetic": library.is_synthetic,
        "segments": len(library),
        "hours": round(len(library) * SEGMENT_S / 3600.0, 6),
        "takes": len(used),
        "takes_refused": int((takes["status"] == "refused").sum()),
        "recorded_hours": round(float(used["duration_s"].sum()) / 3600.0, 6),
        "segments_kept": int(used["segments_kept"].sum()),
        "segments_possible": int(used["segments_possible"].sum()),
        "segments_paper": int(used["segments_paper"].sum()),
        **{f"{name}s": counts(name) for name in ("data_set", "genre", "performer", "licence")},
        "origin": asdict(origin),
        "files": files,
        "versions": versions(),
    }


def _put_on_disk(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())


def put_manifest(library: Path, manifest: dict[str, Any]) -> None:
    """Make a library what its manifest says, at one stroke: until now it was the older one."""
    path = library / store.MANIFEST
    partial = path.with_name(f"{path.name}.partial")
    with partial.open("w", encoding="utf-8") as file:
        file.write(json.dumps(manifest, indent=1, ensure_ascii=False) + "\n")
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def adopt(library: Path, rated: RatedTargets | None) -> None:
    """Let the raters' targets hold in a library, or its percentiles again.

    Parameters
    ----------
    library : Path
        The folder of the library.
    rated : RatedTargets or None
        What the raters said; None takes it back.
    """
    manifest = store.read_manifest(library)
    folder = library / manifest["index"]
    files = {name: digest for name, digest in manifest["files"].items() if name != store.RATED}
    if rated is not None:
        path = folder / store.RATED
        path.write_text(json.dumps(rated.as_dict(), indent=1) + "\n", encoding="utf-8")
        _put_on_disk(path)
        files[store.RATED] = sha256_of_file(path)
    # The manifest says whether the file counts, and is replaced at one stroke.
    put_manifest(library, manifest | {"files": files, "sha256": sha256_of_value(files)})
    if rated is None:
        (folder / store.RATED).unlink(missing_ok=True)


def _clean(library: Path, index: str, keys: set[str]) -> None:
    """Remove what the index in use does not need: older indexes, other shards, half-written files."""
    for path in library.iterdir():
        if path.name.startswith("index-") and path.name != index:
            shutil.rmtree(path)
    for path in (library / shard.FOLDER).iterdir():
        if path.name.partition(".")[0] not in keys or path.suffix == ".partial":
            path.unlink()
    (library / f"{store.MANIFEST}.partial").unlink(missing_ok=True)
