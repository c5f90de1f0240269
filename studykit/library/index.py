"""What all takes of a library give together: tables, small arrays, calibration, manifest."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studykit.choreography.dance_library import DENSE_LIMIT
from studykit.choreography.reduction import reduced
from studykit.core import durable
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.provenance import sha256_of_bytes, sha256_of_file, sha256_of_value, versions
from studykit.core.seeding import stream
from studykit.library import shard, store
from studykit.library.calibrate import UNCALIBRATED, calibrate, fit_scaler
from studykit.library.measure import SMALL, Settings
from studykit.library.origin import Origin
from studykit.library.rating.plan import segments_digest
from studykit.library.rating.targets import RatedTargets
from studykit.library.shard import SegmentRows
from studykit.motion.segmentation import SEGMENT_S

if TYPE_CHECKING:
    import pandas as pd

    from studykit.choreography.dance_library import DanceLibrary

INDEXES = 2
"""Raised when the same shards give another index, so that older ones are written again."""

Outcome = dict[str, Any]
"""What `build.make_shard` gives of one source, with its `name`, `prefix` and `data_set`."""


def write(
    library: Path,
    outcomes: Sequence[Outcome],
    origin: Origin,
    settings: Settings,
    *,
    strays: int = 0,
    progress: Progress = silent,
) -> None:
    """Write down what all takes together give, and make it the library in use; nothing if it is so already.

    Parameters
    ----------
    library : Path
        The folder of the library.
    outcomes : sequence of dict
        What became of each source, in order.
    origin : Origin
        Where the takes come from.
    settings : Settings
        How they were cut; its seed draws the chains of the calibration.
    strays : int
        Decisions of a reviewer on takes that are not there.
    progress : Progress
        Told of each chain measured.

    Raises
    ------
    InputError
        If no segment is left, or too few to calibrate.
    """
    kept = [told for told in outcomes if any(take["starts_s"] for take in told["takes"])]
    if not kept:
        _refuse(outcomes, origin)
    causes = {
        "indexes": INDEXES,
        "shards": [told.get("key") or told["refused"] for told in outcomes],
        "names": [told["name"] for told in outcomes],
        "origin": asdict(origin),
        "settings": asdict(settings),
        "strays": strays,
        "versions": versions(),
    }
    folder = library / f"index-{sha256_of_value(causes)[:12]}"
    older = store.read_manifest(library) if (library / store.MANIFEST).exists() else None
    if older is None or older["index"] != folder.name or not _is_intact(folder, older):
        partial = folder.with_name(f"{folder.name}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir()
        manifest = _write_files(library, partial, outcomes, origin, seed=settings.seed, progress=progress)
        manifest |= {**asdict(settings), "index": folder.name}
        manifest["decisions_ignored"] += strays
        manifest |= _carried_over(library, older, partial, manifest)
        durable.settle(partial)
        shutil.rmtree(folder, ignore_errors=True)
        partial.rename(folder)
        put_manifest(library, manifest)
    _clean(library, folder.name, {told["key"] for told in outcomes if "key" in told})


def _is_intact(folder: Path, manifest: dict[str, Any]) -> bool:
    return all(
        (folder / name).exists() and sha256_of_file(folder / name) == digest
        for name, digest in manifest["files"].items()
    )


def _carried_over(
    library: Path, older: dict[str, Any] | None, partial: Path, manifest: dict[str, Any]
) -> dict[str, Any]:
    """Keep the raters' targets where they are whole and the segments those that were rated; else say so."""
    rated = older["rated"] if older else None
    if older is None or rated is None:
        return {}
    source = library / older["index"] / rated
    is_whole = source.exists() and sha256_of_file(source) == older["files"][rated]
    if not is_whole or older["segments_digest"] != manifest["segments_digest"]:
        return {"rated_dropped": True}
    shutil.copyfile(source, partial / rated)
    files = manifest["files"] | {rated: older["files"][rated]}
    return {"rated": rated, "files": files, "sha256": sha256_of_value(files)}


def _refuse(outcomes: Sequence[Outcome], origin: Origin) -> None:
    refused = [told for told in outcomes if "refused" in told]
    if refused and len(refused) == len(outcomes):
        first = refused[0]["refused"]
        raise InputError(first["problem"], where=refused[0]["refused_at"], remedy=first["remedy"])
    raise InputError(
        "no segment is left after cleaning", where=origin.name, remedy="give longer or cleaner takes"
    )


