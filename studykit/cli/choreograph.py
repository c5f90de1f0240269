"""studykit choreograph: dances for a protocol, or one dance."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, get_args

import typer

from studykit.cli import show
from studykit.cli.library import AsJson, Seed
from studykit.core.errors import InputError

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance
    from studykit.choreography.dance_library import DanceLibrary
    from studykit.protocol.study_protocol import DancePlan

Library = Annotated[Path, typer.Option("--library", help="The dance library that segments come from.")]


def choreograph(
    library: Library,
    out: Annotated[Path, typer.Option("--out", help="Folder for the dances: .npz, .bvh and .json each.")],
    protocol: Annotated[
        Path | None, typer.Option(help="Protocol whose conditions are danced; without it, one dance is made.")
    ] = None,
    duration: Annotated[
        float | None, typer.Option(help="Seconds, a multiple of 4; instead of the protocol's.")
    ] = None,
    intensity: Annotated[str, typer.Option(help="One dance: light or intense.")] = "light",
    variety: Annotated[str, typer.Option(help="One dance: easy or hard.")] = "easy",
    preset: Annotated[str | None, typer.Option(help="studykit, or paper for the printed formulas.")] = None,
    seed: Seed = 0,
    *,
    json: AsJson = False,
) -> None:
    """Find dances that are as intense, varied, long and smooth as asked.

    With --protocol: one for each of its conditions. Without: a single dance of --intensity and --variety with
    smooth transitions.
    """
    from studykit.choreography import choreograph as all_dances
    from studykit.choreography.choreograph import dance
    from studykit.choreography.targets import goal
    from studykit.io.protocol_file import default_protocol, read_protocol
    from studykit.library import open_library
    from studykit.library.dance_file import write_dances
    from studykit.protocol.condition import Condition, Intensity, Variety

    read = read_protocol(protocol or default_protocol())
    plan = _changed(read.dance, duration, preset)
    opened = open_library(library)
    if protocol is not None:
        made = all_dances(read.model_copy(update={"dance": plan}), opened, seed=seed, progress=show.progress)
    else:
        for option, word, known in (("--intensity", intensity, Intensity), ("--variety", variety, Variety)):
            if word not in get_args(known):
                remedy = f"choose {' or '.join(get_args(known))}"
                raise InputError(f"there is no {word!r}", where=option, remedy=remedy)
        condition = Condition.parse(f"{intensity}-{variety}-on")
        made = {str(condition): dance(goal(plan, condition, opened), opened, seed=seed)}
    write_dances(made, out)
    if json:
        show.as_json({name: made[name].to_dict() | {"trace": []} for name in made})
        return
    print_dances(made, opened)
    show.say(f"Written to {out}: .bvh opens in Blender, .npz is SMPL in the layout of AMASS.")


def _changed(plan: DancePlan, duration: float | None, preset: str | None) -> DancePlan:
    from studykit.choreography.preset import PRESETS

    if preset is not None and preset not in PRESETS:
        raise InputError(
            f"there is no preset {preset!r}", where="--preset", remedy=f"choose {' or '.join(PRESETS)}"
        )
    changes = {"duration_s": duration, "preset": preset}
    return plan.model_copy(update={name: value for name, value in changes.items() if value is not None})


def print_dances(dances: Mapping[str, Dance], library: DanceLibrary) -> None:
    """Print what was asked for and what was found."""
    if library.is_synthetic:
        show.say("SYNTHETIC movement: nobody danced these segments.")
    jumps = {name: sum(d.displacements_m) / max(1, len(d.displacements_m)) for name, d in dances.items()}
    show.table(
        [
            {
                "dance": name,
                "length": f"{dance.achieved.duration_s:g} s",
                "linear": _share(dance.achieved.linear_energy, dance.asked.linear_energy),
                "rotational": _share(dance.achieved.rotational_energy, dance.asked.rotational_energy),
                "variety": f"{dance.achieved.variety:.1f} of {dance.asked.variety:.1f}",
                "distinct": f"{dance.distinct_segments} of {len(dance.segments)}",
                "jump at joins": f"{1000.0 * jumps[name]:.0f} mm",
                "segments": " ".join(str(segment.id) for segment in dance.segments),
            }
            for name, dance in dances.items()
        ]
    )


def _share(achieved: float, asked: float) -> str:
    return f"{100.0 * achieved / asked:.1f} %"
