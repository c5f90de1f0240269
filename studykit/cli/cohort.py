"""studykit cohort: every dance of a table of wishes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from studykit.cli import show
from studykit.cli.choreograph import note_compiling
from studykit.cli.cores import Dask, Workers, workforce
from studykit.cli.library import AsJson, Seed

if TYPE_CHECKING:
    import pandas as pd

_STOPPED, _NOT_ALL = 130, 1
_SENTENCES = 20

HELP = """Make the dances of a whole cohort from a table of wishes, one row a dance.

\b
A table (CSV; a TOML file has a [[dance]] each, with the same fields):
  participant,name,duration_s,intensity,variety,spare,seed
  P01,monday,32,intense,easy,right_elbow,
  P01,friday,64,60,0.7,,
  P02,monday,32,light,hard,left_knee right_knee,5

\b
participant  the folder of the dance; or leave it out and give names
name         of the files; if not given, its words, such as intense-easy-on
duration_s   a multiple of 4; 32 if not given
intensity    light, intense, or a percentile of the library, 0 to 100
variety      easy, hard, or a share of the distance of unrelated segments
transition   on, or off for joins that need not be smooth
spare        joints, separated by spaces or ;
speed_percentile
             spared joints stay below this percentile of the library, 0 to
             100; 50 if not given
schedule     hiit, waves or warm-up, instead of one length and level
stage        width x depth in m that the pelvis keeps within, such as 3x2.5
seed         the same gives the same dance; if not given, everybody gets
             one of their own, drawn from --seed

The whole table is checked first, and all its mistakes are told, a line each. Then come
OUT/PARTICIPANT/NAME.npz, .bvh, .glb and .json, and OUT/dances.csv with what was asked and achieved. The same
command again makes only what is missing, after Ctrl-C or a power cut too; the number of processes changes no
byte. Dances that are out of reach are listed with the nearest that can be had, those that are refused with
the reason; they do not stop the others. Where none is made, all that was in OUT stays as it was. With --dask
all machines must see the library and OUT at these paths.

\b
The exit code is
  0    every dance is there
  1    some are out of reach or refused
  2    the table, the library or a word of the command is wrong
  130  it was interrupted
"""


def cohort(
    wishes: Annotated[Path, typer.Argument(help="The table of wishes, .csv or .toml.")],
    *,
    library: Annotated[Path, typer.Option("--library", help="The library that dances are made of.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the dances.")],
    workers: Workers = None,
    dask: Dask = None,
    seed: Seed = 0,
    json: AsJson = False,
) -> None:
    """Make the dances of a whole cohort; what is shown is `HELP`."""
    from studykit.library.cohort import INTERRUPTED, MADE, make_cohort

    note_compiling()
    with workforce(dask, workers) as hands:
        table = make_cohort(wishes, library, out, seed=seed, workers=hands, progress=show.progress)
    if json:
        show.as_json(table.astype(object).where(table.notna(), None).to_dict("records"))
    else:
        _print_outcome(table, out)
    statuses = set(table["status"])
    if INTERRUPTED in statuses:
        raise typer.Exit(_STOPPED)
    if statuses != {MADE}:
        raise typer.Exit(_NOT_ALL)


def _print_outcome(table: pd.DataFrame, out: Path) -> None:
    """Say how many dances there are, how close they come, and why others are not there."""
    from studykit.library.cohort import MADE, TABLE

    made = table[table["status"] == MADE]
    counts = [f"{count} {status}" for status, count in table["status"].value_counts().items()]
    show.say(f"{len(table)} dances are wished for: {', '.join(counts)}.")
    if len(made):
        for name in ("linear_energy", "rotational_energy"):
            off = (made[f"blended_{name}"] / made[f"asked_{name}"] - 1.0).abs()
            within = f"{(off <= 0.05).mean():.0%} within 5 %, all within {off.max():.1%}"
            show.say(f"  {name.replace('_', ' ')} as shown: {within} of what was asked")
    others = table[table["reason"] != ""]
    told = others.head(_SENTENCES) if len(made) else others
    for row in told.to_dict("records"):
        show.say(f"  {row['participant']} {row['name']}, {row['status']}: {row['reason']}")
    if len(others) > len(told):
        show.say(f"  and {len(others) - len(told)} more, with the reasons in the table")
    if len(made):
        show.say(f"One row a dance: {out / TABLE}")
    else:
        show.say(f"None is made, so nothing in {out} was changed.")
