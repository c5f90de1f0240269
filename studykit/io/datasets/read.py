"""From a folder to takes: finding how it is read, listing its files, reading them one by one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from studykit.core.errors import InputError
from studykit.core.provenance import sha256_of_file
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.positions import BODIES
from studykit.io.datasets.recipe import FILE_NAME, Recipe, built_in_recipes
from studykit.io.datasets.take import Take, TakeSource
from studykit.io.marker_map import marker_map, marker_names
from studykit.io.packed import files_ending, plain_name
from studykit.io.skeleton_map import skeleton_map, skeleton_names
from studykit.io.toml_file import read_model
from studykit.motion.motion import Motion
from studykit.motion.plausibility import implausible
from studykit.motion.retargeting import on_neutral_body

_TAKES = (".bvh", ".amc", ".c3d", ".csv", ".fbx", ".npy", ".npz", ".pkl", ".tar", ".tsv", ".zip")


def find_recipe(folder: Path) -> Recipe:
    """Find how to read a folder: its own library.toml, or a data set that knows its files.

    Raises
    ------
    InputError
        If there is no such folder, nobody knows it, or the recipe has a mistake.
    """
    if not folder.is_dir():
        raise InputError("there is no such folder", where=folder, remedy="check the path")
    own = folder / FILE_NAME
    if own.exists():
        return named_recipe(own)
    for path in built_in_recipes().values():
        recipe = named_recipe(path)
        if recipe.recognised_by and all(any(folder.glob(f"{name}*")) for name in recipe.recognised_by):
            return recipe
    known = [dataset.name for dataset in DATASETS.values() if dataset.recognises(folder)]
    if len(known) == 1 or set(known) == {
        "aistpp",
        "aistpp-keypoints",
    }:  # one set, in two forms: its own first
        return Recipe(data_set=known[0], format=known[0])
    if known:
        remedy = "give the folder of each, or say which with --recipe"
        raise InputError(f"holds several data sets ({', '.join(known)})", where=folder, remedy=remedy)
    if not any(path.is_file() for path in folder.rglob("*")):
        raise InputError("there is no file in it", where=folder, remedy="check the path")
    raise InputError(
        "nothing says how to read these takes",
        where=folder,
        remedy=f"put a {FILE_NAME} beside them or give --recipe, or --skeleton for BVH files",
    )


def named_recipe(name: str | Path) -> Recipe:
    """Give a recipe by the name of a data set, or from a file.

    Raises
    ------
    InputError
        If there is no such data set or the file has a mistake; names the line and the remedy.
    """
    built_in = built_in_recipes()
    path = Path(name) if str(name).endswith(".toml") else built_in.get(str(name))
    if path is not None:
        return _checked(read_model(path, Recipe), path)
    if str(name) in DATASETS and DATASETS[str(name)].licence:
        return Recipe(data_set=str(name), format=str(name))
    known = sorted({*built_in, *(n for n, dataset in DATASETS.items() if dataset.licence)})
    raise InputError(f"there is no recipe {str(name)!r}", where="--recipe", remedy=f"say {', '.join(known)}")


def _checked(recipe: Recipe, path: Path) -> Recipe:
    if recipe.format not in DATASETS:
        remedy = f"choose {' or '.join(DATASETS)}"
        raise InputError(f"format: there is no {recipe.format!r}", where=path, remedy=remedy)
    known = {
        "asf-amc": ("", *skeleton_names()),
        "bvh": skeleton_names(),
        "markers": marker_names(),
        "positions": tuple(BODIES),
    }.get(recipe.format)
    if known is None:
        return recipe
    if recipe.skeleton.endswith(".toml") and recipe.format != "positions":  # lies beside the recipe
        own = str((path.parent / recipe.skeleton).resolve())
        (marker_map if recipe.format == "markers" else skeleton_map)(own)
        return recipe.model_copy(update={"skeleton": own})
    if recipe.skeleton not in known:
        own_file = "" if recipe.format == "positions" else ", or name a map file that ends in .toml"
        remedy = f"choose {', '.join(filter(None, known))}{own_file}"
        raise InputError(f"skeleton: there is no {recipe.skeleton!r}", where=path, remedy=remedy)
    return recipe


def files_in(folder: Path, recipe: Recipe) -> list[Path]:
    """List the files of a folder that a recipe means, in the order of their names.

    Raises
    ------
    InputError
        If there is none.
    """
    if not folder.is_dir():
        raise InputError("there is no such folder", where=folder, remedy="check the path")
    dataset = DATASETS[recipe.format]
    meant = [path for path in dataset.items(folder) if recipe.rule(plain_path(path, folder)) is not None]
    if not meant:
        raise InputError(
            f"no take to read ({dataset.native_format})",
            where=folder,
            remedy="check the folder, and the patterns of its recipe",
        )
    return meant


def unread_in(folder: Path, recipe: Recipe) -> list[Path]:
    """List the files of a folder that look like takes and that its recipe does not read."""
    read = set(files_in(folder, recipe))
    beside = {companion for path in read for companion in DATASETS[recipe.format].companions(path)}
    return [path for path in files_ending(folder, *_TAKES) if path not in read | beside]


def plain_path(path: Path, folder: Path) -> str:
    """Give the path of a file within its folder, with / and without .xz or .gz."""
    return path.relative_to(folder).with_name(plain_name(path)).as_posix()


def take_name(path: Path, folder: Path) -> str:
    """Give what the takes of a file are called: its path within the folder, without its endings."""
    plain = plain_path(path, folder)
    return plain.removesuffix(Path(plain).suffix)


def read_takes(path: Path, folder: Path, recipe: Recipe) -> list[Take]:
    """Read one file: a take for each dancer, on studykit's body, without the frames to skip.

    Raises
    ------
    InputError
        If the file is broken, too short, or moves as no body does (wrong unit, wrong axes, mirrored).
    """
    dataset = DATASETS[recipe.format]
    plain = plain_path(path, folder)
    stem = take_name(path, folder)
    performances = dataset.read(path, recipe.settled(plain))
    names = [f"{stem}/{one.dancer}" if one.dancer else stem for one in performances]
    digest = sha256_of_file(path)
    takes = []
    for name, one in zip(names, performances, strict=True):
        together = tuple(other for other in names if other != name) + recipe.partners(name)
        takes.append(
            Take(
                name=name,
                motion=_motion(one, path, plain, recipe),
                source=_source(one, plain, recipe, digest, together),
            )
        )
    return takes


def _motion(performance: Performance, path: Path, plain: str, recipe: Recipe) -> Motion:
    motion = performance.motion
    rate = recipe.frame_rate(plain)
    if rate is not None:
        motion = replace(motion, frame_rate_hz=rate)
    skip = recipe.skip_frames
    if len(motion) < skip + 2:
        problem = f"has {len(motion)} frames, {skip} are to be skipped"
        raise InputError(problem, where=path, remedy="remove the file or lower skip_frames")
    if skip:
        motion = replace(
            motion, rotations=motion.rotations[skip:], root_positions=motion.root_positions[skip:]
        )
    motion = on_neutral_body(motion)
    fault = implausible(motion)
    if fault:
        raise InputError(fault.problem, where=path, remedy=fault.remedy)
    return motion


def _source(
    performance: Performance, plain: str, recipe: Recipe, digest: str, together: tuple[str, ...]
) -> TakeSource:
    rule = recipe.rule(plain)
    dataset = DATASETS[recipe.format]
    return TakeSource(
        data_set=recipe.data_set,
        performer=(rule.performer if rule else "") or performance.performer or "not stated",
        genre=(rule.genre if rule else "") or performance.genre or "not stated",
        licence=recipe.licence or dataset.licence or "not stated",
        is_synthetic=recipe.is_synthetic,
        sha256=digest,
        partners=together,
        notes=performance.notes,
    )
