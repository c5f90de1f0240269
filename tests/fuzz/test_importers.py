"""A hundred thousand broken, odd and hostile files: each gives takes, or one sentence that says what to do.

The inputs come from small good files, written by tests/native, which are changed from a fixed seed. Those
that break a promise are kept, and the failure names where. A few hundred are tried by default, all of them
by `make test-fuzz`.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import pickle
import sys
import time
import warnings
import zipfile
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import scipy.sparse
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from studykit.core.errors import InputError
from studykit.io.datasets.known import DATASETS
from studykit.io.datasets.read import named_recipe, read_takes
from studykit.io.datasets.recipe import Recipe, built_in_recipes
from studykit.io.marker_map import marker_map
from studykit.io.restricted_pickle import read_pickle
from studykit.io.skeleton_map import skeleton_map, skeleton_names
from studykit.io.smpl_model import read_body_model
from studykit.motion.skeleton import JOINT_NAMES

TESTS = Path(__file__).parents[1]
SEED = 20_260_501
FULL = 1.0
SMOKE = 0.003


def loaded(path: str) -> ModuleType:
    """Load a module of the tests, which are no package."""
    name = f"fuzz_{path.replace('/', '_')}"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, TESTS / f"{path}.py")
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


pytest.importorskip("resource", reason="time and memory are bounded as POSIX does it")
conformance = loaded("conformance/test_datasets")
mutation = loaded("fuzz/mutation")
oracle = loaded("fuzz/oracle")
Input, Oracle, Record = oracle.Input, oracle.Oracle, oracle.Record
pick = mutation.pick
Generator = np.random.Generator


# --- good files to begin with ------------------------------------------------------------------------------

VARIANTS: dict[str, list[dict[str, object]]] = {
    "aistpp": [{"protocol": 0}, {"protocol": 2}, {"protocol": 4, "flat": False}],
    "aioz-gdance": [{}, {"body_numbers": 69}, {"body_numbers": 63}, {"body_numbers": 57}],
    "finedance": [{}, {"width": 319}, {"width": 168}],
    "amass": [{}, {"smplx": True}, {"smplx": True, "joined": False}, {"gender": b"male"}],
}
TAKES = {
    "aioz-gdance": 8000,
    "aistpp": 8000,
    "aistpp-keypoints": 6000,
    "amass": 8000,
    "asf-amc": 8000,
    "bvh": 9000,
    "finedance": 8000,
    "markers": 6000,
    "positions": 6000,
    "smpl-npz": 7000,
}
"""How many inputs each importer of takes is given, beside a file cut at every length."""


def plain_arrays(data: bytes) -> dict[str, np.ndarray]:
    """Take the arrays out of an archive but for those of objects, which nobody reads."""
    arrays = {}
    with np.load(io.BytesIO(data)) as archive:
        for name in archive.files:
            with contextlib.suppress(ValueError):
                arrays[name] = archive[name]
    return arrays


def short_dance(frames: int) -> dict[str, np.ndarray]:
    """Take the first frames of a dance slow enough for any rate."""
    values = conformance.dance(frames=250, dancers=2)
    return {
        name: value[:, :frames] if name in ("vectors", "pelvis", "joints", "world") else value
        for name, value in values.items()
    }


def seeds(name: str, folder: Path) -> list[tuple[dict[str, bytes], str]]:
    """Write good folders of a data set; give the files of each, and which is the take."""
    module = conformance.writer(name)
    found = []
    for frames in (4, 7):
        for number, words in enumerate(VARIANTS.get(name, [{}])):
            base = folder / f"{frames}-{number}"
            path = module.write(base, short_dance(frames), **words)
            files = {
                one.relative_to(base).as_posix(): one.read_bytes()
                for one in base.rglob("*.*")
                if one.is_file()
            }
            needed = {path.relative_to(base).as_posix()} | {
                one.relative_to(base).as_posix() for one in DATASETS[name].companions(path)
            }
            found.append(({one: files[one] for one in needed}, path.relative_to(base).as_posix()))
    return found


def reading(name: str, main: str, **changes: object) -> Callable[[Path], list[object]]:
    """Give how a folder of a data set is read."""
    recipe = Recipe(data_set="made-up", **(conformance.writer(name).RECIPE | changes))
    return lambda folder: read_takes(folder / main, folder, recipe)


# --- changed ones ------------------------------------------------------------------------------------------

TEXT_WORDS = {
    "bvh": b"ROOT JOINT End Site OFFSET CHANNELS MOTION Frames: Frame Time: Xposition Zrotation { } 3 6 "
    b"HIERARCHY",
    "asf-amc": b":root :bonedata :hierarchy :units begin end dof rx ry tz l axis XYZ ZYX XXX order length "
    b"name rad root limits direction # ( ) :DEGREES :RADIANS lfemur id angle position",
    "positions": b", ,, ; x y",
    "markers": b"MARKER_NAMES FREQUENCY NO_OF_FRAMES Hip_FL \t\t NO_OF_MARKERS 0.000",
}
RECIPE_CHANGES = {
    "units_m": [1e-6, 0.001, 0.01, 0.0254, 1.0, 1000.0],
    "up": ["Y", "Z"],
    "skip_frames": [0, 1, 2, 5, 10**30],
    "frame_rates_hz": [{"*": one} for one in (1e-308, 0.1, 30.0, 120.0, 1999.0, 1e9, 1e308)],
}
SKELETONS = {"bvh": skeleton_names(), "asf-amc": ("", *skeleton_names()), "positions": ("smpl", "aist")}


def content_changed(rng: Generator, name: str, data: bytes, other: bytes, file: str) -> bytes:
    """Change a file in a way that its format understands."""
    if file.endswith((".json", ".toml")) or name in TEXT_WORDS:
        words = TEXT_WORDS.get(name, b"style2 [[[ {} \\ud800 null").split(b" ")
        return mutation.text_changed(rng, data, other, words)
    if file.endswith(".pkl"):
        if rng.random() < 0.5:
            return mutation.instructions_changed(rng, data, other)
        return mutation.pickled(rng, mutation.values_changed(rng, pickle.loads(data)))
    if file.endswith(".npz"):
        return archive_changed(rng, data)
    if rng.random() < 0.5:
        return mutation.npy_lying(rng, data)
    return mutation.npy(mutation.array_changed(rng, np.load(io.BytesIO(data))))


def archive_changed(rng: Generator, data: bytes) -> bytes:
    """Change an archive, a file in it or its arrays."""
    kind = rng.random()
    if kind < 0.3:
        return mutation.npz_lying(rng, data)
    values = plain_arrays(data)
    if kind < 0.6:
        members = {f"{key}.npy": mutation.npy(value) for key, value in values.items()}
        key = str(pick(rng, list(members)))
        lie = pick(rng, [mutation.npy_lying, mutation.bytes_changed])
        return mutation.npz(members | {key: lie(rng, members[key])}, rng)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        changed = mutation.values_changed(rng, values)
    return mutation.npz({f"{key}.npy": mutation.npy(np.asarray(value)) for key, value in changed.items()})


BOMBS = [
    (2**20, b"\0"),
    *((2**21 - 2, fill) for fill in (b" ", b"0 ", b"\n", b"0,")),
    (2**24, b" "),
    (2**28, b"\n"),
]
"""Bytes; what unpacks to 2 MiB or less may be a take and is looked at, what unpacks to more is not."""


def bombs(name: str, good: list, count: int) -> Iterator[Input]:
    """Pack far more than a recording in place of each file."""
    files, main = good[0]
    for size, fill in BOMBS[:count]:
        for packing in (".xz", ".gz"):
            data = mutation.bomb(packing, size, fill)
            rest = {one: content for one, content in files.items() if one != main}
            yield Input(files=rest | {main + packing: data}, read=reading(name, main + packing), about="bomb")
            if name == "asf-amc":
                rest = {main: files[main], "01.asf" + packing: data}
                yield Input(files=rest, read=reading(name, main), about="bomb")
        if not main.endswith(".npz"):
            continue
        values = plain_arrays(files[main])
        for key in ("poses", "trans"):
            array = np.zeros((size // 8 // values[key].shape[1], values[key].shape[1]))
            members = {f"{one}.npy": mutation.npy(value) for one, value in (values | {key: array}).items()}
            data = mutation.npz(members, method=zipfile.ZIP_DEFLATED)
            yield Input(files={main: data}, read=reading(name, main), about="bomb in an archive")


def takes_inputs(name: str, good: list, rng: Generator, count: int) -> Iterator[Input]:
    """Make changed inputs of a data set without end but for a count."""
    for _ in range(count):
        files, main = pick(rng, good)
        files = dict(files)
        file = main if rng.random() < 0.75 else str(pick(rng, sorted(files)))
        other_files, other_main = pick(rng, good)
        other = other_files.get(file, other_files[other_main])
        kind, changes = rng.random(), {}
        about = "bytes"
        if kind < 0.3:
            files[file] = mutation.bytes_changed(rng, files[file], other)
        elif kind < 0.85:
            about = "content"
            files[file] = content_changed(rng, name, files[file], other, file)
            if rng.random() < 0.1:
                files[file] = mutation.bytes_changed(rng, files[file], other)
        elif kind < 0.93:
            about = "packed"
            ending, data = mutation.packed(rng, files.pop(file))
            main = main + ending if file == main else main
            files[file + ending] = data
        else:
            about = "recipe"
            possible = RECIPE_CHANGES | ({"skeleton": SKELETONS[name]} if name in SKELETONS else {})
            field = str(pick(rng, list(possible)))
            changes = {field: pick(rng, possible[field])}
            if rng.random() < 0.3:
                files[file] = content_changed(rng, name, files[file], other, file)
        yield Input(files=files, read=reading(name, main, **changes), about=about)


def cut_inputs(name: str, good: list, step: int) -> Iterator[Input]:
    """Cut the take at every length, or at every so many bytes."""
    files, main = good[0]
    data = files[main]
    for length in range(0, len(data), max(step, len(data) // 2500)):
        yield Input(files=files | {main: data[:length]}, read=reading(name, main), about=f"cut at {length}")


# --- recipes, maps, body models, pickles -------------------------------------------------------------------

TOML_WORDS = [
    *b"[ ] { } [[ ]] = == ' ''' \"\"\" # [takes] [[takes]] [joints] [turns] true".split(),
    *b"1979-05-27 07:32 0b1 0o7".split(),
    *b'"\\u0000" "\\ud800" "mine.toml" "\\u0000.toml" "other.toml" "../mine.toml"'.split(),
    *b'"bvh" "Y" "*" "[z-a]"'.split(),
    *b"skeleton units_m format takes match joints turns t_pose pelvis left_hip".split(),
    *b"skip_frames up groups a.b.c".split(),
    b"[" * 3000,
    b"x=" + b"{a=" * 2000,
    b"a." * 3000 + b"a=1",
    b'"' + b"x" * 300 + b'.toml"',
    b"\n".join(b"a%d = 1" % number for number in range(800)),
]
OWN_MAP = (
    "[joints]\n"
    + "\n".join(f'{name} = "{name}"' for name in JOINT_NAMES)
    + "\n[turns]\nhead = [0, 1.5, -3]\n"
)
OWN_RECIPE = """data_set = "mine"
format = "bvh"
skeleton = "mine.toml"
units_m = 1.0
skip_frames = 1
groups = [["salsa/01", "salsa/02"]]
[frame_rates_hz]
"*02.bvh" = 60
[[takes]]
match = "salsa/*"
genre = "salsa"
performer = "Ada"
frame_rate_hz = 50.0
"""


def with_recipe(folder: Path) -> list[object]:
    """Read a recipe, and a take if it is one for BVH files."""
    recipe = named_recipe(folder / "library.toml")
    path = folder / "salsa" / "01.bvh"
    meant = recipe.format == "bvh" and recipe.rule("salsa/01.bvh") is not None
    return list(read_takes(path, folder, recipe)) if meant else [recipe]


def with_map(folder: Path) -> list[object]:
    """Read a take on a skeleton of one's own."""
    recipe = Recipe(data_set="mine", format="bvh", skeleton=str(folder / "mine.toml"))
    return list(read_takes(folder / "salsa" / "01.bvh", folder, recipe))


