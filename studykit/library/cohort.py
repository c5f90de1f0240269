"""Dances for a cohort: any number of wishes, on all cores or on a cluster, made once and kept.

A dance depends on its wish, its seed and the library alone. So it does not matter how many processes make
them, which of them stops, or how often one begins again: what is there already stays.
"""

from __future__ import annotations

import glob
from collections.abc import Sequence
from contextlib import closing
from functools import lru_cache
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studykit.choreography.choreograph import dance
from studykit.choreography.dance import Dance
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.measures import Measures
from studykit.choreography.reach import OutOfReachError
from studykit.core.durable import put
from studykit.core.errors import InputError
from studykit.core.parallel import spread
from studykit.core.progress import Progress, silent
from studykit.library.dance_file import read_dance, write_dances
from studykit.library.kept_dance import kept_dance
from studykit.library.store import open_library
from studykit.library.wishes import Wish, read_wishes

if TYPE_CHECKING:
    import pandas as pd

TABLE = "dances.csv"
MADE, OUT_OF_REACH, REFUSED, INTERRUPTED = "made", "out of reach", "refused", "interrupted"
_LOCK = ".dances.lock"
_MEASURES = {"linear": "linear_energy", "rotational": "rotational_energy", "variety": "variety"}


def make_cohort(
    wishes: str | Path,
    library: str | Path,
    out: str | Path,
    *,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Make all dances that are wished for, as OUT/PARTICIPANT/NAME.npz, .bvh, .glb and .json.

    The same call again makes only what is missing. A wish that cannot be met does not stop the others.

    Parameters
    ----------
    wishes : str or Path
        The table of wishes, CSV or TOML; all of it is checked first. See `read_wishes`.
    library : str or Path
        The dance library; on a cluster, every machine finds it, and `out`, at the same path.
    out : str or Path
        The folder of the dances; what else is in it stays.
    seed : int
        Where wishes without a seed draw theirs from.
    workers : int, optional
        Processes, each of which uses one core; if not given, what joblib's `parallel_config` says, for
        example a Dask cluster.
    progress : Progress
        Told of each dance.

    Returns
    -------
    DataFrame
        One row a wish, in their order: `participant, name, seed, status, reason`, what was asked, achieved
        within the segments and blended (energies in J per kg), which goals are missed, how joins jump, and
        the peak speed of spared joints against their limits. `status` is "made", "out of reach" (the reason
        names the nearest), "refused" (no dance was found, or another one of this name, or a broken one, is
        there) or "interrupted". It is also in OUT/dances.csv, unless none is made: then all that was there
        stays.

    Raises
    ------
    InputError
        If anything is wrong in the table (all mistakes at once: `MistakesError`), the folder cannot be
        written, another call is at work on it, or the library is none.
    """
    import pandas as pd
    from filelock import FileLock, Timeout

    library, out = Path(library).resolve(), Path(out).resolve()
    opened = open_library(library)
    read = read_wishes(wishes, opened, seed=seed)
    try:
        out.mkdir(parents=True, exist_ok=True)
        with FileLock(out / _LOCK, blocking=False):
            rows = _rows(read, library, opened.sha256, out, workers=workers, progress=progress)
            table = pd.DataFrame(rows, columns=list(COLUMNS)).astype(dict.fromkeys(_COUNTS, "Int64"))
            if (table["status"] == MADE).any():  # or else the table of what is there would be lost
                put(out / TABLE, table.to_csv(index=False, lineterminator="\n"))
    except Timeout as error:
        problem = "another cohort is being made here"
        raise InputError(problem, where=out, remedy="wait until it is done") from error
    except OSError as error:
        problem = f"cannot be written ({error.strerror or error})"
        raise InputError(problem, where=out, remedy="make room or choose another folder") from error
    return table


def _rows(
    wishes: Sequence[Wish],
    library: Path,
    sha256: str,
    out: Path,
    *,
    workers: int | None,
    progress: Progress,
) -> list[dict[str, Any]]:
    """Make the dances; where that is interrupted, tell what is there."""
    # What is prepared for joints that are spared serves all dances that spare them.
    order = sorted(range(len(wishes)), key=lambda number: wishes[number].spare)
    rows: dict[int, dict[str, Any]] = {}
    jobs = ((wishes[number], library, sha256, out) for number in order)
    try:
        with closing(spread(make_dance, jobs, workers=workers)) as outcomes:
            told = progress(outcomes, label="Choreographing", total=len(wishes))
            for number, row in zip(order, told, strict=True):
                rows[number] = row  # noqa: PERF403 - what came before an interruption is kept
    except KeyboardInterrupt:
        for number in order[len(rows) :]:
            wish = wishes[number]
            is_there = (out / wish.participant / f"{wish.name}.json").exists()
            rows[number] = make_dance(wish, library, sha256, out) if is_there else _row(wish, INTERRUPTED)
    return [rows[number] for number in range(len(wishes))]


def make_dance(wish: Wish, library: Path, sha256: str, out: Path) -> dict[str, Any]:
    """Make one dance on one core, unless it is there already, and tell what came of it: one row of the table.

    Parameters
    ----------
    wish : Wish
        With a name and a seed.
    library : Path
        The dance library; it stays open for the wishes that follow.
    sha256 : str
        Its digest.
    out : Path
        Where the participants' folders lie.

    Raises
    ------
    InputError
        If the library is another one here, or the files cannot be written.
    KeyboardInterrupt
        If the search was interrupted: its best dance so far is none that could be made again.
    """
    opened, folder = _opened(library, sha256), out / wish.participant
    seed, stage_m = wish.seed or 0, wish.stage_m
    try:
        goal = wish.goal(opened)
        kept = kept_dance(folder, wish.name, goal, opened, seed=seed, stage_m=stage_m)
        made = kept or _danced(goal, opened, seed=seed, stage_m=stage_m)
    except OutOfReachError as error:
        return _row(wish, OUT_OF_REACH, reason=str(error))
    except InputError as error:
        return _row(wish, REFUSED, reason=str(error))
    if kept is None:
        for part in folder.glob(f".{glob.escape(wish.name)}.*.partial"):  # of a process that was killed
            part.unlink(missing_ok=True)
    write_dances({wish.name: made}, folder)  # of one that is there, a view that was removed comes back
    return _row(wish, MADE) | _told(made if kept else read_dance(folder, wish.name), goal)


def _danced(goal: Goal, library: DanceLibrary, *, seed: int, stage_m: tuple[float, float] | None) -> Dance:
    made = dance(goal, library, seed=seed, stage_m=stage_m, workers=1)
    if made.is_interrupted:
        raise KeyboardInterrupt
    return made


@lru_cache(maxsize=1)
def _opened(library: Path, sha256: str) -> DanceLibrary:
    """Open a library once in each process."""
    opened = open_library(library)
    if opened.sha256 != sha256:
        raise InputError(
            "it is another library here, or it was built again meanwhile",
            where=library,
            remedy="give every machine the same library and begin again",
        )
    return opened


COLUMNS = (
    *("participant", "name", "seed", "status", "reason", "condition", "duration_s"),
    *(f"{said}_{name}" for name in _MEASURES.values() for said in ("asked", "achieved", "blended")),
    *("misses", "blended_misses", "segments", "distinct_segments"),
    *("displacement_mean_m", "displacement_max_m", "spared", "spared_peak_of_limit", "sha256"),
)

_COUNTS = ("segments", "distinct_segments")


def _row(wish: Wish, status: str, *, reason: str = "") -> dict[str, Any]:
    return {
        "participant": wish.participant,
        "name": wish.name,
        "seed": wish.seed,
        "status": status,
        "reason": reason,
    }


def _told(kept: Dance, goal: Goal) -> dict[str, Any]:
    """Tell of a dance all that the table has of it."""
    stages = {"asked": kept.asked, "achieved": kept.achieved, "blended": kept.achieved_blended}
    jumps = kept.displacements_m or (0.0,)
    limits = _peaks(kept)
    return {
        "condition": kept.condition,
        "duration_s": kept.achieved_blended.duration_s,
        **{
            f"{said}_{name}": getattr(measures, name)
            for name in _MEASURES.values()
            for said, measures in stages.items()
        },
        "misses": _misses(kept, goal, "achieved"),
        "blended_misses": _misses(kept, goal, "achieved_blended"),
        "segments": len(kept.segments),
        "distinct_segments": kept.distinct_segments,
        "displacement_mean_m": sum(jumps) / len(jumps),
        "displacement_max_m": max(jumps),
        "spared": "; ".join(
            f"{name} {peak:.2f} of {limit:.2f} rad/s" for name, (peak, limit) in limits.items()
        ),
        "spared_peak_of_limit": max((peak / limit for peak, limit in limits.values()), default=None),
        "sha256": kept.sha256,
    }


def _misses(kept: Dance, goal: Goal, stage: str) -> str:
    """Say which goals a dance misses, as the search counts them."""
    blocks = [getattr(block, stage) for block in kept.blocks]
    measures = Measures(
        segments=(),
        blocks={"duration": tuple(block.duration_s for block in blocks)}
        | {short: tuple(getattr(block, name) for block in blocks) for short, name in _MEASURES.items()},
        displacements_m=kept.displacements_m,
    )
    return "; ".join(f"{name} off by {share:.1%}" for name, share in goal.misses(measures).items())


def _peaks(kept: Dance) -> dict[str, tuple[float, float]]:
    """Give the peak speed and the limit of every spared joint that has one, rad/s."""
    if kept.mask is None:
        return {}
    joints = kept.joints()
    limits = zip(kept.motion.skeleton.joint_names, kept.mask.speed_limits_rad_s, strict=True)
    return {
        name: (float(joints[name]["peak_rad_s"] or 0.0), float(limit))
        for name, limit in limits
        if isfinite(limit)
    }
