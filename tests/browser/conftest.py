"""A JupyterLab of its own and a real Chromium; tests run notebooks in it and ask both sides."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import urlopen

import pytest

SIZE = {"width": 1280, "height": 1000}
CHROMIUM = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
NOT_OURS = (
    "favicon",  # JupyterLab asks for what it need not have
    "GPU stall due to ReadPixels",  # of the software renderer that stands in for a graphics card
    "GL Driver Message",
)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Start Chromium, or skip and say what is missing."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        pytest.skip("there is no Chromium on this machine")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=CHROMIUM)
        yield browser
        browser.close()


@dataclass
class Lab:
    """A running JupyterLab."""

    url: str
    folder: Path


@pytest.fixture(scope="session")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """Start JupyterLab with empty settings in a folder of its own."""
    home, folder = tmp_path_factory.mktemp("jupyter"), tmp_path_factory.mktemp("notebooks")
    (home / "config" / "labconfig").mkdir(parents=True)
    (home / "config" / "labconfig" / "page_config.json").write_text(
        json.dumps({"disabledExtensions": {"@jupyterlab/apputils-extension:announcements": True}})
    )
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    own = {
        "JUPYTER_CONFIG_DIR": home / "config",
        "JUPYTER_DATA_DIR": home / "data",
        "JUPYTER_RUNTIME_DIR": home / "runtime",
        "IPYTHONDIR": home / "ipython",
        "PYTHONPATH": Path(__file__).parents[2],
    }
    settings = (
        "--no-browser",
        "--allow-root",
        "--ip=127.0.0.1",
        f"--port={port}",
        "--IdentityProvider.token=",
        "--ServerApp.password=",
        "--ServerApp.port_retries=0",
        "--LabApp.expose_app_in_browser=True",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    )
    with (home / "log.txt").open("w") as log:
        server = subprocess.Popen(
            [sys.executable, "-m", "jupyter", "lab", *settings],
            cwd=folder,
            env=dict(os.environ) | {name: str(value) for name, value in own.items()},
            stdout=log,
            stderr=log,
        )
    url = f"http://127.0.0.1:{port}"
    try:
        _wait_for(f"{url}/api/status", server, home / "log.txt")
        yield Lab(url, folder)
    finally:
        server.terminate()
        server.wait(timeout=30)


def _wait_for(url: str, server: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(240):
        try:
            with urlopen(url, timeout=5):
                return
        except (URLError, OSError):
            assert server.poll() is None, log.read_text()
            time.sleep(0.25)
    raise AssertionError(log.read_text())


@dataclass
class Notebook:
    """An open notebook: its page, and a way to ask its kernel."""

    page: Any
    folder: Path
    asked: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def python(self, wanted: str) -> Any:
        """Give what the cells wrote about the kernel's side, once it is as wanted by the caller."""
        path = self.folder / "state.json"
        state = json.loads(path.read_text()) if path.exists() else {}
        return state.get(wanted)

    def wait_for(self, name: str, is_right: Callable[[Any], bool], *, patience_s: float = 30.0) -> Any:
        """Wait until the kernel holds a value that is right."""
        for _ in range(round(patience_s / 0.05)):
            value = self.python(name)
            if value is not None and is_right(value):
                return value
            self.page.wait_for_timeout(50)
        raise AssertionError(f"the kernel's {name} stayed {self.python(name)!r}")

    def picture(self, name: str) -> None:
        """Keep a picture of the widget where SHOTS says; for looking at, not for comparing."""
        if shots := os.environ.get("SHOTS"):
            self.page.locator(".sk-widget").first.screenshot(path=str(Path(shots) / f"{name}.png"))

    def dress(self, theme: str) -> None:
        """Change JupyterLab's theme."""
        self.page.evaluate(
            "theme => window.jupyterapp.commands.execute('apputils:change-theme', { theme })", theme
        )
        is_light = "true" if "Light" in theme else "false"
        self.page.wait_for_selector(f"body[data-jp-theme-light={is_light}]", state="attached")
        self.page.wait_for_timeout(600)


# Runs in the notebook's kernel: whatever Python holds is written to a file that the test reads.
WATCH = """
import json, os
from pathlib import Path

def watch(widget, *names, **more):
    values = {}
    def write(_=None):
        for name in names:
            values[name] = getattr(widget, name)
        values.update({name: read() for name, read in more.items()})
        Path("state.partial").write_text(json.dumps(values))
        os.replace("state.partial", "state.json")
    widget.observe(write, list(names))
    write()
"""


@pytest.fixture
def open_notebook(
    browser: Any, lab: Lab, request: pytest.FixtureRequest
) -> Iterator[Callable[..., Notebook]]:
    """Open a notebook with the given code, run all of it and wait for its widget."""
    opened: list[Notebook] = []
    contexts = []

    def begin(code: str, *, before: str = "") -> Notebook:
        name = request.node.name.replace("[", "-").replace("]", "")[:60]
        folder = lab.folder / name
        folder.mkdir()
        cells = [
            {"cell_type": "code", "id": f"c{k}", "metadata": {}, "outputs": [], "execution_count": None,
             "source": source}
            for k, source in enumerate((WATCH, code))
        ]  # fmt: skip
        kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
        (folder / "demo.ipynb").write_text(
            json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5})
        )
        context = browser.new_context(viewport=SIZE)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(30_000)
        notebook = Notebook(page, folder)
        opened.append(notebook)
        page.on("request", lambda asked: notebook.asked.append(asked.url))
        page.on("pageerror", lambda error: notebook.complaints.append(str(error)))
        page.on(
            "console",
            lambda said: notebook.complaints.append(said.text) if said.type == "error" else None,
        )
        if before:
            page.add_init_script(before)
        page.goto(f"{lab.url}/lab/tree/{name}/demo.ipynb?reset")
        page.wait_for_selector(".jp-Notebook .jp-Cell")
        try:
            # A notebook that is told to run before its kernel is there asks which kernel is meant.
            page.wait_for_function(
                "() => window.jupyterapp.shell.currentWidget?.sessionContext?.session?.kernel"
            )
            page.evaluate("() => { window.jupyterapp.commands.execute('notebook:run-all-cells') }")
            page.wait_for_selector(".jp-OutputArea-output .sk-widget")
        except Exception:
            if shots := os.environ.get("SHOTS"):
                page.screenshot(path=str(Path(shots) / "failed.png"))
            raise
        return notebook

    yield begin
    strangers = [
        url for each in opened for url in each.asked if not url.startswith((lab.url, "data:", "blob:"))
    ]
    complaints = [
        text for each in opened for text in each.complaints if not any(word in text for word in NOT_OURS)
    ]
    for each in opened:
        each.page.evaluate("() => window.jupyterapp.serviceManager.sessions.shutdownAll()")
    for context in contexts:
        context.close()
    assert strangers == []
    assert complaints == []
