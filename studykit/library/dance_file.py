"""Dances as files: an SMPL archive, files for animation programs, and a JSON with every number."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.durable import put
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_bytes, sha256_of_file
from studykit.io.bvh import bvh_text
from studykit.io.datasets.smpl_npz import amass_arrays, read_smpl_npz
from studykit.io.gltf import glb
from studykit.io.joint_table import joint_table_text
from studykit.motion.motion import Motion


def write_dances(dances: Mapping[str, Dance], folder: str | Path, *, with_joint_tables: bool = False) -> None:
    """Write each dance as CONDITION.npz, .bvh, .glb and .json.

    The archive is one of AMASS (SMPL-H, Z up, m and rad); BVH (cm, Y up) and binary glTF (m, Y up, with an
    avatar on which spared joints have a colour of their own) open in Blender and elsewhere. The JSON comes
    last: where it is, the others are whole. A dance that is there already stays as it is; only files that it
    lacks are added.

    Parameters
    ----------
    dances : mapping of str to Dance
        By condition.
    folder : path
        Is made if need be.
    with_joint_tables : bool
        Also write CONDITION.csv: where every joint is at every time, m.

    Raises
    ------
    InputError
        If the folder cannot be written, another dance of the same name is in it, or a name leads elsewhere.
    """
    folder = Path(folder)
    for condition in dances:
        if Path(condition).name != condition:
            raise InputError(
                f'"{condition}" is no name of a file', where=folder, remedy="name dances by their conditions"
            )
    there = {name: read_dance(folder, name) for name in dances if (folder / f"{name}.json").exists()}
    for condition, other in sorted(there.items()):
        if other.sha256 != dances[condition].sha256:
            raise InputError(
                f"another dance {condition} is there already (seed {other.seed})",
                where=folder,
                remedy="choose another folder",
            )
    views: dict[str, Callable[[Dance], str | bytes]] = {".bvh": _bones, ".glb": _avatar}
    views |= {".csv": _joints} if with_joint_tables else {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for condition, dance in dances.items():
            recorded = there.get(condition)
            for suffix, view in views.items():
                path = folder / f"{condition}{suffix}"
                if recorded is None or not path.exists():
                    put(path, view(recorded or dance))
            if recorded is None:
                _put_record(dance, folder / condition)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written ({reason})", where=folder, remedy="choose another folder"
        ) from error


def _put_record(dance: Dance, stem: Path) -> None:
    """Write the archive, and then the JSON that vouches for it."""
    archive = io.BytesIO()
    np.savez(archive, **amass_arrays(dance.motion))
    put(stem.with_name(f"{stem.name}.npz"), archive.getvalue())
    values = dance.to_dict() | {"motion_sha256": sha256_of_bytes(archive.getvalue())}
    put(stem.with_name(f"{stem.name}.json"), json.dumps(values, indent=1, ensure_ascii=False) + "\n")


def _bones(dance: Dance) -> str:
    return bvh_text(dance.motion)


def _joints(dance: Dance) -> str:
    return joint_table_text(dance.motion)


def _avatar(dance: Dance) -> bytes:
    """Write the avatar, with what a stranger must know who finds the file alone."""
    return glb(
        dance.motion,
        name=dance.condition,
        spared=dance.mask.spared if dance.mask else (),
        extras={
            "condition": dance.condition,
            "is_synthetic": dance.is_synthetic,
            "licences": sorted({segment.licence for segment in dance.segments}),
            "sha256": dance.sha256,
        },
    )


def read_dance(folder: str | Path, condition: str) -> Dance:
    """Read a dance back.

    Raises
    ------
    InputError
        If it is not there, one of its files is broken, or its movement was changed.
    """
    stem = Path(folder) / condition
    try:
        values = json.loads(stem.with_name(f"{condition}.json").read_text(encoding="utf-8"))
        motion = _read_motion(stem.with_name(f"{condition}.npz"), values["motion_sha256"])
        return Dance.from_dict(values, motion)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"no dance can be read ({error})", where=stem, remedy="make it again with 'studykit choreograph'"
        ) from error


def _read_motion(archive: Path, sha256: str) -> Motion:
    """Read the movement, if it is the one that was written."""
    if sha256_of_file(archive) != sha256:
        raise ValueError("its movement is not the one that was written")
    return read_smpl_npz(archive)


def read_dances(folder: str | Path) -> dict[str, Dance]:
    """Read all dances of a folder, by condition."""
    names = sorted(path.stem for path in Path(folder).glob("*.json"))
    if not names:
        raise InputError("no dances here", where=folder, remedy="make them with 'studykit choreograph'")
    return {name: read_dance(folder, name) for name in names}
