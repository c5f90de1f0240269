"""studykit library: build, make up, fetch and look at dance libraries."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from studykit.cli import show
from studykit.cli.cores import Dask, Workers, processes, workforce
from studykit.cli.library_facts import facts_of, print_calibration, print_info, print_takes
from studykit.core.errors import InputError

if TYPE_CHECKING:
    from studykit.io.datasets.recipe import Recipe

app = typer.Typer(
    help="Dance libraries: build, make up, fetch, look at.", no_args_is_help=True, rich_markup_mode=None
)

Out = Annotated[Path, typer.Option("--out", help="The folder to make.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Repeats everything that chance decides.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print for a machine.")]


@app.command()
def build(
    source: Annotated[list[Path], typer.Argument(help="Folders of takes, as they are distributed.")],
    *,
    out: Out,
    recipe: Annotated[
        str | None,
        typer.Option(help="How they are read: a data set's name (aistpp, amass, ...) or a library.toml."),
    ] = None,
    skeleton: Annotated[
        str | None,
        typer.Option(help="Whose joints BVH files in cm have (daz, neo, smpl, ... or a map.toml)."),
    ] = None,
    fps: Annotated[
        list[str] | None,
        typer.Option(help="True rate where a file's is wrong, such as 'salsa/*=60'; may be repeated."),
    ] = None,
    skip: Annotated[
        int | None, typer.Option(min=0, help="Frames to leave out at the start of each file.")
    ] = None,
    noise_rule: Annotated[str, typer.Option(help="'robust', or 'paper' for the printed rule.")] = "robust",
    stride: Annotated[
        float, typer.Option(help="Seconds from one segment to the next; below 4 they overlap.")
    ] = 4.0,
    mirrored: Annotated[
        bool, typer.Option("--mirrored", help="Add every segment with left and right exchanged.")
    ] = False,
    seed: Seed = 0,
    workers: Workers = None,
    dask: Dask = None,
) -> None:
    """Build a library from folders of takes, calibrate it and show what is in it.

    How files are read is known for the published data sets, comes from a library.toml beside them (the
    README shows one), or from --skeleton, --fps and --skip. The same command again reads only what is new or
    changed, and goes on where an interrupted one was. Takes that cannot be used are left out and listed with
    the reason.
    """
    from studykit.library.build import build as build_library
    from studykit.library.measure import Settings

    sources = {folder: _recipe(folder, recipe, skeleton, fps or [], skip) for folder in source}
    for folder, own in sources.items():
        _say_what_is_read(folder, own, fps or [])
    settings = Settings(noise_rule=cast(Any, noise_rule), stride_s=stride, mirrored=mirrored, seed=seed)
    before = _shards(out)
    with workforce(dask, workers) as hands:
        build_library(sources, out, settings=settings, workers=hands, progress=show.progress)
    now = _shards(out)
    if before:
        changes = (len(now - before), len(now & before), len(before - now))
        show.say("{} files are new or changed, {} as before, {} gone".format(*changes))
    print_takes(out, most=40)
    print_info(out)
    show.say(f"On one page: {_page(out)}")
    show.say(f"Next: studykit demo --library {out} --out sessions/{out.name}")


def _shards(out: Path) -> set[str]:
    """Give the shards of a library, or none where there is no whole one."""
    from studykit.library.store import index_folder, read_shards

    try:
        return set(read_shards(index_folder(out)))
    except (InputError, OSError, ValueError):
        return set()


def _say_what_is_read(folder: Path, recipe: Recipe, rates: list[str]) -> None:
    """Say how a folder is read and what in it is not; refuse a rate for takes that are not there."""
    from fnmatch import fnmatch

    from studykit.io.datasets.read import files_in, plain_path, unread_in

    files = files_in(folder, recipe)
    for rate in rates:
        pattern = rate.rpartition("=")[0]
        if not any(fnmatch(plain_path(path, folder), pattern) for path in files):
            example = plain_path(files[0], folder)
            raise InputError(
                f"no take of {folder} matches {pattern!r}",
                where="--fps",
                remedy=f"write a pattern of paths such as {example}",
            )
    show.say(f"{folder}: {len(files)} files, read as {recipe.data_set} ({recipe.format})")
    if unread := unread_in(folder, recipe):
        example = unread[0].relative_to(folder).as_posix()
        more = f" and {len(unread) - 1} more" if len(unread) > 1 else ""
        show.say(f"  not read, since no rule means it or its format is another: {example}{more}")


def _recipe(source: Path, name: str | None, skeleton: str | None, fps: list[str], skip: int | None) -> Recipe:
    from studykit.io.datasets.read import find_recipe, named_recipe
    from studykit.io.datasets.recipe import FILE_NAME, Recipe

    if skeleton is not None and skeleton.endswith(".toml"):
        skeleton = str(Path(skeleton).resolve())  # a map of one's own
    if name is not None:
        recipe = named_recipe(name)
    elif (source / FILE_NAME).exists():
        recipe = find_recipe(source)
        if skeleton is not None:
            recipe = recipe.model_copy(update={"skeleton": skeleton})
    elif skeleton is not None:
        recipe = Recipe(data_set=source.resolve().name, skeleton=skeleton, units_m=0.01)
    else:
        recipe = find_recipe(source)
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
    workers: Workers = None,
) -> None:
    """Make up a synthetic library, of any size: nobody danced it, and it says so."""
    from studykit.library import make_sample

    make_sample(out, segments=segments, seed=seed, workers=workers or processes(), progress=show.progress)
    print_info(out)
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
    takes: Annotated[bool, typer.Option("--takes", help="List every take, also those left out.")] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="Compare every file with its digest first.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Say what a library holds: hours, genres, performers, licences, yield and targets."""
    from studykit.library.store import require_intact

    if verify:
        require_intact(library)
    if json:
        show.as_json(facts_of(library))
        return
    if verify:
        show.say("Every file is what was written.")
    print_takes(library, most=None if takes else 0)
    print_info(library)


