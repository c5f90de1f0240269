"""studykit analyse, figures, report: from recordings to answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from studykit.cli import show
from studykit.cli.cores import Dask, Workers, workforce
from studykit.cli.library import AsJson

Study = Annotated[Path, typer.Argument(help="Folder of a study, such as sessions/demo.")]


def analyse(
    study: Study,
    against: Annotated[
        Path | None,
        typer.Option(help="A results.json from before: says which numbers are others now, and why."),
    ] = None,
    protocol: Annotated[
        Path | None,
        typer.Option(help="The protocol followed in a folder recorded elsewhere; it is kept there, in code."),
    ] = None,
    *,
    workers: Workers = None,
    dask: Dask = None,
    json: AsJson = False,
) -> None:
    """Make the table of trials and every test that the protocol declares."""
    from studykit import reports
    from studykit.analysis.changes import changes
    from studykit.reports.analyse import read_results
    from studykit.reports.place import folder_of
    from studykit.session import open_study

    if protocol is not None and study.is_dir():
        open_study(study, protocol=protocol)
    old = None if against is None else read_results(against)  # before it is written anew
    with workforce(dask, workers) as hands:
        results = reports.analyse(study, workers=hands, progress=show.progress)
    new = read_results(folder_of(study).derivatives / "results.json")
    differences = None if old is None else changes(old, new)
    if json:
        show.as_json(new | ({} if differences is None else {"against": differences.to_dict()}))
        return
    show.say(str(results))
    if differences is not None:
        show.say(f"\nAgainst {against}: {differences}")


def figures(
    study: Study,
    only: Annotated[
        list[str] | None, typer.Option(help="A figure's number in the paper, or name; may be repeated.")
    ] = None,
    dances: Annotated[
        list[Path] | None,
        typer.Option(
            help="Folder of a dance that the study lacks: one that spares joints (figures 1 and 9), or has "
            "blocks (10a, 10b); may be repeated."
        ),
    ] = None,
    *,
    tables: Annotated[
        bool, typer.Option("--tables", help="Write the tables too, for LaTeX and as CSV.")
    ] = False,
) -> None:
    """Draw the figures of the paper from a study, each as SVG, PDF and PNG."""
    from studykit import reports

    for path in reports.draw(study, only=only, dances=dances or (), with_tables=tables):
        show.say(str(path))


def report(study: Study) -> None:
    """Write one report with every number, figure and method."""
    from studykit import reports

    for path in reports.report(study):
        show.say(str(path))