def toml_good(name: str, folder: Path) -> list[tuple[dict[str, bytes], str, Callable]]:
    """Give good recipes or maps with what they need."""
    files, main = seeds("bvh", folder)[0]
    if name == "recipes":
        own = {main: files[main], "mine.toml": OWN_MAP.encode(), "library.toml": OWN_RECIPE.encode()}
        alone = lambda where: [named_recipe(where / "library.toml")]  # noqa: E731
        built_in = [({"library.toml": path.read_bytes()}, alone) for path in built_in_recipes().values()]
        return [(files, "library.toml", read) for files, read in [(own, with_recipe)] * 5 + built_in]
    if name == "marker maps":
        table = (Path(loaded("conformance/test_datasets").__file__).parents[2] / "studykit/io/markers").glob(
            "*.toml"
        )
        read = lambda where: [marker_map(str(where / "mine.toml"))]  # noqa: E731
        return [({"mine.toml": one.read_bytes()}, "mine.toml", read) for one in table]
    more = (TESTS.parent / "studykit/io/skeletons").glob("*.toml")
    only = lambda where: [skeleton_map(str(where / "mine.toml"))]  # noqa: E731
    take = {main: files[main]}
    limbs = OWN_MAP.replace("[joints]", 't_pose = "limbs"\n[joints]')
    return [
        (take | {"mine.toml": OWN_MAP.encode()}, "mine.toml", with_map),
        (take | {"mine.toml": limbs.encode()}, "mine.toml", with_map),
        *(({"mine.toml": one.read_bytes()}, "mine.toml", only) for one in sorted(more)),
    ]


