"""Writes AMASS as it is distributed: Z up, SMPL-H (one array of 52 joints) or SMPL-X (55)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

RATE_HZ = None
DANCERS = 1
RECIPE = {"format": "amass"}
COLLECTION, SUBJECT = "DanceDB", "20120911_Somebody"
PERFORMER = f"{COLLECTION} {SUBJECT}"
JOINTS = range(22)
SMPL_PELVIS = (-0.001795, -0.223333, 0.028219)
SMPLX_PELVIS = (0.0031, -0.3514, 0.0120)
Z_UP = Rotation.from_euler("x", 90, degrees=True)  # (x, y, z) with Y up becomes (x, -z, y)


def write(
    folder: Path,
    dance: dict[str, np.ndarray],
    *,
    smplx: bool = False,
    gender: object = "female",
    joined: bool = True,
) -> Path:
    """Write COLLECTION/SUBJECT/TAKE_poses.npz or TAKE_stageii.npz, and the subject's shape.

    SMPL-X files have all joints in one array, and again in several; not `joined`, only in several. Theirs
    are of men, and one of their arrays holds objects.
    """
    vectors, pelvis = dance["vectors"][0], dance["pelvis"][0]
    finite = np.isfinite(vectors[:, 0]).all(axis=1)
    root = np.full((len(vectors), 3), np.nan)
    root[finite] = (Z_UP * Rotation.from_rotvec(vectors[finite, 0])).as_rotvec()
    place = np.einsum("ab,tb->ta", Z_UP.as_matrix(), pelvis)
    body = vectors[:, 1:22].reshape(len(vectors), 63)
    hands = np.random.default_rng(2).normal(scale=0.2, size=(len(vectors), 90))
    subject = folder / COLLECTION / SUBJECT
    subject.mkdir(parents=True)
    rate = np.array(float(dance["rate"]))
    if smplx:
        path = subject / "Andria_Happy_v1_stageii.npz"
        face = np.full((len(vectors), 9), 0.1)
        poses = np.concatenate((root, body, face, hands), axis=1)
        np.savez(
            path,
            **({"poses": poses} if joined else {}),
            root_orient=root,
            pose_body=body,
            pose_hand=hands,
            pose_jaw=face[:, :3],
            pose_eye=face[:, 3:],
            markers_latent_vids=np.array({"ARIEL": 3}, dtype=object),
            trans=place - np.array(SMPLX_PELVIS),
            betas=np.zeros(16),
            gender=np.array("male"),
            mocap_frame_rate=rate,
            surface_model_type=np.array("smplx"),
        )
        np.savez(subject / "neutral_stagei.npz", betas=np.zeros(16))
    else:
        path = subject / "Andria_Happy_v1_poses.npz"
        np.savez(
            path,
            trans=place - np.array(SMPL_PELVIS),
            poses=np.concatenate((root, body, hands), axis=1),
            betas=np.zeros(16),
            dmpls=np.zeros((len(vectors), 8)),
            gender=np.array(gender),
            mocap_framerate=rate,
        )
        np.savez(subject / "shape.npz", betas=np.zeros(16), gender=np.array(gender))
    return path
