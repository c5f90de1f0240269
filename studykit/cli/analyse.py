"""studykit analyse, figures, report: from recordings to answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson

Study = Annotated[Path, typer.Argument(help="Folder of a study, such as sessions/demo.")]


def analyse(
    study: Study,
    against: Annotated[
        Path | None,
        typer.Option(help="A results.json from before: says which numbers are others now, and why."),
    ] = None,
    *,
    json: AsJson = False,
) -> None:
    """Make the table of trials and every test that the protocol declares."""
    from studykit import reports
    from studykit.analysis.changes import changes
    from studykit.reports.analyse import read_results
    from studykit.reports.place import folder_of

    old = None if against is None else read_results(against)  # before it is written anew
    results = reports.analyse(study, progress=show.progress)
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
        list[str] | None, typer.Option(help="Numbers of the paper's figures; may be repeated.")
    ] = None,
) -> None:
    """Draw the figures of the paper from a study."""
    from studykit import reports

    for path in reports.draw(study, only=only):
        show.say(str(path))


def report(study: Study) -> None:
    """Write one report with every number, figure and method."""
    from studykit import reports

    show.say(str(reports.report(study)))
