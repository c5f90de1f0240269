"""Dances on one page: what was asked, how close they came, and the dances themselves, to be watched."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from studykit import figures
from studykit.core.errors import InputError
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.kinematics import joint_positions
from studykit.reports.analyse import write
from studykit.reports.beside_library import BesideLibrary
from studykit.reports.dance_facts import facts
from studykit.reports.page import Picture, filled, picture

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance
    from studykit.choreography.dance_library import DanceLibrary
    from studykit.figures.canvas import PaperFigure

_FILES = {
    ".npz": "the movement as an SMPL archive in the layout of AMASS",
    ".bvh": "the movement for Blender and other animation programs",
    ".glb": "a figure that dances it, for viewers of 3-D models",
    ".csv": "where every joint is at every time, as a table",
    ".json": "every number of this page, and the search",
}


def write_dance_page(
    dances: Mapping[str, Dance],
    path: str | Path,
    *,
    library: DanceLibrary | None = None,
    notes: Sequence[str] = (),
    body_mass_kg: float = DEFAULT_BODY_MASS_KG,
) -> Path:
    """Write a page on which dances can be watched and judged: one file that needs nothing else.

    Parameters
    ----------
    dances : mapping of str to Dance
        By the name of their files. Of several, one is shown at a time.
    path : path
        The page, such as dances/dances.html. It links to the files of the dances that lie beside it.
    library : DanceLibrary, optional
        What the dances were made of: joins and limits are set beside what its dancers do themselves.
    notes : sequence of str
        What else is to be said at the top, such as arms put in from other segments.
    body_mass_kg : float
        Energies are told for this body mass.

    Returns
    -------
    Path
        The page. The same dances with the same files beside them give the same bytes.

    Raises
    ------
    InputError
        If there is no dance, one was made of another library, or the page cannot be written.
    """
    path = Path(path)
    if not dances:
        raise InputError("there is no dance to show", where=path, remedy="choreograph one first")
    beside = None if library is None else _beside(library, dances)
    shown = [
        facts(dance, body_mass_kg, beside) | _drawn(name, dance, path.parent, body_mass_kg)
        for name, dance in dances.items()
    ]
    page = filled(
        "dance.html.jinja",
        dances=shown,
        overview=_overview(list(dances.values()), body_mass_kg) if len(dances) > 1 else None,
        library_name="" if library is None else library.name,
        notes=notes,
        body_mass_kg=body_mass_kg,
        played=_played(dances, shown),
        player=resources.files("studykit.reports").joinpath("player.js").read_text(encoding="utf-8"),
    )
    write(path, page)
    return path


def _beside(library: DanceLibrary, dances: Mapping[str, Dance]) -> BesideLibrary:
    for name, dance in dances.items():
        if dance.library_sha256 != library.sha256:
            raise InputError(
                f"it was not made of the library {library.name}",
                where=name,
                remedy="give its own library, or none",
            )
    return BesideLibrary.measured(library)


def _drawn(name: str, dance: Dance, folder: Path, body_mass_kg: float) -> dict[str, Any]:
    """Give the name of a dance, its figures and its files."""
    return {
        "name": name,
        "pictures": _pictures(dance, body_mass_kg),
        "trace": picture(
            "The best chain",
            lambda: figures.search_trace(dance),
            "Top to bottom: its cost beside that of the other chains; the terms of the cost; temperature and "
            "width of the tolerances; number of segments; share of moves accepted.",
        ),
        "files": _files(folder, name),
    }


def _pictures(dance: Dance, body_mass_kg: float) -> list[Picture]:
    drawings: dict[str, tuple[Callable[[], PaperFigure], str]] = {
        "Poses": (
            lambda: figures.film_strip(dance),
            "The middle of the segment."
            if len(dance.segments) == 1
            else (
                "Above: the middle of each segment; the same letter is the same movement, a prime its mirror "
                "image. Below: the poses on both sides of each join, and how far apart they are unblended."
            ),
        ),
        "Targets": (
            lambda: figures.targets_and_achieved([dance], body_mass_kg=body_mass_kg),
            "What was asked, what the segments have, and what is shown.",
        ),
        "Energy": (
            lambda: figures.energy_profile([dance], body_mass_kg=body_mass_kg),
            "How hard the dance is from moment to moment; steps are what was asked.",
        ),
        "Joints": (
            lambda: figures.joint_intensity_map([dance]),
            "What the dance asks of each joint. The dancer's left is on the right.",
        ),
    }
    return [picture(title, draw, caption) for title, (draw, caption) in drawings.items()]


def _overview(dances: list[Dance], body_mass_kg: float) -> Picture:
    return picture(
        "Targets",
        lambda: figures.targets_and_achieved(dances, body_mass_kg=body_mass_kg),
        "What was asked of each dance, what its segments have, and what is shown.",
    )


def _files(folder: Path, name: str) -> list[dict[str, str]]:
    """Name the files of a dance that lie beside its page."""
    return [
        {"name": f"{name}{suffix}", "address": f"./{quote(f'{name}{suffix}')}", "words": words}
        for suffix, words in _FILES.items()
        if (folder / f"{name}{suffix}").is_file()
    ]


def _played(dances: Mapping[str, Dance], shown: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Give what the player needs: one body, and of each dance where its joints are (float32, base64)."""
    skeleton = next(iter(dances.values())).motion.skeleton
    names = skeleton.joint_names
    sides = ("left", "right")
    return {
        "body": {
            "parents": list(skeleton.parents),
            "sides": [
                next((side for side in sides if name.startswith(f"{side}_")), "middle") for name in names
            ],
            "head_joint": names.index("head"),
        },
        "dances": [
            {
                "positions": base64.b64encode(
                    np.ascontiguousarray(joint_positions(dance.motion), dtype="<f4").tobytes()
                ).decode(),
                "frame_rate_hz": dance.motion.frame_rate_hz,
                "is_synthetic": dance.is_synthetic,
                "spared": [dance.mask is not None and name in dance.mask.spared for name in names],
                "segments": [
                    {key: segment[key] for key in ("letter", "colour", "start_s", "stop_s")}
                    | {"words": f"{segment['words']}{_in_block(segment, told['blocks'])}"}
                    for segment in told["segments"]
                ],
            }
            for dance, told in zip(dances.values(), shown, strict=True)
        ],
    }


def _in_block(segment: Mapping[str, Any], blocks: Sequence[Mapping[str, Any]]) -> str:
    numbers = (number for number, block in enumerate(blocks, start=1) if segment["start_s"] < block["stop_s"])
    return f"; block {next(numbers)}" if blocks else ""
