"""The figures of a study, drawn from its recordings and saved as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from studykit import figures
from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.figures.samples import ORDER
from studykit.library.dance_file import read_dances
from studykit.recording.study_folder import StudyFolder
from studykit.reports import drawings
from studykit.reports.analyse import write
from studykit.reports.curves import curves
from studykit.reports.material import Drawing, Material
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.tables_out import write_tables
from studykit.reports.trials import dances as dance_table
from studykit.reports.trials import trials

if TYPE_CHECKING:
    from studykit.figures.canvas import PaperFigure

__all__ = ["DRAWINGS", "FORMATS", "Drawing", "Material", "chosen", "draw", "material_of", "save"]

FORMATS = ("svg", "pdf", "png")


def draw(
    study: AnyStudy,
    *,
    only: Sequence[str] | None = None,
    dances: Sequence[Path | str] = (),
    with_tables: bool = False,
) -> tuple[Path, ...]:
    """Draw the figures of a study, each as SVG, PDF and PNG.

    Writes into the study's `derivatives/studykit/figures`; the same recordings give the same bytes.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    only : sequence of str, optional
        Which figures: numbers of the paper, such as "7", or names. If not given, all for which something
        was measured.
    dances : sequence of Path or str
        Folders of further dances, for figures that the study's own dances cannot show: one that spares
        joints (1 and 9), one of blocks that differ in intensity (10a) or in variety (10b).
    with_tables : bool
        Whether to write the tables of the paper too, into `derivatives/studykit/tables`.

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    InputError
        If there is no such figure, nothing was recorded for one that was asked for, or a file cannot be
        written.
    """
    wanted = chosen(only)
    folder = folder_of(study)
    material = material_of(folder, dances=dances)
    paths: list[Path] = []
    for drawing in wanted:
        try:
            figure = drawing.of(material)
        except InputError:
            if only is not None:
                raise
            continue
        paths += save(figure, folder.figures / drawing.stem)
    if with_tables:
        paths += write_tables(material)
    return tuple(paths)


def material_of(folder: StudyFolder, *, dances: Sequence[Path | str] = ()) -> Material:
    """Gather what the figures and tables of a study are made from; `dances` are folders of further ones."""
    further = tuple(dance for path in dances for dance in read_dances(Path(path)).values())
    return Material(folder=folder, trials=trials(folder), further=further)


def chosen(only: Sequence[str] | None) -> tuple[Drawing, ...]:
    """Give the figures of these names, or all.

    Raises
    ------
    InputError
        If there is no such figure; it names those there are.
    """
    if only is None:
        return DRAWINGS
    by_name = {drawing.name: drawing for drawing in DRAWINGS}
    for name in only:
        if name not in by_name:
            raise InputError(f'there is no figure "{name}"', remedy=f"choose from {', '.join(by_name)}")
    return tuple(by_name[name] for name in dict.fromkeys(only))


def save(figure: PaperFigure, stem: Path) -> tuple[Path, ...]:
    """Write a figure in every format, under one name."""
    paths = tuple(stem.with_name(f"{stem.name}.{ending}") for ending in FORMATS)
    for ending, path in zip(FORMATS, paths, strict=True):
        write(path, figure.file_bytes(ending))
    return paths


def _four_dances(material: Material) -> PaperFigure:
    names = [f"{cell}-on" for cell in ORDER if f"{cell}-on" in material.dances]
    shown = [material.dances[name] for name in names]
    return figures.four_dances(
        [_strip(dance, material) for dance in shown],
        simulated=any(record.simulated for record in material.records),
        synthetic=any(dance.is_synthetic for dance in shown),
    )


def _strip(dance: Dance, material: Material) -> figures.DanceStrip:
    """Put the curves of everybody who danced a dance to its end beneath it."""
    hearts, distances = (
        curves(material.folder, kind)[dance.condition] for kind in ("heart_rate", "distance")
    )
    return figures.DanceStrip(
        condition=dance.condition,
        motion=dance.motion,
        times_s=hearts.times_s,
        heart_rate_bpm=hearts.values,
        distance_m=distances.values,
    )


def _smoothness(material: Material) -> PaperFigure:
    asked = material.protocol.questionnaires.smoothness
    return figures.smoothness_by_condition(material.trials, scale=asked.scale, question=asked.text)


_INTERVALS = "Points are participants; black outlines are means with their 95 % interval (Student's t)."

DRAWINGS: tuple[Drawing, ...] = (
    *drawings.PAPER,
    Drawing(
        name="6",
        caption="The dances made with transition cost: poses from the middle of equal stretches of each "
        "dance, each half of a bone in the colour of its joint's energy (linear and rotational) in that "
        "stretch, on one scale for all joints and dances; below, heart rate and distance between dancer and "
        "guide, mean over participants with its 95 % interval.",
        of=_four_dances,
    ),
    Drawing(
        name="7",
        caption=f"Distance between dancer and guide (dynamic time warping), by condition. {_INTERVALS} "
        "Lines join one participant's values.",
        of=lambda material: figures.movement_by_condition(material.trials),
    ),
    Drawing(
        name="8",
        caption=f"Ratings of smoothness with and without transition cost. {_INTERVALS}",
        of=_smoothness,
    ),
    *drawings.EXPERIMENTS,
    Drawing(
        name="heart-rate-by-condition",
        caption=f"Mean heart rate while performing, by condition. {_INTERVALS} "
        "Lines join one participant's values.",
        of=lambda material: figures.heart_rate_by_condition(material.trials),
    ),
    Drawing(
        name="heart-rate-against-energy",
        caption=f"Mean heart rate against the energy of the dance. {_INTERVALS} Lines have the slope common "
        "to all participants; conditions with nearly the same energy are moved apart.",
        of=lambda material: figures.heart_rate_against_energy(material.trials),
    ),
    Drawing(
        name="movement-against-variety",
        caption=f"Distance between dancer and guide against the variety of the dance. {_INTERVALS} Lines "
        "have the slope common to all participants; conditions with nearly the same variety are moved apart.",
        of=lambda material: figures.movement_against_variety(material.trials),
    ),
    Drawing(
        name="asked-and-achieved",
        caption="What was asked of each dance, what its segments achieve, and what the dance as shown has, "
        "with its joins.",
        of=lambda material: figures.asked_and_achieved(dance_table(material.dances)),
    ),
    *drawings.REVIEWED,
)
"""Every figure of a study, in order."""
