"""AIST++: ten street and jazz genres, danced by thirty people, fitted with SMPL."""

from __future__ import annotations

import re
from pathlib import Path

from studykit.core.errors import InputError
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.recipe import Recipe
from studykit.io.datasets.smpl_arrays import (
    movement,
    numbers,
    part,
    plain_stem,
    positive,
    rotation_vectors,
    same_length,
)
from studykit.io.packed import files_ending, read_text
from studykit.io.restricted_pickle import read_pickle
from studykit.motion.skeleton import AIST_BODY

FRAME_RATE_HZ = 60.0
SMALLEST_SCALING = 0.1
"""Less would make a giant; files in metres have 1."""
CITATION = (
    "AIST++ Dance Motion Dataset, R. Li, S. Yang, D. A. Ross, A. Kanazawa, 2021; "
    "derived from the AIST Dance Video Database."
)
LICENCE = "CC BY 4.0 (the annotations; not the videos and the music)"
GENRES = {
    "BR": "break",
    "PO": "pop",
    "LO": "lock",
    "MH": "middle hip-hop",
    "LH": "LA hip-hop",
    "HO": "house",
    "WA": "waack",
    "KR": "krump",
    "JS": "street jazz",
    "JB": "ballet jazz",
}

_SEQUENCE = re.compile(r"g([A-Z]{2})_s[A-Z]{2}_c\w+_d(\d{2})_m[A-Z]{2}\d_ch\d{2}")


class AistPlusPlus:
    """The SMPL fits of AIST++: folder `motions`, one pickle a sequence.

    A file has `smpl_poses` (frame, 72) in rad, `smpl_trans` (frame, 3) in the unit of the capture and
    `smpl_scaling`, which divides it to give metres. Y is up. The floor is not at 0: the constant by which
    SMPL's translation misses the pelvis is not known for this body, and no matter once the floor is found.
    """

    name = "aistpp"
    citation = CITATION
    licence = LICENCE
    native_format = "Pickles of SMPL parameters, motions/gBR_sBM_cAll_d04_mBR0_ch01.pkl, 60 frames a second"

    def recognises(self, folder: Path) -> bool:
        """Tell whether a folder, or its folder `motions`, has pickles with names of AIST."""
        return has_sequences(folder, "motions")

    def items(self, folder: Path) -> list[Path]:
        """List the sequences but for those that `ignore_list.txt` names: their fits are known to be wrong."""
        return sequences(folder, "motions")

    def companions(self, path: Path) -> list[Path]:  # noqa: ARG002
        """List nothing: a file stands alone."""
        return []

    def read(self, path: Path, recipe: Recipe) -> list[Performance]:  # noqa: ARG002
        """Read one sequence."""
        values = read_pickle(path)
        vectors = rotation_vectors(part(values, "smpl_poses", path), "smpl_poses", path)
        places = numbers(part(values, "smpl_trans", path), "smpl_trans", path, shape=(None, 3))
        same_length(vectors, places, "smpl_poses and smpl_trans", path)
        scaling = positive(part(values, "smpl_scaling", path), "smpl_scaling", path)
        if scaling < SMALLEST_SCALING:
            problem = f"smpl_scaling is {scaling:g}, where others have about 93"
            raise InputError(problem, where=path, remedy="export the file again, or leave it out")
        motion = movement(vectors, places / scaling, rate=FRAME_RATE_HZ, skeleton=AIST_BODY)
        return [Performance(motion=motion, performer=performer_of(path), genre=genre_of(path))]


def has_sequences(folder: Path, kind: str) -> bool:
    """Tell whether a folder, or one of that name in it, has pickles with names of AIST."""
    base = folder if folder.name == kind else folder / kind
    return any(_SEQUENCE.fullmatch(plain_stem(path)) for path in files_ending(base, ".pkl"))


def sequences(folder: Path, kind: str) -> list[Path]:
    """List the pickles of a folder, or of the one of that name in it, that are not to be ignored."""
    base = folder / kind if (folder / kind).is_dir() else folder
    ignored: set[str] = set()
    for place in (folder, folder.parent):
        ignore_list = place / "ignore_list.txt"
        if ignore_list.is_file():
            ignored |= {line.strip() for line in read_text(ignore_list).splitlines()}
    return [path for path in files_ending(base, ".pkl") if plain_stem(path) not in ignored]


def performer_of(path: Path) -> str:
    """Name the dancer of a sequence, such as "AIST d04"; empty if the file's name does not say."""
    found = _SEQUENCE.fullmatch(plain_stem(path))
    return f"AIST d{found[2]}" if found else ""


def genre_of(path: Path) -> str:
    """Name the genre of a sequence; empty if the file's name does not say.

    Raises
    ------
    InputError
        If the name has the form of AIST's and a genre that AIST does not have.
    """
    found = _SEQUENCE.fullmatch(plain_stem(path))
    if not found:
        return ""
    if found[1] not in GENRES:
        remedy = f"use one of {', '.join(GENRES)} in the file's name"
        raise InputError(f"AIST has no genre {found[1]}", where=path, remedy=remedy)
    return GENRES[found[1]]
