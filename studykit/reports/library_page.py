"""A dance library on one page: what it holds, what was left out, what its dances can be."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from studykit import figures
from studykit.choreography.targets import goals
from studykit.core.seeding import stream
from studykit.io.protocol_file import default_protocol, read_protocol
from studykit.library import review, store
from studykit.library.calibrate import genres_beside, unit_readings
from studykit.motion.body import DEFAULT_BODY_MASS_KG
from studykit.motion.segmentation import SEGMENT_S
from studykit.reports.analyse import write
from studykit.reports.page import Picture, filled, picture

if TYPE_CHECKING:
    import pandas as pd

    from studykit.choreography.dance_library import DanceLibrary
    from studykit.figures.canvas import PaperFigure

PAGE = "library.html"
LISTED_TAKES = 60


def library_page(library: str | Path) -> Path:
    """Write a library's page into its folder: `library.html`, one file that needs nothing else.

    Parameters
    ----------
    library : str or Path
        The folder of a dance library.

    Returns
    -------
    Path
        The page. The same library gives the same bytes.

    Raises
    ------
    InputError
        If the folder is no library, or the page cannot be written.
    """
    folder = Path(library)
    opened, manifest = store.open_library(folder), store.read_manifest(folder)
    takes = store.read_takes(folder)
    rated = store.read_rated(folder)
    aims = goals(read_protocol(default_protocol()), opened)
    page = filled(
        "library.html.jinja",
        manifest=manifest,
        synthetic=opened.is_synthetic,
        data_sets=_data_sets(opened, takes, manifest["origin"]["citations"]),
        genres=_counted(opened, "genre"),
        performers=_counted(opened, "performer"),
        refused=takes.loc[takes["status"] == "refused", "reason"].tolist(),
        empty=takes[takes["status"] == "empty"][["take", "reason"]].to_dict("records"),
        takes=takes[takes["status"] != "refused"].to_dict("records")[:LISTED_TAKES],
        aims=[_aim(goal) for name, goal in aims.items() if name.endswith("-on")],
        calibration=opened.calibration,
        beside=genres_beside(opened),
        rated=rated.as_dict() if rated else None,
        readings=unit_readings(opened, stream(0, "unit readings")).to_dict("records"),
        pictures=_pictures(folder, opened, takes, aims),
        body_mass_kg=DEFAULT_BODY_MASS_KG,
    )
    out = folder / PAGE
    write(out, page)
    return out


def _data_sets(library: DanceLibrary, takes: pd.DataFrame, citations: dict[str, str]) -> list[dict[str, Any]]:
    rows = []
    read = takes[takes["status"] != "refused"]
    for name in takes["data_set"].unique():
        own = library.segments[library.segments["data_set"] == name]
        theirs = read[read["data_set"] == name]
        rows.append(
            {
                "name": name,
                "takes": len(theirs),
                "refused": int(((takes["data_set"] == name) & (takes["status"] == "refused")).sum()),
                "recorded_hours": theirs["duration_s"].sum() / 3600.0,
                "segments": len(own),
                "hours": theirs["segments_kept"].sum() * SEGMENT_S / 3600.0,
                "kept": theirs["segments_kept"].sum(),
                "possible": theirs["segments_possible"].sum(),
                "paper": theirs["segments_paper"].sum(),
                "licences": sorted(set(own["licence"])),
                "citation": citations.get(str(name), ""),
            }
        )
    return rows


def _counted(library: DanceLibrary, column: str) -> list[dict[str, Any]]:
    table = library.segments
    return [
        {
            "name": name,
            "segments": len(own),
            "takes": own["take"].nunique(),
            "linear": own["linear_energy"].median() * DEFAULT_BODY_MASS_KG,
            "rotational": own["rotational_energy"].median() * DEFAULT_BODY_MASS_KG,
        }
        for name, own in table.groupby(column)
    ]


def _aim(goal: Any) -> dict[str, Any]:
    return {
        "condition": goal.condition,
        "linear": goal.measures.linear_energy * DEFAULT_BODY_MASS_KG,
        "rotational": goal.measures.rotational_energy * DEFAULT_BODY_MASS_KG,
        "variety": goal.measures.variety,
    }


def _pictures(
    folder: Path, library: DanceLibrary, takes: pd.DataFrame, aims: dict[str, Any]
) -> list[Picture]:
    read = takes[takes["status"] != "refused"]
    flagged = read[read["segments_possible"] > 0].sort_values(
        ["frames_speed", "frames_acceleration", "take"], ascending=[False, False, True]
    )

    def worst_take() -> PaperFigure:
        name = str(flagged["take"].iloc[0])
        take = review.take_again(folder, name)
        return figures.cleaning(take.motion, take=name, synthetic=take.source.is_synthetic)

    drawings = {
        "Energies": (
            lambda: figures.energy_distribution(library, goals=aims),
            "What the segments ask of a dancer, the chains that the targets come from, and the targets.",
        ),
        "Reach": (
            lambda: figures.target_space(library, goals=aims),
            "Energies that dances from this library can have; targets far from the chains are seldom met.",
        ),
        "Variety": (
            lambda: figures.variety_distribution(library, goals=aims),
            "How different the segments of random chains are.",
        ),
        "Joints": (
            lambda: figures.joint_intensity(library),
            "Where the energy of the segments comes from.",
        ),
        "Yield": (
            lambda: figures.yield_by_take(_whole_numbers(read), synthetic=library.is_synthetic),
            "What was kept of each take by the rule in use, and what the paper's literal rule would keep.",
        ),
        "Cleaning": (
            worst_take,
            "The take with the most frames flagged, and what is left of it by either rule.",
        ),
    }
    return [picture(title, draw, caption) for title, (draw, caption) in drawings.items()]


def _whole_numbers(table: pd.DataFrame) -> pd.DataFrame:
    return table.astype({name: int for name in table if str(name).startswith("segments_")})
