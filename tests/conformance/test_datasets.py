"""Every importer keeps to the same promises; a new one must bring a writer of its native files.

The writers are in tests/native, one module a data set (with _ for -). They know nothing of studykit, so that
an error in a reader is not undone by the same error in its writer. A module has `write(folder, dance)`, which
writes the layout as it is distributed and gives the path of the one take; `RECIPE`, `DANCERS`, `RATE_HZ`
(None where files say it); and, where they are not the usual ones, `JOINTS` (those that the format keeps),
`ROTATION_TOLERANCE` (rad; None: the format has no rotations), `POSITION_TOLERANCE_M`, `PERFORMER`, `GENRE`
and `RECOGNISED` (False: only a recipe can tell the format).
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from studykit.core.errors import InputError
from studykit.io.datasets.dataset import Performance
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import find_recipe, read_takes
from studykit.io.datasets.recipe import Recipe
from studykit.motion import kinematics, rotation
from studykit.motion.skeleton import AIST_BODY, JOINT_NAMES, NEUTRAL_BODY, Skeleton

NATIVE = Path(__file__).parents[1] / "native"
FRAMES = 40
FRAME_RATE_HZ = 50.0


def writer(name: str) -> ModuleType:
    """Load the writer of a data set's native files."""
    path = NATIVE / f"{name.replace('-', '_')}.py"
    if not path.exists():
        pytest.fail(f"the data set {name} has no writer of its native files: add tests/native/{path.name}")
    spec = importlib.util.spec_from_file_location(f"native_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def recipe(module: ModuleType) -> Recipe:
    return Recipe(data_set="made-up", **module.RECIPE)


def dance(*, dancers: int = 3, frames: int = FRAMES, seed: int = 5) -> dict[str, np.ndarray]:
    """Make up dancers who turn about, bend knees and elbows as people do, and move all the rest a little."""
    rng = np.random.default_rng(seed)
    times = np.arange(frames)[:, None, None] / FRAME_RATE_HZ
    vectors, pelvis = [], []
    for _ in range(dancers):
        phase, speed = rng.uniform(0, 6, (1, 24, 3)), rng.uniform(1, 4, (1, 24, 3))
        turns = 0.15 * np.sin(speed * times + phase)
        turns[:, 0, 1] += np.linspace(-1.0, 1.5, frames)
        for knee in (4, 5):
            turns[:, knee] = [[0.9 + 0.4 * np.sin(3 * t + knee), 0.0, 0.0] for t in times[:, 0, 0]]
        for elbow, side in ((18, -1.0), (19, 1.0)):
            turns[:, elbow] = [[0.0, side * (0.8 + 0.3 * np.sin(2 * t)), 0.0] for t in times[:, 0, 0]]
        vectors.append(turns)
        way = np.array([0.3, 0.02, 0.2]) * np.sin(1.5 * times[:, 0] + rng.uniform(0, 6, 3))
        pelvis.append(way + rng.uniform(-1.0, 1.0, 3) * [1, 0, 1] + [0.0, 0.95, 0.0])
    return posed(np.array(vectors), np.array(pelvis))


def posed(vectors: np.ndarray, pelvis: np.ndarray) -> dict[str, np.ndarray]:
    """Add what formats without rotations need: joints and their turns in the world, on the body of AIST++."""
    turns = rotation.exp(vectors)
    world = kinematics.global_rotations(AIST_BODY, turns)
    joints = kinematics.centred_positions(AIST_BODY, turns) + pelvis[:, :, None]
    return {
        "vectors": vectors,
        "pelvis": pelvis,
        "joints": joints,
        "world": rotation.to_matrix(world),
        "rate": np.array(FRAME_RATE_HZ),
        "names": np.array(JOINT_NAMES),
        "parents": np.array(NEUTRAL_BODY.parents),
        "offsets": NEUTRAL_BODY.offsets,
    }


def broken_at(frame: int) -> dict[str, np.ndarray]:
    """Make up a dance in which one frame has no numbers."""
    values = {name: np.array(value) for name, value in dance().items()}
    for name in ("vectors", "pelvis", "joints", "world"):
        values[name][:, frame] = np.nan
    return values


def expected_joints(
    values: dict[str, np.ndarray], dancer: int, body: Skeleton, *, has_rotations: bool
) -> np.ndarray:
    if not has_rotations:
        return values["joints"][dancer]
    turns = rotation.exp(values["vectors"][dancer])
    return kinematics.centred_positions(body, turns) + values["pelvis"][dancer][:, None]


def rotation_error(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.linalg.norm(rotation.between(expected, found), axis=-1).max())


@pytest.fixture(params=sorted(DATASETS))
def case(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[object, ModuleType, Path, Path]:
    """Give an importer, its writer, a folder as distributed and the one take in it."""
    module = writer(request.param)
    folder = tmp_path / "data"
    return DATASETS[request.param], module, folder, module.write(folder, dance())


def read(case: tuple[object, ModuleType, Path, Path]) -> list[Performance]:
    dataset, module, _, path = case
    return dataset.read(path, recipe(module))


def test_every_writer_belongs_to_an_importer_and_knows_nothing_of_studykit() -> None:
    assert {path.stem for path in NATIVE.glob("*.py")} >= {name.replace("-", "_") for name in DATASETS}
    for path in NATIVE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(name.split(".")[0] == "studykit" for name in names), path.name


def test_an_importer_says_what_it_is(case) -> None:
    dataset = case[0]
    assert DATASETS[dataset.name] is dataset
    assert len(dataset.native_format.split()) > 4
    assert bool(dataset.citation) == bool(dataset.licence)  # a mere file format has neither


def test_the_takes_are_listed_in_order_and_not_opened(case, monkeypatch: pytest.MonkeyPatch) -> None:
    dataset, _, folder, path = case
    second = path.with_name(path.name.replace("01", "02").replace("012", "013").replace("light", "intense"))
    if second == path:
        second = path.with_name(f"A{path.name}")
    second.write_bytes(b"not opened")
    opened = []
    real = Path.open

    def watched(self: Path, *words: object, **more: object) -> object:
        opened.append(self)
        return real(self, *words, **more)

    monkeypatch.setattr(Path, "open", watched)
    items = dataset.items(folder)
    assert items == sorted({path, second})
    assert not {path, second} & set(opened)


def test_an_empty_folder_has_no_takes(case, tmp_path: Path) -> None:
    dataset = case[0]
    (tmp_path / "empty").mkdir()
    assert dataset.items(tmp_path / "empty") == []
    assert not dataset.recognises(tmp_path / "empty")


def test_it_recognises_its_own_layout_and_nobody_else_does(case) -> None:
    dataset, module, folder, _ = case
    knows = [name for name, other in DATASETS.items() if other.recognises(folder)]
    assert knows == ([dataset.name] if getattr(module, "RECOGNISED", True) else [])
    if knows:
        assert find_recipe(folder).format == dataset.name


def test_what_is_read_is_what_was_danced(case) -> None:
    _, module, _, _ = case
    performances = read(case)
    assert len(performances) == module.DANCERS
    values = dance()
    joints = list(getattr(module, "JOINTS", range(24)))
    turning = getattr(module, "ROTATION_TOLERANCE", 1e-6)
    tolerance = getattr(module, "POSITION_TOLERANCE_M", 1e-6)
    for number, one in enumerate(performances):
        motion = one.motion
        assert motion.rotations.dtype == motion.root_positions.dtype == np.float64
        assert motion.rotations.shape == (FRAMES, 24, 4)
        assert np.abs(np.linalg.norm(motion.rotations, axis=-1) - 1.0).max() < 1e-12
        assert motion.frame_rate_hz == pytest.approx(module.RATE_HZ or FRAME_RATE_HZ, rel=1e-6)
        found = kinematics.joint_positions(motion)
        expected = expected_joints(values, number, motion.skeleton, has_rotations=turning is not None)
        assert np.linalg.norm(found - expected, axis=-1)[:, joints].max() < tolerance
        if turning is not None:
            expected_turns = rotation.exp(values["vectors"][number])[:, joints]
            assert rotation_error(motion.rotations[:, joints], expected_turns) < turning


def is_right_handed(joints: np.ndarray) -> bool:
    """Tell whether left, up and ahead are as in a person, whichever way the person lies."""
    at = {name: joints[:, number] for number, name in enumerate(JOINT_NAMES)}
    toes = at["left_foot"] + at["right_foot"] - at["left_ankle"] - at["right_ankle"]
    across = np.cross(at["left_hip"] - at["right_hip"], at["head"] - at["pelvis"])
    return bool(np.mean(np.sum(across * toes, axis=1)) > 0.0)


def test_a_dancer_stands_upright_with_left_on_the_left(case) -> None:
    at = JOINT_NAMES.index
    for one in read(case):
        joints = kinematics.joint_positions(one.motion)
        assert np.all(np.isfinite(joints))
        assert np.all(joints[:, at("head"), 1] > joints[:, at("pelvis"), 1] + 0.3)
        assert np.all(joints[:, at("pelvis"), 1] > joints[:, at("left_ankle"), 1] + 0.3)
        assert is_right_handed(joints)
        assert not is_right_handed(joints[..., [0, 2, 1]])  # wrong: y and z swapped instead of a turn


def test_dancers_and_names_are_told_apart(case) -> None:
    _, module, folder, path = case
    takes = read_takes(path, folder, recipe(module))
    assert len({take.name for take in takes}) == module.DANCERS
    for take in takes:
        assert len(take.source.partners) == module.DANCERS - 1
        assert take.source.performer == getattr(module, "PERFORMER", "not stated")
        assert take.source.genre == getattr(module, "GENRE", "not stated")
        assert take.motion.skeleton is NEUTRAL_BODY


def test_reading_twice_gives_the_same(case) -> None:
    for first, second in zip(read(case), read(case), strict=True):
        np.testing.assert_array_equal(first.motion.rotations, second.motion.rotations)
        np.testing.assert_array_equal(first.motion.root_positions, second.motion.root_positions)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.5, 0.9])
