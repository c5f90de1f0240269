"""The widgets' doors cost nothing until they are opened."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import studykit.widgets


def test_importing_the_room_brings_in_no_widget_library(tmp_path: Path) -> None:
    code = (
        "import sys, studykit.widgets; print(sorted({'anywidget', 'ipywidgets', 'traitlets', 'numpy'} & "
        "set(sys.modules))); studykit.widgets.MotionPlayer; print('anywidget' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={"PYTHONPATH": str(Path(studykit.widgets.__file__).parents[2])},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split("\n")[:2] == ["[]", "True"]


def test_every_door_opens() -> None:
    assert sorted(studykit.widgets.__all__) == [
        "MotionPlayer",
        "dance_designer",
        "joint_picker",
        "library_browser",
        "rating",
        "review",
        "watch",
    ]
    for name in studykit.widgets.__all__:
        assert callable(getattr(studykit.widgets, name))
    with pytest.raises(AttributeError, match="stage"):
        studykit.widgets.stage  # noqa: B018 - asking is the test
