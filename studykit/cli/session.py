"""studykit session: visits of participants."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson
from studykit.core.errors import InputError

app = typer.Typer(
    help="Visits of participants: run, resume, list, validate.", no_args_is_help=True, rich_markup_mode=None
)

StudyDir = Annotated[Path, typer.Option("--study", help="Folder of the study, such as sessions/pilot.")]
Participant = Annotated[str, typer.Option("--participant", help="Number of the participant, such as 07.")]
Device = Annotated[str, typer.Option(help="'simulated': a device with a simulated person before it.")]


@app.command()
def run(
    study: StudyDir, participant: Participant, camera: Device = "simulated", heart_rate: Device = "simulated"
) -> None:
    """Run the visit of one participant, from calibration to the last questionnaire.

    The study's folder must hold its dances:
    'studykit choreograph --library DIR --protocol FILE --out STUDY/sourcedata/dances'.
    """
    _run(study, participant, camera, heart_rate, resume=False)


@app.command()
def resume(
    study: StudyDir, participant: Participant, camera: Device = "simulated", heart_rate: Device = "simulated"
) -> None:
    """Go on with a visit that was interrupted; the step that broke off is kept, marked, and repeated."""
    _run(study, participant, camera, heart_rate, resume=True)


def _run(study: Path, participant: str, camera: str, heart_rate: str, *, resume: bool) -> None:
    from studykit.io.protocol_file import default_protocol
    from studykit.library.dance_file import read_dances
    from studykit.recording.study_folder import StudyFolder
    from studykit.session import open_study

    for option, name in (("--camera", camera), ("--heart-rate", heart_rate)):
        if name != "simulated":
            raise InputError(f"there is no device {name!r}", where=option, remedy="say simulated")
    folder = StudyFolder(study)
    dances = read_dances(folder.dances)
    opened = open_study(study, protocol=None if folder.protocol.exists() else default_protocol())
    session = opened.session(participant)
    begun = session.path.exists()
    if begun and not resume:
        raise InputError(
            f"participant {participant} has begun this visit already",
            where=session.path,
            remedy="go on with 'studykit session resume'",
        )
    if resume and not begun:
        raise InputError(
            f"participant {participant} has no visit to go on with",
            where=study,
            remedy="use 'studykit session run'",
        )
    record = asyncio.run(session.run(dances, camera="simulated", heart_rate="simulated"))
    opened.write_bids()
    danced = sum(step.phase == "perform" and step.is_complete for step in record.steps)
    show.say(f"Participant {participant}: {danced} dances recorded in {session.path}. SIMULATED.")


@app.command("list")
def list_sessions(study: StudyDir, *, json: AsJson = False) -> None:
    """List who has come, and whether the visit is over."""
    from studykit.session import open_study

    opened = open_study(study)
    recorded = {record.participant: record for record in opened.sessions()}
    rows = [
        {
            "participant": participant,
            "visit": "not yet"
            if participant not in recorded
            else ("complete" if recorded[participant].completed else "interrupted"),
            "simulated": participant in recorded and recorded[participant].simulated,
        }
        for participant in opened.participants
    ]
    if json:
        show.as_json(rows)
    else:
        show.table(rows)


@app.command()
def validate(study: StudyDir) -> None:
    """Check every journal's chain of digests and every recorded frame; nothing is changed."""
    from studykit.session import open_study

    opened = open_study(study)
    records = opened.sessions()
    frames = 0
    for record in records:
        for step in record.steps:
            if step.phase == "perform" and step.is_complete:
                frames += len(record.frames(step.step))
    show.say(f"{len(records)} journals are whole, {frames} frames of dancing can be read.")
