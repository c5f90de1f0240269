"""studykit choreograph: dances for a protocol, or one dance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from studykit.cli import show
from studykit.cli.library import AsJson, Seed
from studykit.core.errors import InputError

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance, DanceMeasures
    from studykit.choreography.dance_library import DanceLibrary
    from studykit.choreography.goal import Goal
    from studykit.motion.joint_mask import JointMask
    from studykit.protocol.study_protocol import DancePlan

HELP = """Find dances that are as intense, varied, long and smooth as asked, around an injury if need be.

With --protocol: one for each of its conditions. Without: a single dance, such as

\b
  studykit choreograph --library libraries/cmu --out dances \\
      --duration 32 --intensity intense --variety easy --spare right_elbow --open

What was asked and how close it came is printed; the page dances.html plays the dances and shows what they ask
of each joint. Beside it lie the movement (.npz of AMASS, .bvh, .glb) and every number (.json).

A goal that the library cannot reach is refused before any search, with the nearest values that it can; with
--nearest they are danced. Ctrl-C keeps the best dance found so far.
"""


def choreograph(
    *,
    library: Annotated[Path, typer.Option("--library", help="The dance library that segments come from.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the dances and their page.")],
    protocol: Annotated[
        Path | None, typer.Option(help="Protocol whose conditions are danced; without it, one dance is made.")
    ] = None,
    duration: Annotated[
        float | None, typer.Option(help="Seconds, a multiple of 4; instead of the protocol's.")
    ] = None,
    intensity: Annotated[
        str, typer.Option(help="One dance: light, intense, or a percentile of the library, 0 to 100.")
    ] = "light",
    variety: Annotated[
        str, typer.Option(help="One dance: easy, hard, or a share of the distance of unrelated segments.")
    ] = "easy",
    transition: Annotated[str, typer.Option(help="One dance: on, or off for joins left to chance.")] = "on",
    schedule: Annotated[
        str | None,
        typer.Option(help="One dance of blocks: hiit, waves or warm-up, instead of a length and levels."),
    ] = None,
    spare: Annotated[
        list[str] | None,
        typer.Option(help="A joint to spare, with all beyond it, such as right_elbow; may be repeated."),
    ] = None,
    speed_percentile: Annotated[
        float,
        typer.Option(min=0.0, max=100.0, help="Spared joints stay below this percentile of the library."),
    ] = 50.0,
    splice: Annotated[
        bool,
        typer.Option("--splice", help="Put calm arms on segments in which a spared arm would move too fast."),
    ] = False,
    stage: Annotated[
        str | None, typer.Option(help="Width and depth in m that a dance keeps to, such as 3x2.5.")
    ] = None,
    weight: Annotated[
        list[str] | None,
        typer.Option(help="How much a goal counts, such as transition=2; may be repeated."),
    ] = None,
    preset: Annotated[str | None, typer.Option(help="studykit, or paper for the printed formulas.")] = None,
    seed: Seed = 0,
    nearest: Annotated[
        bool, typer.Option("--nearest", help="Dance what comes nearest where a goal is out of reach.")
    ] = False,
    joints: Annotated[
        bool, typer.Option("--joints", help="Also write where every joint is at every time, as .csv.")
    ] = False,
    open_page: Annotated[bool, typer.Option("--open", help="Show the page in a browser.")] = False,
    json: AsJson = False,
) -> None:
    """Find dances; what is shown is `HELP`."""
    from studykit.choreography.request import requested
    from studykit.choreography.targets import goals
    from studykit.io.protocol_file import default_protocol, read_protocol
    from studykit.library import open_library
    from studykit.library.dance_file import write_dances
    from studykit.reports.dance_page import write_dance_page

    read = read_protocol(protocol or default_protocol())
    plan = _changed(read.dance, duration, preset, weight or [])
    opened = open_library(library)
    note_compiling()
    mask = _mask(spare or [], speed_percentile, opened, splice=splice)
    if splice and mask is not None:
        from studykit.choreography.splicing import spliced

        opened = spliced(opened, mask, progress=show.progress)
    if protocol is not None:
        wanted = goals(read.model_copy(update={"dance": plan}), opened)
        if mask is not None:
            wanted = {name: replace(goal, mask=mask) for name, goal in wanted.items()}
    else:
        goal = requested(
            opened,
            duration_s=plan.duration_s,
            intensity=_level(intensity),
            variety=_level(variety),
            transition=_level(transition),
            spare=() if mask is None else mask,
            schedule=schedule,
            plan=plan,
        )
        wanted = {goal.condition: goal}
    made = _danced(wanted, opened, seed=seed, stage_m=_stage(stage), takes_nearest=nearest)
    write_dances(made, out, with_joint_tables=joints)
    page = write_dance_page(made, out / "dances.html", library_name=opened.name)
    if json:
        show.as_json({name: made[name].to_dict() | {"trace": []} for name in made})
    else:
        print_dances(made, opened)
        show.say(f"Watch {'it' if len(made) == 1 else 'them'}: {page}")
        show.say(f"Written to {out}: .bvh and .glb open in Blender, .npz is an archive as of AMASS.")
    if open_page:
        typer.launch(page.resolve().as_uri())


def note_compiling() -> None:
    """Say why a first search takes longer."""
    from studykit.choreography.rjmcmc import kernel

    # Where the compiler keeps what it made, unless it was told otherwise.
    if not any(Path(kernel.__path__[0], "__pycache__").glob("running.run-*.nbi")):
        show.note("The search compiles itself once; this takes some seconds.")


def _danced(
    wanted: Mapping[str, Goal],
    library: DanceLibrary,
    *,
    seed: int,
    stage_m: tuple[float, float] | None,
    takes_nearest: bool,
) -> dict[str, Dance]:
    """Dance every goal, or what comes nearest to it."""
    from studykit.choreography.choreograph import dance, require_dances
    from studykit.choreography.reach import OutOfReachError

    chosen = dict(wanted)
    for name, goal in wanted.items():
        try:
            require_dances({name: goal}, library)
        except OutOfReachError as error:
            if not takes_nearest:
                raise
            show.note(str(error))
            chosen[name] = error.nearest
    if len(chosen) == 1:
        ((name, goal),) = chosen.items()
        return {name: dance(goal, library, seed=seed, stage_m=stage_m, progress=show.progress)}
    return {
        name: dance(goal, library, seed=seed, stage_m=stage_m)
        for name, goal in show.progress(chosen.items(), label="Choreographing", total=len(chosen))
    }


def _changed(
    plan: DancePlan, duration: float | None, preset: str | None, weights: Sequence[str]
) -> DancePlan:
    """Give the plan with what was said in its place."""
    from studykit.choreography.preset import PRESETS

    if preset is not None and preset not in PRESETS:
        raise InputError(
            f"there is no preset {preset!r}", where="--preset", remedy=f"choose {' or '.join(PRESETS)}"
        )
    said: dict[str, float] = {}
    for text in weights:
        name, _, number = text.partition("=")
        try:
            said[name] = float(number)
        except ValueError:
            said[name] = -1.0
        if name not in type(plan.weights).model_fields or not 0.0 <= said[name] < float("inf"):
            known = ", ".join(type(plan.weights).model_fields)
            raise InputError(f"{text!r} is no weight", where="--weight", remedy=f"say one of {known}, = 0 up")
    changes = {"duration_s": duration, "preset": preset, "weights": plan.weights.model_copy(update=said)}
    return plan.model_copy(update={name: value for name, value in changes.items() if value is not None})


def _mask(
    joints: Sequence[str], percentile: float, library: DanceLibrary, *, splice: bool
) -> JointMask | None:
    from studykit.choreography.targets import limited
    from studykit.motion.joint_mask import spare

    if not joints:
        if splice:
            raise InputError("no joint is spared", where="--splice", remedy="name one with --spare")
        return None
    return limited(spare(joints), library, percentile)


def _level(word: str) -> Any:
    """Give a number where it is one, else the word; which words there are is asked of `requested`."""
    try:
        return float(word)
    except ValueError:
        return word


def _stage(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        width, depth = (float(number) for number in text.lower().split("x"))
    except ValueError:
        width = depth = 0.0
    if not (0.0 < width < float("inf") and 0.0 < depth < float("inf")):
        raise InputError(f"{text!r} is no stage", where="--stage", remedy="say width x depth, such as 3x2.5")
    return width, depth


def print_dances(dances: Mapping[str, Dance], library: DanceLibrary) -> None:
    """Print what was asked for and what was found."""
    if library.is_synthetic:
        show.say("SYNTHETIC movement: nobody danced these segments.")
    show.table([_row(name, dance) for name, dance in dances.items()])
    for name, dance in dances.items():
        show.say(f"{name} is made of segments {' '.join(str(segment.id) for segment in dance.segments)}")
        if len(dance.blocks) > 1:
            show.say(f"\n{name}, block by block:")
            show.table(
                [{"block": n + 1} | _measures(b.achieved, b.asked) for n, b in enumerate(dance.blocks)]
            )
        limits = [
            f"{joint} {told['peak_rad_s']:.2f} of {told['limit_rad_s']:.2f} rad/s"
            for joint, told in dance.joints().items()
            if told["limit_rad_s"] is not None
        ]
        if limits:
            show.say(f"{name} spares: {'; '.join(limits)}")
        if dance.is_interrupted:
            show.say(f"INTERRUPTED: {name} is the best dance found until then.")


def _row(name: str, dance: Dance) -> dict[str, str]:
    jumps = dance.displacements_m
    costs = dance.chain_costs
    return {
        "dance": name,
        **_measures(dance.achieved, dance.asked),
        "shown": f"{_share(dance.achieved_blended.linear_energy, dance.asked.linear_energy)}, "
        f"{_share(dance.achieved_blended.rotational_energy, dance.asked.rotational_energy)}",
        "distinct": f"{dance.distinct_segments} of {len(dance.segments)}",
        "jump at joins": f"{1000.0 * sum(jumps) / max(1, len(jumps)):.0f} mm",
        "cost": f"{dance.cost_total:.3f}" + (f" ({min(costs):.3f}-{max(costs):.3f})" if costs else ""),
    }


def _measures(achieved: DanceMeasures, asked: DanceMeasures) -> dict[str, str]:
    return {
        "length": f"{achieved.duration_s:g} s",
        "linear": _share(achieved.linear_energy, asked.linear_energy),
        "rotational": _share(achieved.rotational_energy, asked.rotational_energy),
        "variety": f"{achieved.variety:.1f} of {asked.variety:.1f}",
    }


def _share(achieved: float, asked: float) -> str:
    return f"{100.0 * achieved / asked:.1f} %"
