"""Dances as files: an SMPL archive, a BVH for animation programs, and a JSON with every number."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.io.bvh import bvh_text
from studykit.motion import rotation
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS


def write_dances(dances: Mapping[str, Dance], folder: str | Path) -> None:
    """Write each dance as CONDITION.npz, CONDITION.bvh and CONDITION.json.

    The archive has the layout of AMASS with SMPL's 24 joints: `poses` (frame, 72) axis-angle in rad, `trans`
    (frame, 3) m, `betas`, `gender`, `mocap_framerate`; Y is up. A dance that is there already stays.

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
    there = {condition for condition in dances if (folder / f"{condition}.json").exists()}
    for condition in sorted(there):
        other = read_dance(folder, condition)
        if other.sha256 != dances[condition].sha256:
            raise InputError(
                f"another dance {condition} is there already (seed {other.seed})",
                where=folder,
                remedy="choose another folder",
            )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for condition, dance in dances.items():
            if condition in there:
                continue
            motion = dance.motion
            np.savez(
                folder / f"{condition}.npz",
                poses=rotation.log(motion.rotations).reshape(len(motion), -1),
                trans=motion.root_positions - np.array(NEUTRAL_PELVIS),
                betas=np.zeros(10),
                gender=np.array("neutral"),
                mocap_framerate=np.array(motion.frame_rate_hz),
            )
            (folder / f"{condition}.bvh").write_text(bvh_text(motion), encoding="utf-8")
            digest = sha256_of_file(folder / f"{condition}.npz")
            text = json.dumps(dance.to_dict() | {"motion_sha256": digest}, indent=1, ensure_ascii=False)
            (folder / f"{condition}.json").write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be written ({reason})", where=folder, remedy="choose another folder"
        ) from error


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
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile) as error:
        raise InputError(
            f"no dance can be read ({error})", where=stem, remedy="make it again with 'studykit choreograph'"
        ) from error


def _read_motion(archive: Path, sha256: str) -> Motion:
    """Read the movement, if it is the one that was written."""
    if sha256_of_file(archive) != sha256:
        raise ValueError("its movement is not the one that was written")
    # NumPy leaves an archive that it cannot read open; a file of our own is closed.
    with archive.open("rb") as file, np.load(file, allow_pickle=False) as saved:
        poses = saved["poses"]
        return Motion(
            skeleton=NEUTRAL_BODY,
            rotations=rotation.exp(poses.reshape(len(poses), -1, 3)),
            root_positions=saved["trans"] + np.array(NEUTRAL_PELVIS),
            frame_rate_hz=float(saved["mocap_framerate"]),
        )


def read_dances(folder: str | Path) -> dict[str, Dance]:
    """Read all dances of a folder, by condition."""
    names = sorted(path.stem for path in Path(folder).glob("*.json"))
    if not names:
        raise InputError("no dances here", where=folder, remedy="make them with 'studykit choreograph'")
    return {name: read_dance(folder, name) for name in names}
