"""studykit library: build, make up, fetch and look at dance libraries."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from studykit.cli import show
from studykit.core.errors import InputError

if TYPE_CHECKING:
    from studykit.io.datasets.recipe import Recipe

app = typer.Typer(
    help="Dance libraries: build, make up, fetch, look at.", no_args_is_help=True, rich_markup_mode=None
)

YIELD_HEADS = {
    "take": "take",
    "duration_s": "seconds",
    "segments_possible": "segments possible",
    "segments_kept": "kept",
    "segments_paper": "kept by the paper's rule",
    "frames_speed": "frames too fast",
    "frames_acceleration": "too jerky",
    "frames_paper": "flagged by the paper's rule",
}

Out = Annotated[Path, typer.Option("--out", help="The folder to make.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Repeats everything that chance decides.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print for a machine.")]


@app.command()
def build(
    source: Annotated[
        list[Path], typer.Argument(help="Folders of takes (.bvh, plain or packed as .xz or .gz).")
    ],
    out: Out,
    skeleton: Annotated[
        str | None,
        typer.Option(help="Whose joints the files have (daz, neo, smpl), where no library.toml says."),
    ] = None,
    fps: Annotated[
        list[str] | None,
        typer.Option(help="True rate where a file's is wrong, such as 'salsa/*=60'; may be repeated."),
    ] = None,
    skip: Annotated[
        int | None, typer.Option(min=0, help="Frames to leave out at the start of each file.")
    ] = None,
    noise_rule: Annotated[str, typer.Option(help="'robust', or 'paper' for the printed rule.")] = "robust",
    seed: Seed = 0,
) -> None:
    """Build a library from folders of takes.

    How files are read comes from a library.toml beside them (the README shows one), from a built-in recipe
    that knows the data set, or from --skeleton, --fps and --skip.
    """
    from studykit.library.build import build as build_library

    if noise_rule not in {"robust", "paper"}:
        raise InputError(
            f"there is no noise rule {noise_rule!r}", where="--noise-rule", remedy="say robust or paper"
        )
    sources = {folder: _recipe(folder, skeleton, fps or [], skip) for folder in source}
    build_library(sources, out, progress=show.progress, noise_rule=noise_rule, seed=seed)
    _print_yield(out)
    _print_info(out)
    show.say(f"Next: studykit demo --library {out} --out sessions/{out.name}")


def _recipe(source: Path, skeleton: str | None, fps: list[str], skip: int | None) -> Recipe:
    from studykit.io.datasets.read import find_recipe
    from studykit.io.datasets.recipe import Recipe, TakeRule

    if skeleton is None:
        recipe = find_recipe(source)
    else:
        recipe = Recipe(
            data_set=source.resolve().name,
            licence="not stated",
            skeleton=skeleton,
            units_m=0.01,
            takes=(TakeRule(match="*", genre="not stated", performer="not stated"),),
        )
    changes: dict[str, Any] = {} if skip is None else {"skip_frames": skip}
    rates = {}
    for rate in fps:
        pattern, _, hertz = rate.rpartition("=")
        try:
            rates[pattern] = float(hertz)
        except ValueError:
            rates[pattern] = 0.0
        if not (pattern and 0.0 < rates[pattern] < math.inf):
            raise InputError(
                f"cannot read {rate!r}", where="--fps", remedy="write PATTERN=HZ, such as 'salsa/*=60'"
            )
    return recipe.model_copy(update=changes | {"frame_rates_hz": rates | recipe.frame_rates_hz})


@app.command()
def sample(
    out: Out,
    segments: Annotated[int, typer.Option(min=1, help="How many segments of 4 s.")] = 240,
    seed: Seed = 0,
) -> None:
    """Make up a synthetic library, of any size: nobody danced it, and it says so."""
    from studykit.library import make_sample

    make_sample(out, segments=segments, seed=seed, progress=show.progress)
    _print_info(out)
    show.say(f"Next: studykit demo --library {out} --out sessions/{out.name}")


@app.command()
def fetch(
    name: Annotated[str, typer.Argument(help="Name of a public data set, such as cmu-dance.")],
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the takes; takes/NAME if not given.")
    ] = None,
) -> None:
    """Bring public dances from their origin; every file is checked, and a broken download is continued."""
    from studykit.library.fetch import fetch as fetch_data_set

    folder = fetch_data_set(name, out or Path("takes") / name, show.progress)
    show.say(f"{name} lies in {folder}.")
    show.say(f"Next: studykit library build {folder} --out libraries/{name}")


@app.command()
def info(
    library: Annotated[Path, typer.Argument(help="A dance library.")],
    *,
    json: AsJson = False,
) -> None:
    """Say what a library holds: hours, genres, performers, licences, yield and targets."""
    if json:
        show.as_json(_facts(library))
    else:
        _print_yield(library)
        _print_info(library)


def _facts(library: Path) -> dict[str, Any]:
    from studykit.library.store import open_library, read_manifest

    calibration = open_library(library).calibration
    light, intense = calibration.energy_targets(25.0), calibration.energy_targets(75.0)
    return read_manifest(library) | {
        "linear_energy_25_75": [light[0], intense[0]],
        "rotational_energy_25_75": [light[1], intense[1]],
        "median_distance": calibration.median_distance,
        "transition_tolerance_m": calibration.transition_tolerance_m,
    }


def _print_info(library: Path) -> None:
    from studykit.motion.body import DEFAULT_BODY_MASS_KG

    facts = _facts(library)
    kept, paper = facts["segments"], facts["segments_paper"]
    show.say(f"{facts['name']}: {kept} segments ({facts['hours'] * 60:.1f} min) of {facts['takes']} takes")
    if facts["is_synthetic"]:
        show.say("  SYNTHETIC: nobody danced these")
    show.say(
        f"  yield: {kept} of {facts['segments_possible']} possible; the paper's noise rule would keep {paper}"
    )
    for kind in ("genres", "performers", "licences"):
        show.say(f"  {kind}: " + ", ".join(f"{name} ({count})" for name, count in facts[kind].items()))
    show.say(f"  targets of 32 s, for {DEFAULT_BODY_MASS_KG} kg, linear and rotational energy:")
    for level, (name, printed) in enumerate((("light", "56.5 and 31.8"), ("intense", "147.2 and 106.5"))):
        linear, rotational = (facts[f"{kind}_energy_25_75"][level] for kind in ("linear", "rotational"))
        in_paper_unit = f"{linear * DEFAULT_BODY_MASS_KG:.1f} and {rotational * DEFAULT_BODY_MASS_KG:.1f}"
        show.say(f"    {name}: {in_paper_unit} (the paper: {printed})")


def _print_yield(library: Path) -> None:
    import pandas as pd

    from studykit.library.store import read_manifest

    read_manifest(library)
    table = pd.read_csv(library / "yield.csv").round({"duration_s": 1})
    rows = table.rename(columns=YIELD_HEADS).to_dict("records")
    most = 60
    show.table(rows[:most])
    if len(rows) > most:
        show.say(f"... and {len(rows) - most} takes more in {library / 'yield.csv'}")
