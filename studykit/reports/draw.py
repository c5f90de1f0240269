"""The figures of a study, drawn from its recordings and saved as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.library.dance_file import read_dances
from studykit.recording.study_folder import StudyFolder
from studykit.reports.analyse import write
from studykit.reports.material import Drawing, Material
from studykit.reports.paper_drawings import PAPER
from studykit.reports.place import AnyStudy, folder_of
from studykit.reports.review_drawings import REVIEWED
from studykit.reports.tables_out import write_tables
from studykit.reports.trials import trials

if TYPE_CHECKING:
    from studykit.figures.canvas import PaperFigure

__all__ = ["DRAWINGS", "FORMATS", "Drawing", "Material", "chosen", "draw", "figure", "material_of", "save"]

FORMATS = ("svg", "pdf", "png")


def draw(
    study: AnyStudy,
    *,
    only: Sequence[str] | None = None,
    dances: Sequence[Dance | Path | str] = (),
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
    dances : sequence of Dance, Path or str
        Further dances, or folders of them, for figures that the study's own dances cannot show: one that
        spares joints (1 and 9), one of blocks that differ in intensity (10a) or in variety (10b).
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


def figure(study: AnyStudy, name: str | int, *, dances: Sequence[Dance | Path | str] = ()) -> PaperFigure:
    """Draw one figure of a study without saving it; a notebook shows it.

    Parameters
    ----------
    study : Study, StudyFolder, Path or str
        Where it was recorded.
    name : str or int
        Its number in the paper, or its name.
    dances : sequence of Dance, Path or str
        See `draw`.

    Raises
    ------
    InputError
        If there is no such figure, or nothing was recorded for it.
    """
    (drawing,) = chosen([str(name)])
    return drawing.of(material_of(folder_of(study), dances=dances))


def material_of(folder: StudyFolder, *, dances: Sequence[Dance | Path | str] = ()) -> Material:
    """Gather what the figures and tables of a study are made from; `dances` are further ones."""
    further: list[Dance] = []
    for one in dances:
        further += [one] if isinstance(one, Dance) else read_dances(Path(one)).values()
    return Material(folder=folder, trials=trials(folder), further=tuple(further))


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


DRAWINGS: tuple[Drawing, ...] = (*PAPER, *REVIEWED)
"""Every figure of a study, in order."""
