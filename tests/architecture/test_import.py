"""Importing studykit does nothing and brings in nothing heavy."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

VENDORS = ("torch", "smplx", "bleak", "pyorbbecsdk", "mediapipe", "pylsl")
HEAVY = (
    *VENDORS,
    "pingouin",
    "seaborn",
    "tslearn",
    "statsmodels",
    "sklearn",
    "numba",
    "scipy.stats",
    "IPython",
    "anywidget",
    "ipywidgets",
)
# What `import studykit` itself must not even touch, though single rooms may.
FIRST_IMPORT = (
    *HEAVY,
    "numpy",
    "scipy",
    "pandas",
    "matplotlib",
    "pyarrow",
    "jinja2",
    "pydantic",
    "typer",
    "rich",
)

# A widget is a class of anywidget's, which brings in IPython. Such classes stand in modules of this name in
# the rooms of studykit.widgets, which are imported when a widget is first asked for, and by nothing else.
WIDGETS = tuple(
    f"studykit.widgets.{room}.widget"
    for room in ("body_map", "browser", "designer", "player", "rater", "reviewer")
)

# Compiled by numba, which writes what it compiled beside them; imported where they are used, by nothing else.
COMPILED = (
    "studykit.choreography.neighbours",
    "studykit.choreography.rjmcmc.join_speed",
    *(
        f"studykit.choreography.rjmcmc.kernel.{room}"
        for room in ("compiling", "moving", "running", "weighing")
    ),
    "studykit.motion.clearance",
    "studykit.analysis.warping_kernel",
)

IMPORT_EVERYTHING = f"""
    import importlib, pkgutil, studykit
    for module in pkgutil.walk_packages(studykit.__path__, "studykit."):
        if module.name not in {WIDGETS + COMPILED}:
            importlib.import_module(module.name)
"""
IMPORT_WIDGETS = f"""
    import importlib
    for name in {WIDGETS}:
        importlib.import_module(name)
"""


def run(code: str, folder: Path) -> list[str]:
    """Run code in a fresh process and give the lines it prints."""
    done = subprocess.run(
        [sys.executable, "-B", "-W", "error", "-c", textwrap.dedent(code)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ) | {"PYTHONPATH": str(Path(__file__).parents[2])},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_import_studykit_brings_in_nothing(tmp_path: Path) -> None:
    loaded = run("import sys, studykit\nprint(*sys.modules, sep='\\n')", tmp_path)
    assert "studykit" in loaded
    assert not set(FIRST_IMPORT) & set(loaded)


def test_no_module_brings_in_what_is_heavy(tmp_path: Path) -> None:
    loaded = run(f"{IMPORT_EVERYTHING}\n    import sys\n    print(*sys.modules, sep='\\n')", tmp_path)
    assert "studykit.cli" in loaded
    assert "studykit.library.fetch" in loaded
    assert "studykit.widgets.player.material" in loaded
    assert not set(HEAVY) & set(loaded)
    assert not {*WIDGETS, *COMPILED} & set(loaded)


WATCHED = """
    import logging, os, sys, threading

    import anywidget, matplotlib.figure, numpy, pandas, pydantic, scipy, typer  # their business is not ours
    done = []

    def watch(event, args):
        if event == "open":
            is_deed = bool(args[2] & (os.O_WRONLY | os.O_RDWR))
        else:
            is_deed = event.startswith(("socket.", "subprocess.", "os.mkdir", "os.remove", "os.rename"))
        if is_deed:
            done.append(f"{event} {args}")

    sys.addaudithook(watch)
    before = (os.getcwd(), dict(os.environ), logging.root.handlers[:], threading.active_count())
    CODE
    after = (os.getcwd(), dict(os.environ), logging.root.handlers[:], threading.active_count())
    found = list(done)
    print("unchanged" if before == after else (before, after))
    print(*found, sep="\\n")
"""


@pytest.mark.parametrize("modules", [IMPORT_EVERYTHING, IMPORT_WIDGETS], ids=["all but widgets", "widgets"])
def test_importing_modules_does_nothing(modules: str, tmp_path: Path) -> None:
    code = textwrap.dedent(WATCHED).replace("CODE", textwrap.dedent(modules))
    assert [line for line in run(code, tmp_path) if line] == ["unchanged"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "deed",
    [
        "open('left-behind', 'w').close()",
        "import socket; socket.create_server(('127.0.0.1', 0)).close()",
        "import os; os.environ['STUDYKIT'] = '1'",
        "import logging; logging.basicConfig()",
    ],
)
def test_doing_something_would_be_noticed(deed: str, tmp_path: Path) -> None:
    code = textwrap.dedent(WATCHED).replace("CODE", deed)
    assert [line for line in run(code, tmp_path) if line] != ["unchanged"]
