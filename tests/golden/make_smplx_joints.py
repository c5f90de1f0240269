"""Writes smplx_joints.npz: where smplx 0.1.28 puts the joints of a body of our rest offsets in random poses.

Run by `make test-smplx`, or by hand where torch 2.13.0 and smplx 0.1.28 are installed:
    python tests/golden/make_smplx_joints.py tests/golden/smplx_joints.npz

The model is synthetic and of SMPL's layout (6890 vertices, 24 joints, 10 shape and 207 pose directions); its
joint regressor picks the first 24 vertices of the template, which are the rest joints of the neutral body.
The other vertices are random numbers and have no part in the joints.
"""

from __future__ import annotations

import sys

import numpy as np
import smplx
import torch

from studykit.motion.skeleton import NEUTRAL_BODY, NEUTRAL_PELVIS

POSES = 20


def model(rng: np.random.Generator) -> smplx.SMPL:
    """Make a model whose rest joints are those of the neutral body."""
    rest = np.zeros((24, 3))
    for joint, parent in enumerate(NEUTRAL_BODY.parents):
        rest[joint] = NEUTRAL_BODY.offsets[joint] + (NEUTRAL_PELVIS if parent < 0 else rest[parent])
    vertices = 6890
    template = np.concatenate((rest, rng.normal(size=(vertices - 24, 3))))
    arrays = {
        "v_template": template,
        "J_regressor": np.eye(24, vertices),
        "shapedirs": np.zeros((vertices, 3, 10)),
        "posedirs": np.zeros((vertices, 3, 207)),
        "weights": rng.dirichlet(np.ones(24), vertices),
        "kintree_table": np.array([[2**32 - 1, *NEUTRAL_BODY.parents[1:]], range(24)], dtype=np.int64),
        "f": np.zeros((1, 3), dtype=np.int64),
    }
    return smplx.SMPL(
        "", data_struct=smplx.utils.Struct(**arrays), batch_size=POSES, dtype=torch.float64, num_betas=10
    )


def main(out: str) -> None:
    """Pose the model and write rotation vectors, translations and joints."""
    rng = np.random.default_rng(20240)
    axes = rng.normal(size=(POSES, 24, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    vectors = axes * rng.uniform(0.001, np.pi, (POSES, 24, 1))
    vectors[0] = 0.0
    translations = rng.normal(size=(POSES, 3))
    with torch.no_grad():
        posed = model(rng)(
            global_orient=torch.tensor(vectors[:, 0]),
            body_pose=torch.tensor(vectors[:, 1:].reshape(POSES, 69)),
            transl=torch.tensor(translations),
        )
    joints = posed.joints[:, :24].numpy()
    np.savez_compressed(out, rotation_vectors=vectors, translations=translations, joints=joints)


if __name__ == "__main__":
    main(sys.argv[1])
