"""studykit session: visits of participants."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson
from studykit.core.errors import InputError

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance
    from studykit.session.runner import Session
    from studykit.session.study import Study

app = typer.Typer(
    help="Visits of participants: run, resume, list, export, validate.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

StudyDir = Annotated[Path, typer.Option("--study", help="Folder of the study, such as sessions/pilot.")]
Participant = Annotated[str, typer.Option("--participant", help="Number of the participant, such as 07.")]
ProtocolFile = Annotated[
    Path | None, typer.Option("--protocol", help="The protocol to begin the study with, at the first visit.")
]
Device = Annotated[str, typer.Option(help="'simulated': a device with a simulated person before it.")]


@app.command()
def run(
    study: StudyDir,
    participant: Participant,
    protocol: ProtocolFile = None,
    camera: Device = "simulated",
    heart_rate: Device = "simulated",
) -> None:
    """Run the visit of one participant, from calibration to the last questionnaire.

    The study's folder must hold its dances:
    'studykit choreograph --library DIR --protocol FILE --out STUDY/sourcedata/dances'.
    """
    opened, dances = _prepared(study, protocol, camera, heart_rate)
    session = opened.session(participant)
    if session.state.started:
        raise InputError(
            f"participant {participant} has begun this visit already",
            where=session.path,
            remedy="go on with 'studykit session resume'",
        )
    _carry_out(opened, session, dances)


@app.command()
def resume(
    study: StudyDir, participant: Participant, camera: Device = "simulated", heart_rate: Device = "simulated"
) -> None:
    """Go on with a visit that was interrupted; the step that broke off is kept, marked, and repeated."""
    opened, dances = _prepared(study, None, camera, heart_rate)
    session = opened.session(participant)
    if not session.state.started:
        raise InputError(
            f"participant {participant} has no visit to go on with",
            where=study,
            remedy="use 'studykit session run'",
        )
    _carry_out(opened, session, dances)


def _prepared(
    study: Path, protocol: Path | None, camera: str, heart_rate: str
) -> tuple[Study, dict[str, Dance]]:
    """Open the study and read its dances, before anything is written."""
    from studykit.library import read_dances
    from studykit.recording.study_folder import StudyFolder
    from studykit.session import open_study

    for option, name in (("--camera", camera), ("--heart-rate", heart_rate)):
        if name != "simulated":
            raise InputError(f"there is no device {name!r}", where=option, remedy="say simulated")
    folder = StudyFolder(study)
    if protocol is None and not folder.protocol.exists():
        raise InputError("there is no study here yet", where=study, remedy="begin it with --protocol FILE")
    dances = read_dances(folder.dances)
    return open_study(study, protocol=protocol), dances


def _carry_out(study: Study, session: Session, dances: dict[str, Dance]) -> None:
    record = asyncio.run(session.run(dances, camera="simulated", heart_rate="simulated"))
    study.write_bids()
    danced = sum(step.phase == "perform" and step.is_complete for step in record.steps)
    show.say(f"Participant {record.participant}: {danced} dances recorded in {session.path}. SIMULATED.")


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
def export(study: StudyDir) -> None:
    """Write the BIDS files of all visits again, from what was recorded."""
    from studykit.session import open_study

    opened = open_study(study)
    opened.write_bids()
    show.say(f"{study} is a BIDS data set of {len(opened.sessions())} recorded visits.")


@app.command()
def validate(study: StudyDir) -> None:
    """Check every journal's chain of digests, every recorded frame and every dance; nothing is changed."""
    from studykit.library import read_dances
    from studykit.session import open_study

    opened = open_study(study)
    records = opened.sessions()
    if not records:
        raise InputError("nothing has been recorded yet", where=study, remedy="run a visit first")
    shown = {name: dance.sha256 for name, dance in read_dances(opened.folder.dances).items()}
    frames = 0
    for record in records:
        if dict(record.dance_sha256) != shown:
            raise InputError(
                "the dances in the folder are not those that were shown",
                where=record.journal,
                remedy="put back the dances that were shown",
            )
        for step in record.steps:
            if step.phase == "perform" and step.is_complete:
                frames += len(record.frames(step.step))
    show.say(
        f"Whole: {len(records)} of {len(records)} journals, {len(shown)} dances, {frames} frames of dancing."
    )
