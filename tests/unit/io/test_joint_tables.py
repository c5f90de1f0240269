"""Tables of SMPL's joints: rows checked, unit and axes taken from the recipe, recipes checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.positions import JointTables
from studykit.io.datasets.read import named_recipe
from studykit.io.datasets.recipe import Recipe, built_in_recipes
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import AIST_BODY

FRAMES = 12


def joints() -> np.ndarray:
    """Give a dancer who turns and bends, joints in metres with Y up, shape (frame, 24, 3)."""
    time = np.arange(FRAMES)[:, None] / 30.0
    turns = 0.2 * np.sin(time[:, None] * np.linspace(1.0, 4.0, 24)[:, None]) * np.ones(3)
    turns[:, 4:6] = turns[:, 18:20] = 0.0
    turns[:, 4:6, 0] = 0.8 + 0.3 * np.sin(3.0 * time)
    places = np.array([0.3, 0.9, -0.2]) + np.zeros((FRAMES, 1, 3))
    return kinematics.centred_positions(AIST_BODY, rotation.exp(turns)) + places


def table(values: np.ndarray, separator: str = ",") -> str:
    return (
        "\n".join(separator.join(f"{x:.7f}" for x in row) for row in values.reshape(len(values), -1)) + "\n"
    )


def read(folder: Path, text: str, name: str = "a.csv", **settings: object) -> object:
    path = folder / name
    path.write_text(text)
    recipe = Recipe.model_validate(
        {"data_set": "made-up", "format": "positions", "skeleton": "aist"} | settings
    )
    (one,) = JointTables().read(path, recipe)
    return one


def test_unit_axes_and_rate_come_from_the_recipe(tmp_path: Path) -> None:
    z_up = 100.0 * joints()[..., [0, 2, 1]] * [1.0, -1.0, 1.0]
    rates = {"takes": ({"match": "*", "frame_rate_hz": 50.0},)}
    one = read(tmp_path, table(z_up), units_m=0.01, up="Z", **rates)
    assert kinematics.joint_positions(one.motion) == pytest.approx(joints(), abs=1e-6)
    assert one.motion.frame_rate_hz == 50.0
    assert read(tmp_path, table(joints())).motion.frame_rate_hz == 30.0


def test_names_of_aist_tell_dancer_and_genre(tmp_path: Path) -> None:
    one = read(tmp_path, table(joints()), "true_gLO_sFM_c01_d13_mLO2_ch09_slice12.csv")
    assert (one.performer, one.genre) == ("AIST d13", "lock")
    one = read(tmp_path, table(joints()), "gLO_of_somebody.csv")
    assert (one.performer, one.genre) == ("", "")


ROWS = table(joints())
BROKEN = {
    "empty": ("", "a.csv: the file is empty"),
    "a header": ("x,y,z\n" + ROWS, "a.csv, line 1: not 72 finite numbers between commas"),
    "a number missing": (ROWS.replace(",", "", 1), "a.csv, line 1: not 72 finite numbers"),
    "a number too many in one row and too few in the next": (
        ROWS.replace("\n", ",\n", 1).replace("\n,", "\n"),
        "a.csv, line 1: not 72 finite numbers",
    ),
    "tabs": (table(joints(), "\t"), "a.csv, line 1: not 72 finite numbers between commas"),
    "a word": (ROWS.replace("0.3000000", "here", 1), "a.csv, line 1: not 72 finite numbers"),
    "not a number": (ROWS.replace("0.3000000", "nan", 1), "a.csv, line 1: not 72 finite numbers"),
    "huge": (ROWS.replace("0.3000000", "1e300", 1), "a.csv, line 1: not 72 finite numbers"),
    "one point": (table(np.ones((5, 24, 3))), "a.csv: legs of 0 m .* units_m"),
    "joints of nobody": (
        table(joints()[:, np.random.default_rng(2).permutation(24)]),
        "a.csv: (no body fits|legs of)",
    ),
}


@pytest.mark.parametrize("mistake", BROKEN)
def test_a_broken_table_is_named_to_the_line(tmp_path: Path, mistake: str) -> None:
    text, message = BROKEN[mistake]
    with pytest.raises(InputError, match=message):
        read(tmp_path, text)


def test_a_table_in_the_wrong_unit_names_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.csv: legs of 81\.3 m .*; correct units_m"):
        read(tmp_path, table(100.0 * joints()))


@pytest.mark.parametrize("name", sorted(built_in_recipes()))
def test_every_built_in_recipe_is_complete(name: str) -> None:
    recipe = named_recipe(name)
    assert recipe.data_set == name
    assert recipe.licence
    assert recipe.citation


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('format = "bvh"\nskeleton = "dax"', r"library\.toml: skeleton: there is no 'dax'; choose .*daz, "),
        ('format = "bvh"', r"library\.toml: skeleton: there is no ''; choose "),
        (
            'format = "markers"\nskeleton = "daz"',
            r"there is no 'daz'; choose mocap-toolbox, or name a map file",
        ),
        ('format = "positions"\nskeleton = "mine.toml"', r"there is no 'mine\.toml'; choose smpl, aist\."),
        ('format = "bvh"\nskeleton = "mine.toml"', r"mine\.toml: there is no such file"),
        ('format = "markers"\nskeleton = "mine.toml"', r"mine\.toml: there is no such file"),
    ],
)
def test_a_recipe_with_a_skeleton_that_is_not_there_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "library.toml").write_text(f'data_set = "mine"\n{text}\n')
    with pytest.raises(InputError, match=message):
        named_recipe(tmp_path / "library.toml")


def test_digits_of_arabic_are_digits(tmp_path: Path) -> None:
    text = table(joints())
    plain = read(tmp_path, text)
    arabic = read(tmp_path, text.replace("3", "\N{ARABIC-INDIC DIGIT THREE}"))
    np.testing.assert_array_equal(arabic.motion.rotations, plain.motion.rotations)


@pytest.mark.parametrize("rate", [1e-300, 1.0, 1e6, 1e308])
def test_a_rate_of_no_camera_is_named_before_a_body_is_fitted(tmp_path: Path, rate: float) -> None:
    with pytest.raises(InputError, match=r"a\.csv: .* frames a second are no rate of motion capture"):
        read(tmp_path, table(joints()), frame_rates_hz={"*": rate})


@pytest.mark.parametrize("unit", [0.0, 1e-308, 1e308, float("nan")])
def test_a_unit_that_is_no_length_is_refused(tmp_path: Path, unit: float) -> None:
    path = tmp_path / "library.toml"
    path.write_text(f'data_set = "a"\nformat = "positions"\nskeleton = "aist"\nunits_m = {unit}\n')
    with pytest.raises(InputError, match=r"library\.toml, line 4, units_m"):
        named_recipe(path)
