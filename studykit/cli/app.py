"""All commands, under one name."""

from __future__ import annotations

import typer

from studykit.cli import analyse, check, choreograph, cohort, demo, library, power, session

app = typer.Typer(
    name="studykit",
    help="Design, run and analyse clinical studies of personalised dance exergames.",
    epilog="Begin with 'studykit demo': a whole study with simulated people, in about a minute.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)
app.command("demo")(demo.demo)
app.add_typer(library.app, name="library")
app.command("choreograph", help=choreograph.HELP)(choreograph.choreograph)
app.command("cohort", help=cohort.HELP)(cohort.cohort)
app.add_typer(session.app, name="session")
app.command("analyse")(analyse.analyse)
app.command("figures")(analyse.figures)
app.command("report")(analyse.report)
app.command("check", help=check.HELP)(check.check)
app.command("power")(power.power)
