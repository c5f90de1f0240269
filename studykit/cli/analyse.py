"""studykit analyse, figures, report: from recordings to answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson

Study = Annotated[Path, typer.Argument(help="Folder of a study, such as sessions/demo.")]


def analyse(study: Study, *, json: AsJson = False) -> None:
    """Make the table of trials and every test that the protocol declares."""
    from studykit import reports

    results = reports.analyse(study)
    if json:
        show.as_json(results.to_dict())
    else:
        show.say(str(results))


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
