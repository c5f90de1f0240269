"""What every module keeps to, beyond what ruff and mypy see."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "studykit").glob("**/*.py"))
LONGEST_MODULE = 450

Documented = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def public(tree: ast.Module) -> Iterator[Documented]:
    """Give the public functions and classes of a module, and the public methods of those classes."""
    for node in tree.body:
        if isinstance(node, Documented) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from (
                    part
                    for part in node.body
                    if isinstance(part, Documented) and not part.name.startswith("_")
                )


def without_docstring(source: str) -> list[str]:
    """Name what is public and says nothing about itself in one sentence."""
    tree = ast.parse(source)
    found = [] if ast.get_docstring(tree) else ["the module"]
    for node in public(tree):
        first = (ast.get_docstring(node) or "").split("\n\n")[0]
        overrides = any(getattr(mark, "id", "") == "overload" for mark in node.decorator_list)
        if not overrides and not first.rstrip().endswith((".", ":")):
            found.append(node.name)
    return found


def test_every_public_name_says_what_it_is() -> None:
    silent = {str(path.relative_to(ROOT)): without_docstring(path.read_text()) for path in MODULES}
    assert {path: names for path, names in silent.items() if names} == {}


def test_a_missing_docstring_would_be_noticed() -> None:
    source = '"""Fine."""\nclass Silent:\n    def speak(self): ...\n    def _hide(self): ...\n'
    assert without_docstring(source) == ["Silent", "speak"]


def test_every_module_fits_in_the_head() -> None:
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in MODULES}
    assert {path: length for path, length in lengths.items() if length > LONGEST_MODULE} == {}


def test_nothing_is_called_by_its_use() -> None:
    assert not {"utils", "helpers", "common", "misc"} & {path.stem for path in MODULES}
    assert not {"utils", "helpers", "common", "misc"} & {path.parent.name for path in MODULES}


def pins() -> dict[str, str]:
    """Read constraints.txt; every line is a name and one release."""
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    exact = [
        re.fullmatch(r"([A-Za-z0-9._-]+)==([0-9][A-Za-z0-9.!]*)", line) for line in lines if line[:1] != "#"
    ]
    assert all(exact)
    return {canonicalize_name(pin[1]): pin[2] for pin in exact if pin}


def test_every_declared_package_is_pinned_to_a_release_that_fits() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    pinned = pins()
    for text in (
        *project["dependencies"],
        *extras["test"],
        *extras["bluetooth"],
        *extras["browser"],
        *extras["dev"],
    ):
        need = Requirement(text)
        if canonicalize_name(need.name) != "studykit":
            assert need.specifier.contains(pinned[canonicalize_name(need.name)]), text


def test_the_core_has_no_vendor_library() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    core = {Requirement(text).name for text in project["dependencies"]}
    assert not core & {"torch", "smplx", "bleak", "pyorbbecsdk2", "pyorbbecsdk", "mediapipe"}