def toml_inputs(good: list, rng: Generator, count: int) -> Iterator[Input]:
    """Change recipes and maps as text."""
    for _ in range(count):
        files, main, read = pick(rng, good)
        file = main if rng.random() < 0.8 or "mine.toml" not in files else "mine.toml"
        other = pick(rng, good)[0][main]
        change = mutation.bytes_changed if rng.random() < 0.2 else mutation.text_changed
        words = () if change is mutation.bytes_changed else (TOML_WORDS,)
        yield Input(files=files | {file: change(rng, files[file], other, *words)}, read=read, about="toml")


def body_arrays() -> dict[str, object]:
    """Make the arrays of a body model of two points."""
    rng = np.random.default_rng(0)
    return {
        "v_template": rng.normal(size=(2, 3)),
        "shapedirs": rng.normal(size=(2, 3, 10)),
        "posedirs": np.zeros((2, 3, 207), dtype=np.float32),
        "J_regressor": np.full((24, 2), 0.5),
        "weights": np.full((2, 24), 1 / 24),
        "kintree_table": np.array([[-1, *conformance.NEUTRAL_BODY.parents[1:]], range(24)]),
        "f": np.array([[0, 1, 0]], dtype=np.uint32),
    }


def body_good() -> list[tuple[str, bytes]]:
    """Give body models as archive and as the official pickle has them."""
    values = body_arrays()
    sparse = values | {"J_regressor": scipy.sparse.csc_matrix(values["J_regressor"]), "bs_type": "lrotmin"}
    chumpy = loaded("golden/test_smplx_model").chumpy_pickle
    archive = mutation.npz({f"{key}.npy": mutation.npy(value) for key, value in values.items()})
    pickles = [*(pickle.dumps(sparse, protocol) for protocol in (0, 2, 4)), chumpy(values, 2)]
    return [("model.npz", archive), *(("model.pkl", one) for one in pickles)]