def _write_files(
    library: Path,
    folder: Path,
    outcomes: Sequence[Outcome],
    origin: Origin,
    *,
    seed: int,
    progress: Progress,
) -> dict[str, Any]:
    """Write all files of an index but the manifest, which is given back."""
    from studykit.choreography.neighbours import successors

    shards = {
        told["key"]: {
            "prefix": told["prefix"],
            "segments": sum(len(take["starts_s"]) for take in told["takes"]),
            "sizes": told["sizes"],
            "sha256": told["sha256"],
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
    arrays["successors"] = successors(arrays["first_poses"], arrays["last_poses"])
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
    if len(segments) > DENSE_LIMIT:
        store.write_reduced(folder, reduced(uncalibrated, stream(seed, "axes")))
    calibration = calibrate(uncalibrated, stream(seed, "calibration"), progress=progress)
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
    names = _names(outcomes)
    for told in outcomes:
        for take in told["takes"]:
            source, count = take["source"], len(take["starts_s"])
            columns["take"] += [told["prefix"] + take["name"]] * count
            for name in ("data_set", "performer", "genre", "licence", "is_synthetic"):
                columns[name] += [source[name]] * count
            columns["start_s"] += take["starts_s"]
            columns["mirrored"] += take["is_mirrored"]
            columns["partners"] += [_partners(told, source["partners"], names)] * count
            columns["take_sha256"] += [source["sha256"]] * count
    return pd.DataFrame({"id": np.arange(len(columns["take"])), **columns})


def _names(outcomes: Sequence[Outcome]) -> set[str]:
    return {told["prefix"] + take["name"] for told in outcomes for take in told["takes"]}


def _partners(told: Outcome, partners: Sequence[str], names: set[str]) -> str:
    """Name the takes of the library that were danced together with one."""
    return "; ".join(name for one in partners if (name := told["prefix"] + one) in names)


def take_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Give one row a take: what became of it, and why where nothing did."""
    import pandas as pd

    rows: list[dict[str, Any]] = []
    names = _names(outcomes)
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
                | {"partners": _partners(told, take["source"]["partners"], names)}
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
        "segments_digest": segments_digest(library),
        "rated": None,
        "rated_dropped": False,
        "is_synthetic": library.is_synthetic,
        "segments": len(library),
        "hours": round(int(used["segments_kept"].sum()) * SEGMENT_S / 3600.0, 6),
        "takes": len(used),
        "takes_empty": int((takes["status"] == "empty").sum()),
        "takes_refused": int((takes["status"] == "refused").sum()),
        "recorded_hours": round(float(used["duration_s"].sum()) / 3600.0, 6),
        "segments_kept": int(used["segments_kept"].sum()),
        "segments_possible": int(used["segments_possible"].sum()),
        "segments_paper": int(used["segments_paper"].sum()),
        "decisions_ignored": int(used["decisions_ignored"].sum()),
        **{f"{name}s": counts(name) for name in ("data_set", "genre", "performer", "licence")},
        "origin": asdict(origin),
        "files": files,
        "versions": versions(),
    }


def put_manifest(library: Path, manifest: dict[str, Any]) -> None:
    """Make a library what its manifest says, at one stroke: until now it was the older one."""
    durable.put(library / store.MANIFEST, json.dumps(manifest, indent=1, ensure_ascii=False) + "\n")


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
    folder, older = library / manifest["index"], manifest["rated"]
    files = {name: digest for name, digest in manifest["files"].items() if name != older}
    name = None
    if rated is not None:
        text = json.dumps(rated.as_dict(), indent=1) + "\n"
        name = f"rated-targets-{sha256_of_bytes(text.encode())[:12]}.json"
        durable.put(folder / name, text)
        files[name] = sha256_of_bytes(text.encode())
    changed = {"rated": name, "rated_dropped": False, "files": files, "sha256": sha256_of_value(files)}
    put_manifest(library, manifest | changed)
    if older not in (None, name):
        (folder / older).unlink(missing_ok=True)


def _clean(library: Path, index: str, keys: set[str]) -> None:
    """Remove what the index in use does not need: older indexes, other shards, half-written files.

    Nothing that a build did not make is touched. What cannot be removed now is removed by the next build.
    """
    for path in library.iterdir():
        if store.is_index(path) and path.name != index:
            shutil.rmtree(path, ignore_errors=True)
        elif path.name.startswith(f".{store.MANIFEST}.") and path.suffix == ".partial":
            _remove(path)
    for path in (library / shard.FOLDER).iterdir():
        is_needed = path.name.partition(".")[0] in keys and path.suffix != ".partial"
        if shard.is_part(path) and not is_needed:
            _remove(path)


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()
