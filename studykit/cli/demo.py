"""studykit demo: a whole study with simulated people, from the library to the report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from studykit.cli import show
from studykit.cli.choreograph import note_compiling, print_dances
from studykit.cli.library import AsJson, Seed

if TYPE_CHECKING:
    from studykit.protocol.study_protocol import StudyProtocol

SAMPLE = Path("libraries/synthetic")


NEXT = """With dances of your own:
  studykit library build FOLDER --out libraries/mine
  studykit demo --library libraries/mine --out sessions/mine
With a protocol of your own (copy protocols/dance-2x2x2.toml to mine.toml and change it):
  studykit demo --protocol mine.toml --out sessions/rehearsal
  studykit choreograph --library libraries/mine --protocol mine.toml --out sessions/study/sourcedata/dances
  studykit session run --study sessions/study --protocol mine.toml --participant 01"""


def demo(
    library: Annotated[
        Path | None, typer.Option(help=f"A dance library; without one, {SAMPLE} is made up.")
    ] = None,
    participants: Annotated[
        int | None,
        typer.Option(min=1, help="How many simulated people take part; the protocol's number if not given."),
    ] = None,
    protocol: Annotated[
        Path | None, typer.Option(help="A protocol of your own to rehearse; the 2x2x2 study if not given.")
    ] = None,
    effects: Annotated[
        str, typer.Option(help="What is planted in them: paper, none, or a TOML file of your own.")
    ] = "paper",
    seed: Seed = 1,
    out: Annotated[
        Path, typer.Option(help="Folder of the study; one that broke off is gone on with.")
    ] = Path("sessions/demo"),
    *,
    json: AsJson = False,
) -> None:
    """Run a whole study with simulated people: library, dances, sessions, statistics, figures, report."""
    from studykit import reports
    from studykit.choreography import choreograph
    from studykit.io.effects_file import read_effects
    from studykit.library import make_sample, open_library
    from studykit.protocol.latin_square import assignment, balance
    from studykit.reports.analyse import results_of
    from studykit.session import open_study

    planted = read_effects(effects)
    study = open_study(out, protocol=_protocol(protocol, participants))
    opened = make_sample(SAMPLE, progress=show.progress) if library is None else open_library(library)
    note_compiling()
    dances = choreograph(study.protocol, opened, seed=seed, progress=show.progress)
    study.simulate(dances, effects=planted, seed=seed, progress=show.progress, workers=2)
    page, pdf = reports.report(out, progress=show.progress)
    results = results_of(out)
    if json:
        show.as_json(results.to_dict())
        return
    show.say()
    print_dances(dances, opened)
    show.say()
    show.say(str(balance(assignment(study.protocol))))
    show.say()
    show.say(str(results))
    show.say()
    show.say(
        f"SIMULATED: {len(study.participants)} people who do not exist danced; effects planted: {effects}."
    )
    show.say(f"  report    {page}, {pdf.name}")
    show.say(f"  tables    {study.folder.derivatives / 'trials.csv'}, results.json")
    show.say(f"  raw data  {out} (a BIDS data set)")
    show.say()
    show.say(
        "Their hearts, errors and ratings follow the planted effects of each condition, not the dance itself."
    )
    show.say(NEXT)


def _protocol(given: Path | None, participants: int | None) -> StudyProtocol | Path:
    """Give the protocol to rehearse, its file if nothing is changed in it."""
    from studykit.io.protocol_file import default_protocol, read_protocol

    path = given or default_protocol()
    return path if participants is None else read_protocol(path).with_participants(participants)