def body_read(file: str) -> Callable[[Path], list[object]]:
    """Give how a body model is read and used."""

    def read(folder: Path) -> list[object]:
        model = read_body_model(folder / file)
        offsets = model.skeleton(betas=[0.5]).offsets
        assert np.all(np.isfinite(offsets))
        return [model]

    return read


def body_inputs(good: list, rng: Generator, count: int) -> Iterator[Input]:
    """Change body models."""
    values = body_arrays()
    for _ in range(count):
        file, data = pick(rng, good)
        other = pick(rng, good)[1]
        kind = rng.random()
        if kind < 0.25:
            data = mutation.bytes_changed(rng, data, other)
        elif kind < 0.35:
            ending, data = mutation.packed(rng, data)
            file += ending
        elif file.endswith(".npz"):
            data = content_changed(rng, "body", data, other, file)
        elif kind < 0.7:
            other = pick(rng, [one for name, one in good if name == "model.pkl"])
            data = mutation.instructions_changed(rng, data, other)
        else:
            data = mutation.pickled(rng, mutation.values_changed(rng, values))
        yield Input(files={file: data}, read=body_read(file), about="body")


ARGUMENTS = [
    b"K\x01", b"J\xff\xff\xff\xff", b"I1\n", b"L5L\n", b"G" + bytes(8), b"F1e308\n", b"U\x01a",
    b"X\x01\0\0\0a", b"\x8c\x02os", b"\x8c\x06system", b"C\x04\0\0\0\0", b"S'touch marker'\n", b"Vmarker\n",
    b"N", b"\x88", b"\x8a\x01\x07", b"\x8b\xff\xff\xff\x7f", b"T\xff\xff\xff\x7f", b"B\x02\0\0\0ab",
]  # fmt: skip
NAMES = [
    b"cnumpy\nndarray\n", b"cnumpy\ndtype\n", b"cnumpy.core.multiarray\n_reconstruct\n",
    b"c_codecs\nencode\n", b"cnumpy.core.multiarray\nscalar\n", b"cnumpy._core.numeric\n_frombuffer\n",
    b"ccollections\nOrderedDict\n", b"ccopyreg\n_reconstructor\n", b"cbuiltins\nset\n",
    b"cbuiltins\nbytearray\n", b"cbuiltins\ncomplex\n", b"cchumpy.ch\nCh\n",
    b"cscipy.sparse._csc\ncsc_matrix\n", b"cscipy.sparse\ncoo_array\n", b"cbuiltins\nlist\n",
    b"cos\nsystem\n", b"cbuiltins\nexec\n", b"cbuiltins\nopen\n", b"cthis\nd\n",
]  # fmt: skip
STEPS = [
    bytes([code]) for code in b"(0123NRQbdelo]}su)t\x81\x85\x86\x87\x88\x89\x90\x8f\x91\x92\x93\x94\x97\x98a"
]
MEMOS = [
    b"q\0",
    b"h\0",
    b"r\xff\xff\xff\xff",
    b"j\0\0\0\0",
    b"p1\n",
    b"g1\n",
    b"p-1\n",
    b"\x95" + b"\xff" * 8,
]
INSTRUCTIONS = [
    *ARGUMENTS,
    *NAMES,
    *STEPS * 2,
    *MEMOS,
    *mutation.GADGETS,
    b"\x82\x01",
    b"\x84\x01\0\0\0",
    b"Pmarker\n",
]
ALMOST = [  # what the parts of arrays look like, for sequences to find each other
    b"cnumpy\ndtype\n(S'f8'\nI0\nI1\ntR(I3\nS'<'\nNNNI-1\nI-1\nI0\ntb",
    (
        b"cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(I1\ntcnumpy\ndtype\n(S'f8'\ntR"
        b"I0\nC\x08\0\0\0\0\0\0\0\0tb"
    ),
    b"cscipy.sparse._csc\ncsc_matrix\n)\x81}(S'_shape'\n(I2\nI2\ntS'data'\nNub",
    b"]", b"}", b")", b"(", b"(I2\nI3\nt", b"(S'a'\nN", b"e", b"u", b"d", b"t", b"R", b"b", b"s", b"a",
]  # fmt: skip


