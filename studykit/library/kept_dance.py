"""Whether a dance that is there already is the one that is asked for."""

from __future__ import annotations

from pathlib import Path

from studykit.choreography.dance import Animation, Dance
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.core.errors import InputError
from studykit.library.dance_file import read_dance


def kept_dance(
    folder: str | Path,
    name: str,
    goal: Goal,
    library: DanceLibrary,
    *,
    seed: int,
    stage_m: tuple[float, float] | None = None,
) -> Dance | None:
    """Read a dance that was made before, if there is one; another of its name is refused.

    Parameters
    ----------
    folder : path
        Where dances lie.
    name : str
        Of its files.
    goal : Goal
        What it shall be like.
    library : DanceLibrary
        What it shall be made of.
    seed : int
        Of the search.
    stage_m : (float, float), m, or None
        Width and depth that it shall keep to.

    Raises
    ------
    InputError
        If the dance that is there was made for something else or of another library, is the best of a search
        that was interrupted, or is broken. Says what differs.
    """
    folder = Path(folder)
    if not (folder / f"{name}.json").exists():
        return None
    kept = read_dance(folder, name)
    spared = [None if mask is None else mask.to_dict() for mask in (kept.mask, goal.mask)]
    animation = Animation(blend=goal.preset.blend, is_cleaned=goal.preset.is_cleaned, stage_m=stage_m)
    differs = {
        "another library": kept.library_sha256 != library.sha256,
        f"another seed ({kept.seed})": kept.seed != seed,
        "another goal": (kept.condition, kept.preset) != (goal.condition, goal.preset.name)
        or tuple(block.asked for block in kept.blocks) != tuple(block.measures for block in goal.blocks)
        or kept.weights != goal.objective(library).weights,
        "another choice of joints": spared[0] != spared[1],
        "another stage": kept.animation.stage_m != animation.stage_m,
        "joins of another kind": (kept.animation.blend, kept.animation.is_cleaned)
        != (animation.blend, animation.is_cleaned),
        "a search that was interrupted": kept.is_interrupted,
    }
    others = " and ".join(words for words, is_other in differs.items() if is_other)
    if others:
        raise InputError(
            f"the dance that is there has {others}",
            where=folder / name,
            remedy="give this one another name or folder, or remove it",
        )
    return kept
