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
    from studykit.choreography.preset import Preset
    from studykit.motion.joint_mask import JointMask
    from studykit.protocol.study_protocol import DancePlan, StudyProtocol

HELP = """Find dances that are as intense, varied, long and smooth as asked, around an injury if need be.

With --protocol: one for each of its conditions. Without: a single dance, such as

\b
  studykit choreograph --library libraries/cmu --out dances \\
      --duration 32 --intensity intense --variety easy --spare right_elbow --open

What was asked and how close it came is printed; the page dances.html plays the dances and shows what they ask
of each joint. Beside it lie the movement (.npz of AMASS, .bvh, .glb) and every number (.json).

A goal that the library cannot reach is refused before any search, with the nearest values that it can; with
--nearest they are danced, and the page says so. A dance that is there already stays. Ctrl-C keeps the best
that was found for a single dance, and of a protocol the dances that are finished.

Goals that follow a heart rate come from Python: see choreography.schedule.heart_rate_profile.
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
        str | None,
        typer.Option(
            help="One dance: light, intense, or a percentile of the library, 0 to 100.", show_default="light"
        ),
    ] = None,
    variety: Annotated[
        str | None,
        typer.Option(
            help="One dance: easy, hard, or a share of the distance of unrelated segments.",
            show_default="easy",
        ),
    ] = None,
    transition: Annotated[
        str | None,
        typer.Option(help="One dance: on, or off for joins left to chance.", show_default="on"),
    ] = None,
    schedule: Annotated[
        str | None,
        typer.Option(help="One dance of blocks: hiit, waves or warm-up, instead of a length and levels."),
    ] = None,
    spare: Annotated[
        list[str] | None,
        typer.Option(
            help="A joint to spare, with all beyond it, such as right_elbow; may be repeated. "
            "Joints that the protocol spares stay spared."
        ),
    ] = None,
    speed_percentile: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=100.0,
            help="All spared joints stay below this percentile of the library.",
            show_default="50, or the protocol's",
        ),
    ] = None,
    splice: Annotated[
        bool,
        typer.Option("--splice", help="Put calm arms on segments in which a spared arm would move too fast."),
    ] = False,
    stage: Annotated[
        str | None,
        typer.Option(
            help="Width and depth in m that the pelvis keeps within, such as 3x2.5; hands and feet "
            "reach beyond, how far is told."
        ),
    ] = None,
    weight: Annotated[
        list[str] | None,
        typer.Option(help="How much a goal counts, such as transition=2; may be repeated."),
    ] = None,
    preset: Annotated[str | None, typer.Option(help="studykit, or paper for the printed formulas.")] = None,
    seed: Seed = 0,
    nearest: Annotated[
        bool, typer.Option("--nearest", help="One dance: what comes nearest where the goal is out of reach.")
    ] = False,
    joints: Annotated[
        bool, typer.Option("--joints", help="Also write where every joint is at every time, as .csv.")
    ] = False,
    open_page: Annotated[bool, typer.Option("--open", help="Show the page in a browser.")] = False,
    json: AsJson = False,
) -> None:
    """Find dances; what is shown is `HELP`."""
    from studykit.io.protocol_file import default_protocol, read_protocol
    from studykit.library import open_library
    from studykit.library.dance_file import write_dances
    from studykit.library.wishes import stage_size
    from studykit.reports.dance_page import write_dance_page

    levels = {"--intensity": intensity, "--variety": variety}
    words = {**levels, "--transition": transition}
    if protocol is not None:
        _refuse(
            {**words, "--schedule": schedule},
            "the conditions of a protocol say this",
            "leave it out, or dance without --protocol",
        )
        _refuse({"--nearest": nearest}, "the dances of a study must be what its conditions say", _OTHER_GOALS)
    if schedule is not None:
        _refuse({**levels, "--duration": duration}, "a schedule has its own", "leave it or --schedule out")
    stage_m = None if stage is None else stage_size(stage)
    read = read_protocol(protocol or default_protocol())
    plan = _changed(read.dance, duration, preset, weight or [])
    opened = open_library(library)
    note_compiling()
    mask = _mask(plan, spare or [], speed_percentile, opened, splice=splice)
    # Words and limits are measured on the library itself, whatever arms it gets.
    if protocol is not None:
        wanted = _conditions(read.model_copy(update={"dance": plan}), opened, mask)
    else:
        wanted = _one_dance(plan, words, schedule, opened, mask)
    if splice and mask is not None:
        from studykit.choreography.splicing import spliced

        opened = spliced(opened, mask, progress=show.progress)
    wanted = _within_reach(wanted, opened, takes_nearest=nearest)
    made = _danced(wanted, opened, out, seed=seed, stage_m=stage_m, is_study=protocol is not None)
    if made:
        write_dances(made, out, with_joint_tables=joints)
        page = write_dance_page(made, out / "dances.html", library=opened)
    if json:
        show.as_json({name: made[name].to_dict() | {"trace": []} for name in made})
    elif made:
        print_dances(made, opened)
        show.say(f"Watch {'it' if len(made) == 1 else 'them'}: {page}")
        show.say(f"Written to {out}: .bvh and .glb open in Blender, .npz is an archive as of AMASS.")
    if open_page and made:
        typer.launch(page.resolve().as_uri())
    _end_if_interrupted(made, wanted)


_STOPPED = 130
_OTHER_GOALS = "leave --nearest out, and change what the protocol's words mean or add takes"


def _refuse(said: Mapping[str, object], problem: str, remedy: str) -> None:
    """Refuse options that would change nothing, or not what they seem to."""
    names = [name for name, value in said.items() if value is not None and value is not False]
    if names:
        raise InputError(problem, where=" and ".join(names), remedy=remedy)


def _conditions(protocol: StudyProtocol, library: DanceLibrary, mask: JointMask | None) -> dict[str, Goal]:
    from studykit.choreography.targets import goals

    return {
        name: goal if mask is None else replace(goal, mask=_as_the_preset_has_it(mask, goal.preset))
        for name, goal in goals(protocol, library).items()
    }


def _as_the_preset_has_it(mask: JointMask, preset: Preset) -> JointMask:
    from studykit.motion.joint_mask import JointMask

    return JointMask(weights=mask.weights) if preset.masks_energies else mask


def _one_dance(
    plan: DancePlan,
    words: Mapping[str, str | None],
    schedule: str | None,
    library: DanceLibrary,
    mask: JointMask | None,
) -> dict[str, Goal]:
    from studykit.choreography.request import requested

    said = {name.strip("-"): word for name, word in words.items() if word is not None}
    levels: dict[str, Any] = {name: _level(word) for name, word in said.items()}
    goal = requested(
        library,
        duration_s=plan.duration_s,
        spare=() if mask is None else mask,
        schedule=schedule,
        plan=plan,
        **levels,
    )
    return {goal.condition: goal}


def _end_if_interrupted(made: Mapping[str, Dance], wanted: Mapping[str, Goal]) -> None:
    missing = [name for name in wanted if name not in made]
    if missing:
        show.note(f"INTERRUPTED: there is no dance yet for {', '.join(missing)}.")
        raise typer.Exit(_STOPPED)
    if any(dance.is_interrupted for dance in made.values()):
        raise SystemExit(_STOPPED)  # what was kept is said; the same command would not go on


def note_compiling() -> None:
    """Say why a first search takes longer."""
    from studykit.choreography.rjmcmc import kernel

    if not kernel.is_compiled():
        show.note(kernel.COMPILING)


def _within_reach(
    wanted: Mapping[str, Goal], library: DanceLibrary, *, takes_nearest: bool
) -> dict[str, Goal]:
    """Give every goal, or in its place what comes nearest to it, with a note that says so."""
    from studykit.choreography.choreograph import require_dances
    from studykit.choreography.reach import OutOfReachError

    chosen = dict(wanted)
    for name, goal in wanted.items():
        try:
            require_dances({name: goal}, library)
        except OutOfReachError as error:
            if not takes_nearest:
                raise
            chosen[name] = error.nearest
    return chosen


def _danced(
    wanted: Mapping[str, Goal],
    library: DanceLibrary,
    out: Path,
    *,
    seed: int,
    stage_m: tuple[float, float] | None,
    is_study: bool,
) -> dict[str, Dance]:
    """Dance every goal that was not danced before; of a study, only what was finished."""
    from studykit.choreography.choreograph import dance
    from studykit.library.kept_dance import kept_dance

    kept = {
        name: kept_dance(out, name, goal, library, seed=seed, stage_m=stage_m)
        for name, goal in wanted.items()
    }
    made = {name: there for name, there in kept.items() if there is not None}
    missing = {name: goal for name, goal in wanted.items() if name not in made}
    if not is_study:
        return made | {
            name: dance(goal, library, seed=seed, stage_m=stage_m, progress=show.progress)
            for name, goal in missing.items()
        }
    try:
        for name, goal in show.progress(missing.items(), label="Choreographing", total=len(missing)):
            found = dance(goal, library, seed=seed, stage_m=stage_m)
            if found.is_interrupted:
                break
            made[name] = found
    except KeyboardInterrupt:
        pass  # between two searches
    return {name: made[name] for name in wanted if name in made}


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
    plan: DancePlan,
    joints: Sequence[str],
    percentile: float | None,
    library: DanceLibrary,
    *,
    splice: bool,
) -> JointMask | None:
    """Spare what the plan spares and what is named; of two limits the stricter holds."""
    from studykit.choreography.preset import PRESETS
    from studykit.choreography.request import SPEED_PERCENTILE
    from studykit.choreography.targets import limited, spared_by
    from studykit.motion.joint_mask import JointMask, spare

    mask = spared_by(plan, library)
    if joints:
        named = limited(spare(joints), library, SPEED_PERCENTILE if percentile is None else percentile)
        mask = named if mask is None else mask.stricter(named)
    if mask is None:
        idle = {"--splice": splice, "--speed-percentile": percentile}
        _refuse(idle, "no joint is spared", "name one with --spare")
        return None
    if percentile is None:
        return mask
    if PRESETS[plan.preset].masks_energies and not splice:
        said = {"--speed-percentile": percentile}
        _refuse(said, "the printed formulas limit no joint", "leave it out, or use the preset studykit")
    return mask.stricter(limited(JointMask(weights=mask.weights), library, percentile))


def _level(word: str) -> Any:
    """Give a number where it is one, else the word; which words there are is asked of `requested`."""
    try:
        return float(word)
    except ValueError:
        return word


def print_dances(dances: Mapping[str, Dance], library: DanceLibrary) -> None:
    """Print what was asked for and what was found."""
    for name, dance in dances.items():
        if dance.note:
            show.say(f"NOTE on {name}: {dance.note}")
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
        for line in (_limits(dance), _space(dance)):
            if line:
                show.say(f"{name} {line}")
        if dance.is_interrupted:
            show.say(f"INTERRUPTED: {name} is the best dance found until then.")


def _limits(dance: Dance) -> str:
    """Say how near each spared joint comes to its limits, and which are not kept."""
    units = {"limit_rad_s": ("peak_rad_s", "rad/s"), "angle_limit_rad": ("angle_rad", "rad")}
    lines = []
    for joint, told in dance.joints().items():
        parts = [
            f"{told[value]:.2f} of {told[limit]:.2f} {unit}"
            for limit, (value, unit) in units.items()
            if told[limit] is not None
        ]
        if parts:
            lines.append(f"{joint} {' and '.join(parts)}{'' if told['is_kept'] else ', BEYOND'}")
    return f"spares: {'; '.join(lines)}" if lines else ""


def _space(dance: Dance) -> str:
    """Say which space the dance takes, where it has a stage."""
    if dance.animation.stage_m is None:
        return ""
    from studykit.reports.dance_facts import beyond_stage_m

    width, depth = dance.animation.stage_m
    beyond = 100.0 * beyond_stage_m(dance)
    return (
        f"keeps its pelvis within {width:g} x {depth:g} m; hands and feet reach up to {beyond:.0f} cm beyond"
    )


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