def pickle_read(folder: Path) -> list[object]:
    """Read a pickle; a value of any kind will do."""
    read_pickle(folder / "take.pkl")
    return [None]


def pickle_inputs(good: list[bytes], rng: Generator, count: int) -> Iterator[Input]:
    """Make up sequences of instructions, and change good ones."""
    for _ in range(count):
        if rng.random() < 0.6:
            length = int(rng.integers(1, 30))
            parts = pick(rng, [INSTRUCTIONS, ALMOST, [*INSTRUCTIONS, *ALMOST]])
            data = pick(rng, [b"", b"\x80\x02"]) + b"".join(pick(rng, parts) for _ in range(length)) + b"."
        elif rng.random() < 0.7:
            data = mutation.instructions_changed(rng, pick(rng, good), pick(rng, good))
        else:
            data = mutation.bytes_changed(rng, pick(rng, good), pick(rng, good))
        yield Input(files={"take.pkl": data}, read=pickle_read, about="instructions")


# --- all of them -------------------------------------------------------------------------------------------

OTHERS = {"body model": 6000, "marker maps": 3000, "pickles": 20_000, "recipes": 5000, "skeleton maps": 4000}
ALL = sorted(TAKES | OTHERS)


def inputs(name: str, folder: Path, share: float) -> tuple[list[Input], Iterator[Input]]:
    """Give good inputs of an importer and the changed ones."""
    rng = np.random.default_rng([SEED, ALL.index(name)])
    count = max(8, int(share * (TAKES | OTHERS)[name]))
    if name in TAKES:
        good = seeds(name, folder)
        fine = [Input(files=files, read=reading(name, main)) for files, main in good]
        changed = (
            bombs(name, good, len(BOMBS) if share == FULL else 1),
            takes_inputs(name, good, rng, count),
            cut_inputs(name, good, int(1 / share)),
        )
        return fine, chain(*changed)
    if name == "pickles":
        content = {
            "a": np.arange(3.0),
            "b": [1, (2, None)],
            "c": {"d": {1.5, "e"}},
            "f": np.float32(1),
            "g": 1j,
        }
        good = [pickle.dumps(content, protocol) for protocol in range(6)]
        good += [pickle.dumps(scipy.sparse.coo_matrix(np.eye(3)), protocol) for protocol in (0, 2)]
        plain = pickle.dumps(np.arange(3.0), 2)
        return [Input(files={"take.pkl": plain}, read=pickle_read)], pickle_inputs([plain, *good], rng, count)
    if name == "body model":
        good = body_good()
        fine = [Input(files={file: data}, read=body_read(file)) for file, data in good]
        return fine, body_inputs(good, rng, count)
    good = toml_good(name, folder)
    return [Input(files=files, read=read) for files, _, read in good], toml_inputs(good, rng, count)


