"""What a notebook shows and lets a person do: play, browse, review and rate dances, spare joints, design."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from studykit.widgets.body_map.widget import joint_picker as joint_picker
    from studykit.widgets.browser.widget import library_browser as library_browser
    from studykit.widgets.designer.widget import dance_designer as dance_designer
    from studykit.widgets.player.watch import watch as watch
    from studykit.widgets.player.widget import MotionPlayer as MotionPlayer
    from studykit.widgets.rater.widget import rating as rating
    from studykit.widgets.reviewer.widget import review as review

_NAMES = {
    "MotionPlayer": "studykit.widgets.player.widget",
    "dance_designer": "studykit.widgets.designer.widget",
    "joint_picker": "studykit.widgets.body_map.widget",
    "library_browser": "studykit.widgets.browser.widget",
    "rating": "studykit.widgets.rater.widget",
    "review": "studykit.widgets.reviewer.widget",
    "watch": "studykit.widgets.player.watch",
}
__all__ = [*_NAMES]  # noqa: PLE0604 - names only


def __getattr__(name: str) -> Any:
    # The modules called `widget` are classes of anywidget's, which brings in IPython: each is imported only
    # when it is first asked for.
    if name in _NAMES:
        return getattr(import_module(_NAMES[name]), name)
    raise AttributeError(f"module 'studykit.widgets' has no attribute {name!r}")