def test_a_truncated_file_is_named(case, share: float) -> None:
    path = case[3]
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(InputError) as caught:
        read(case)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    "junk", [b"\0" * 1000, b"junk " * 300, bytes(range(256)) * 8, "é\n".encode("utf-16")]
)
def test_a_file_of_junk_is_named(case, junk: bytes) -> None:
    path = case[3]
    path.write_bytes(junk)
    with pytest.raises(InputError) as caught:
        read(case)
    assert str(path) in str(caught.value)


def test_a_frame_without_numbers_is_named(case, tmp_path: Path) -> None:
    dataset, module, _, _ = case
    path = module.write(tmp_path / "broken", broken_at(7))
    with pytest.raises(InputError) as caught:
        dataset.read(path, recipe(module))
    assert str(path) in str(caught.value)


def test_changed_bytes_give_a_dance_or_an_input_error(case) -> None:
    path = case[3]
    data = path.read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(40):
        changed = bytearray(data)
        # Headers are where it hurts; they are at either end.
        place = int(rng.choice([rng.integers(min(len(data), 400)), rng.integers(len(data))]))
        changed[place : place + int(rng.integers(0, 3))] = rng.bytes(int(rng.integers(1, 9)))
        path.write_bytes(changed)
        with contextlib.suppress(InputError):
            assert read(case)


def test_a_file_that_is_not_there_is_named(case) -> None:
    path = case[3]
    path.unlink()
    with pytest.raises(InputError) as caught:
        read(case)
    assert str(path) in str(caught.value)


def test_companions_are_paths_beside_the_take(case) -> None:
    dataset, _, folder, path = case
    assert all(folder in companion.parents for companion in dataset.companions(path))
