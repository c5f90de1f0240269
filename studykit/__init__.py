"""studykit: design, run and analyse clinical studies of personalised dance exergames.

A study in five lines::

    protocol = studykit.read_protocol("protocols/dance-2x2x2.toml")
    library = studykit.open_library("libraries/cmu-dance")
    dances = studykit.choreograph(protocol, library, seed=7)
    study = studykit.open_study("sessions/pilot", protocol=protocol)
    study.simulate(dances)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from studykit import analysis as analysis
    from studykit import figures as figures
    from studykit import library as library
    from studykit import protocol as protocol
    from studykit import reports as reports
    from studykit import widgets as widgets
    from studykit.choreography import choreograph as choreograph
    from studykit.choreography.choreograph import dance as dance
    from studykit.choreography.request import requested as requested
    from studykit.choreography.targets import goals as goals
    from studykit.io.protocol_file import read_protocol as read_protocol
    from studykit.library import open_library as open_library
    from studykit.session import open_study as open_study

__version__ = "0.1.0"

_ROOMS = ("analysis", "figures", "library", "protocol", "reports", "widgets")
_NAMES = {
    "choreograph": "studykit.choreography",
    "dance": "studykit.choreography.choreograph",
    "goals": "studykit.choreography.targets",
    "open_library": "studykit.library",
    "open_study": "studykit.session",
    "read_protocol": "studykit.io.protocol_file",
    "requested": "studykit.choreography.request",
}
__all__ = ["__version__", *_ROOMS, *_NAMES]  # noqa: PLE0604 - names only


def __getattr__(name: str) -> Any:
    # Importing studykit costs nothing: each room is opened when it is first asked for.
    if name in _ROOMS:
        return import_module(f"studykit.{name}")
    if name in _NAMES:
        return getattr(import_module(_NAMES[name]), name)
    raise AttributeError(f"module 'studykit' has no attribute {name!r}")