@app.command()
def browse(
    library: Annotated[Path, typer.Argument(help="A dance library.")],
    *,
    show_it: Annotated[bool, typer.Option("--open", help="Open the page in the web browser.")] = False,
) -> None:
    """Put a library on one page with its figures: what it holds, what was left out, what its dances can be.

    To see the segments move, use the library browser of the notebook 03_build_library.
    """
    page = _page(library)
    show.say(f"{page}")
    if show_it:
        import webbrowser

        webbrowser.open(page.resolve().as_uri())


def _page(library: Path) -> Path:
    from studykit.reports.library_page import library_page

    return library_page(library)


@app.command()
def calibrate(
    library: Annotated[Path, typer.Argument(help="A dance library.")],
    *,
    ratings: Annotated[
        Path | None, typer.Option(help="Answers of raters, as the rating widget saved them.")
    ] = None,
    percentiles: Annotated[
        bool, typer.Option("--percentiles", help="Take the raters' targets back.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Say what light, intense, easy and hard mean in a library, beside the paper's constants.

    A library is calibrated when it is built: on 1,000 random chains of 32 s of one genre. Raters may say it
    instead; see the notebook 03_build_library for the rating widget.
    """
    from studykit.library import index
    from studykit.library.rating import RatingSheet, plan_of_sheet, rated_targets
    from studykit.library.store import open_library

    if ratings is not None and percentiles:
        raise InputError("raters or percentiles", where="--percentiles", remedy="say one of them")
    if ratings is not None:
        plan = plan_of_sheet(ratings)
        index.adopt(library, rated_targets(RatingSheet(ratings, plan).ratings(), plan, open_library(library)))
    elif percentiles:
        index.adopt(library, None)
    if ratings is not None or percentiles:
        _page(library)
    if json:
        show.as_json(facts_of(library))
    else:
        print_calibration(library)