def tried(name: str, share: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Record:
    """Let an importer read all its inputs."""
    folder = tmp_path / "data"
    folder.mkdir()
    monkeypatch.chdir(folder)
    fine, changed = inputs(name, tmp_path / "seeds", share)
    record = Record(name=name, seed=SEED)
    judge = Oracle(folder, record, tmp_path / "kept")
    for one in fine:
        assert judge.learn(one), "a good file is read"
    with oracle.guarded():
        for one in changed:
            judge.judge(one)
    return record


def told(record: Record, request: pytest.FixtureRequest) -> None:
    """Put the numbers into the table and fail with what was found."""
    request.node.user_properties.append(("fuzz", record.row()))
    if record.findings:
        pytest.fail("\n".join(record.findings.values()), pytrace=False)


@pytest.mark.fuzz
@pytest.mark.parametrize("name", ALL)
def test_any_file_gives_takes_or_a_remedy(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    told(tried(name, FULL, tmp_path, monkeypatch), request)


@pytest.mark.parametrize("name", ALL)
def test_some_files_give_takes_or_a_remedy(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    record = tried(name, SMOKE, tmp_path, monkeypatch)
    assert record.inputs >= 8
    told(record, request)


def told_by_sequence(parts: list[bytes], folder: Path) -> None:
    record = Record(name="sequence", seed=0)
    Oracle(folder, record, folder.parent / "kept").judge(
        Input(files={"take.pkl": b"".join(parts) + b"."}, read=pickle_read, about=repr(parts))
    )
    assert not record.findings, record.findings


SEQUENCES = st.lists(
    st.sampled_from([*INSTRUCTIONS, *ALMOST]) | st.binary(min_size=1, max_size=3), max_size=25
)
UNHURRIED = settings(
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate, Phase.shrink],
)


@pytest.mark.fuzz
def test_any_sequence_of_instructions_gives_a_value_or_a_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same as above, but what is found is made as short as can be."""
    folder = tmp_path / "data"
    folder.mkdir()
    monkeypatch.chdir(folder)

    @settings(UNHURRIED, max_examples=5000)
    @given(SEQUENCES)
    def sequences(parts: list[bytes]) -> None:
        told_by_sequence(parts, folder)

    with oracle.guarded():
        sequences()


# --- wrong importers, to prove that each broken promise is noticed -----------------------------------------


def wrong_lets_through(path: Path) -> list[object]:
    return [int(path.read_bytes())]


def wrong_executes(path: Path) -> list[object]:
    try:
        return [pickle.loads(path.read_bytes())]
    except Exception as error:
        raise InputError("broken", where=path, remedy="copy it again") from error


def wrong_warns(path: Path) -> list[object]:
    return [np.array([1e308]) * 10.0]


def wrong_is_slow(path: Path) -> list[object]:
    start = time.process_time()
    while time.process_time() < start + 0.06:
        pass
    return [path]


def wrong_writes(path: Path) -> list[object]:
    path.with_suffix(".cache").write_bytes(b"")
    return [path]


def wrong_names_nothing(path: Path) -> list[object]:
    raise InputError("broken", remedy="copy it again")


def wrong_says_too_much(path: Path) -> list[object]:
    error = InputError("broken", where=path, remedy="copy it again")
    error.args = (f"{error}\n{error}",)
    raise error


def wrong_has_no_numbers(path: Path) -> list[object]:
    motion = SimpleNamespace(rotations=np.ones((1, 24, 4)), root_positions=np.full((1, 3), np.nan))
    return [SimpleNamespace(motion=motion)]


def wrong_hoards(path: Path) -> list[object]:
    return [bytes(path.read_bytes()) + b"1" * 2**27]


def wrong_asks_for_too_much(path: Path) -> list[object]:
    try:
        return [bytearray(2**40)]
    except MemoryError as error:
        raise InputError("too large", where=path, remedy="cut it") from error


WRONG = {
    "lets ValueError through": (wrong_lets_through, b"no number"),
    "changes the files beside it": (wrong_executes, b"cos\nsystem\n(S'touch marker'\ntR."),
    "imports this": (wrong_executes, b"cthis\ns\n."),
    "lets RuntimeWarning through": (wrong_warns, b""),
    "takes 0": (wrong_is_slow, b""),
    "changes the files": (wrong_writes, b""),
    "names no path": (wrong_names_nothing, b""),
    "is not one sentence": (wrong_says_too_much, b""),
    "not finite": (wrong_has_no_numbers, b""),
    "MiB": (wrong_hoards, b""),
    "fills the memory": (wrong_asks_for_too_much, b""),
}


@pytest.mark.parametrize("finding", WRONG)
def test_an_importer_that_breaks_a_promise_is_noticed(
    finding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    importer, data = WRONG[finding]
    folder = tmp_path / "data"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.delitem(sys.modules, "this", raising=False)
    record = Record(name="wrong", seed=SEED)
    judge = Oracle(
        folder, record, tmp_path / "kept", most_cpu_s=0.05 if "takes" in finding else 1.0, most_bytes=2**26
    )
    with oracle.guarded():
        judge.judge(Input(files={"take.pkl": data}, read=lambda where: importer(where / "take.pkl")))
    (found,) = record.findings.values()
    assert finding in found
    assert f"seed {SEED}, input 0" in found
    kept = Path(found.split("kept in ")[1])
    assert (kept / "take.pkl").read_bytes() == data


def test_a_good_importer_breaks_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record = Record(name="right", seed=SEED)
    (tmp_path / "data").mkdir()
    monkeypatch.chdir(tmp_path / "data")
    judge = Oracle(tmp_path / "data", record, tmp_path / "kept")
    judge.judge(Input(files={"take.pkl": pickle.dumps([1.5])}, read=pickle_read))
    judge.judge(Input(files={"take.pkl": b"no pickle"}, read=pickle_read))
    assert (record.inputs, record.accepted, record.refused, record.findings) == (2, 1, 1, {})


def test_the_same_seed_makes_the_same_inputs(tmp_path: Path) -> None:
    for name in ALL:
        first, second = (
            [one.files for one in inputs(name, tmp_path / f"{name} {number}", SMOKE)[1]] for number in (1, 2)
        )
        assert first == second, name
