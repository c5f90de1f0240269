"""Recipes say how takes are read, and mistakes in them are named."""

from __future__ import annotations

from pathlib import Path

import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.read import find_recipe, named_recipe
from studykit.io.datasets.recipe import built_in_recipes


def test_the_first_rule_that_matches_holds(takes_folder: Path) -> None:
    recipe = find_recipe(takes_folder)
    waltz, tango = recipe.rule("waltz/02.bvh"), recipe.rule("tango.bvh")
    assert waltz is not None
    assert tango is not None
    assert (waltz.genre, waltz.performer, waltz.frame_rate_hz) == ("waltz", "Ada", 60.0)
    assert (tango.genre, tango.frame_rate_hz) == ("tango", None)
    assert recipe.rule("notes.txt") is None


@pytest.fixture
def cmu_folder(tmp_path: Path) -> Path:
    for name in ("salsa/01.bvh.xz", "salsa/16.bvh", "indian/04.bvh.xz"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    return tmp_path


@pytest.mark.parametrize(
    ("take", "performer", "rate"),
    [
        ("salsa/01.bvh", "CMU 60 (lead)", 60.0),
        ("salsa/15.bvh", "CMU 60 (lead)", 60.0),
        ("salsa/16.bvh", "CMU 61 (follow)", 60.0),
        ("salsa/30.bvh", "CMU 61 (follow)", 60.0),
        ("indian/15.bvh", "CMU 94", 120.0),
        ("martial/03.bvh", "CMU 135", 120.0),
    ],
)
def test_the_cmu_dances_are_known_by_their_files(cmu_folder, take, performer, rate) -> None:
    recipe = find_recipe(cmu_folder)
    rule = recipe.rule(take)
    assert (recipe.data_set, recipe.skeleton, recipe.skip_frames) == ("cmu-dance", "daz", 5)
    assert rule is not None
    assert (rule.performer, rule.frame_rate_hz) == (performer, rate)
    assert recipe.rule("standard.bvh") is None


def test_a_recipe_of_one_s_own_comes_before_a_built_in_one(cmu_folder, takes_folder) -> None:
    (cmu_folder / "library.toml").write_text((takes_folder / "library.toml").read_text())
    assert find_recipe(cmu_folder).data_set == "three-takes"


def test_a_part_of_the_cmu_files_is_not_taken_for_them(cmu_folder) -> None:
    (cmu_folder / "salsa" / "16.bvh").unlink()
    with pytest.raises(InputError, match=r"nothing says how to read these takes; put a library\.toml"):
        find_recipe(cmu_folder)


def test_every_built_in_recipe_can_be_read() -> None:
    assert "cmu-dance" in built_in_recipes()
    for path in built_in_recipes().values():
        assert named_recipe(path.stem).licence


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("skeleton =", "skeletn =", r"library\.toml, line 4, skeletn: .*skeleton"),
        ('"smpl"', '"smple"', r"library\.toml: skeleton: there is no 'smple'; choose .*daz.*smpl.*\."),
        ("units_m = 0.01", "units_m = -1", r"library\.toml, line 5, units_m: "),
        ("skip_frames = 4", "skip_frames = -4", r"library\.toml, line 6, skip_frames: "),
    ],
)
def test_a_mistake_in_a_recipe_is_named(tmp_path, takes_folder, right, wrong, message) -> None:
    text = (takes_folder / "library.toml").read_text()
    assert right in text
    (tmp_path / "library.toml").write_text(text.replace(right, wrong))
    with pytest.raises(InputError, match=message):
        find_recipe(tmp_path)


def test_a_folder_that_is_not_there(tmp_path) -> None:
    with pytest.raises(InputError, match=r"gone: there is no such folder; check the path\.$"):
        find_recipe(tmp_path / "gone")
