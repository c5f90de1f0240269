"""studykit power: how many people a study needs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson, Seed

if TYPE_CHECKING:
    import pandas as pd

    from studykit.analysis.power import Power

SIMULATED_PEOPLE = 400


def power(
    study: Annotated[
        Path, typer.Argument(help="A protocol, tried with simulated people; or the folder of a pilot study.")
    ],
    participants: Annotated[
        list[int] | None, typer.Option(min=2, max=999, help="How many people to try; may be repeated.")
    ] = None,
    studies: Annotated[
        int, typer.Option(min=100, help="How many studies to make up for each number.")
    ] = 1000,
    wanted: Annotated[float, typer.Option(min=0.01, max=0.99, help="Power aimed at.")] = 0.8,
    effects: Annotated[
        str, typer.Option(help="Planted in simulated people: paper, none, or a TOML file of your own.")
    ] = "paper",
    seed: Seed = 1,
    *,
    json: AsJson = False,
) -> None:
    """Say how many people a study needs, by making it up many times and analysing it as declared."""
    from studykit.analysis.outcome_model import models_of
    from studykit.analysis.power import power as power_of
    from studykit.analysis.simulated_trials import simulated_trials
    from studykit.core.seeding import stream
    from studykit.io.effects_file import read_effects
    from studykit.io.protocol_file import read_protocol
    from studykit.recording.study_folder import StudyFolder

    is_pilot = study.is_dir()
    protocol = read_protocol(StudyFolder(study).protocol if is_pilot else study)
    if is_pilot:
        pilot = _trials(study)
    else:
        pilot = simulated_trials(protocol, read_effects(effects), people=SIMULATED_PEOPLE, seed=seed)
    found = [
        power_of(
            protocol,
            model,
            participants=participants or (8, 12, 16, 20, 24),
            studies=studies,
            rng=stream(seed, "power", model.outcome),
            progress=show.progress,
        )
        for model in models_of(protocol, pilot)
    ]
    if json:
        show.as_json([row for one in found for row in one.table().to_dict("records")])
        return
    told = "the spread and means of the pilot" if is_pilot else f"SIMULATED people with the effects {effects}"
    show.say(f"Power of the declared tests, taking {told} for true ({studies} studies each):")
    for one in found:
        show.say()
        _print(one, wanted)


def _trials(study: Path) -> pd.DataFrame:
    from studykit import reports

    return reports.trials(study, progress=show.progress)


def _print(found: Power, wanted: float) -> None:
    """Print a line a question: the power of each number of people, and how many are enough."""
    for test, question in dict.fromkeys((chance.test, chance.question) for chance in found.chances):
        enough = found.people_needed(wanted, test=test, question=question)
        cells = ", ".join(
            f"{chance.participants}: {chance.power:.0%}"
            for chance in found.chances
            if (chance.test, chance.question) == (test, question)
        )
        says = f"{enough} are enough" if enough else "more are needed"
        show.say(f"{test}, {question}: {cells}; {says} for {wanted:.0%}")
