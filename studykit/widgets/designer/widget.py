"""The widget that designs a dance; imported only when one is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import traitlets

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.motion.kinematics import joint_positions
from studykit.widgets.body_map.spared import SparedJoints
from studykit.widgets.designer import account
from studykit.widgets.designer.settings import Settings, checked
from studykit.widgets.designer.workshop import Obstacle, Source, Workshop
from studykit.widgets.history import History
from studykit.widgets.player.widget import MotionPlayer

if TYPE_CHECKING:
    from studykit.choreography.dance import Dance
    from studykit.choreography.goal import Goal

_SETTINGS = Settings.__slots__
_SLIDERS = ("duration_s", "intensity", "variety")


def dance_designer(library: DanceLibrary, *, source: Source | None = None, **settings: Any) -> DanceDesigner:
    """Say what a dance shall be like, hear at once how close the library comes, and watch it.

    Parameters
    ----------
    library : DanceLibrary
        As `studykit.open_library` gives it.
    source : Source, optional
        Who finds the dances; studykit's own choreography if not given.
    **settings
        What to begin with: `duration_s`, `intensity` (percentile), `variety` (share), `transition`,
        `schedule`, `seed`, `weights`, `speed_limits_rad_s`.

    Returns
    -------
    DanceDesigner
        Show it as the last line of a cell. `.dance` is the dance that plays, `.goal` what was asked of it,
        `.save(folder)` writes it to files.

    Raises
    ------
    InputError
        If a setting cannot be used.
    """
    return DanceDesigner(Workshop(library, source=source), Settings(**settings))


class DanceDesigner(SparedJoints, MotionPlayer):
    """A player with the settings of a dance, and how close it came.

    Parameters
    ----------
    workshop : Workshop
        Finds the dances.
    settings : Settings
        What to begin with.
    """

    library_name = traitlets.Unicode(read_only=True).tag(sync=True)
    scales = traitlets.Dict(read_only=True).tag(sync=True)

    duration_s = traitlets.Float(32.0).tag(sync=True)
    intensity = traitlets.Float(75.0).tag(sync=True)
    variety = traitlets.Float(0.55).tag(sync=True)
    transition = traitlets.Bool(default_value=True).tag(sync=True)
    schedule = traitlets.Unicode("none").tag(sync=True)
    seed = traitlets.Int(0).tag(sync=True)

    found = traitlets.Enum(("", "preview", "dance"), "").tag(sync=True)
    targets = traitlets.Dict().tag(sync=True)
    blocks = traitlets.List(traitlets.Dict()).tag(sync=True)
    segments = traitlets.List(traitlets.Dict()).tag(sync=True)
    obstacle = traitlets.Dict().tag(sync=True)
    status = traitlets.Unicode().tag(sync=True)
    is_searching = traitlets.Bool().tag(sync=True)
    can_undo = traitlets.Bool(read_only=True).tag(sync=True)
    can_redo = traitlets.Bool(read_only=True).tag(sync=True)

    def __init__(self, workshop: Workshop, settings: Settings) -> None:
        self._workshop = workshop
        self._history = History(settings)
        self._goal: Goal | None = None
        self._dance: Dance | None = None
        self._last = settings
        self._nearest: Goal | None = None
        self._agreed: list[tuple[Settings, Goal]] = []
        self.set_trait("room", "designer")
        self.set_trait("library_name", workshop.library.name)
        self.set_trait("scales", workshop.scales())
        self.set_trait("suggested_speeds_rad_s", workshop.usual_speeds())
        super().__init__(
            is_synthetic=workshop.library.is_synthetic,
            **{name: getattr(settings, name) for name in _SETTINGS},
        )
        self._look()
        self.observe(self._heed_settings, list(_SETTINGS))
        self.on_msg(lambda _, message, __: self._heed(message))

    @property
    def settings(self) -> Settings:
        """What is set now."""
        return Settings(**{name: getattr(self, name) for name in _SETTINGS})

    @property
    def goal(self) -> Goal | None:
        """What is asked for in numbers; None where the settings cannot be met."""
        return self._goal

    @property
    def dance(self) -> Dance | None:
        """The dance that plays, a preview until `search` was called; None where there is none."""
        return self._dance

    def search(self) -> None:
        """Search the dance as long as the preset says, and play it."""
        self.is_searching, self.status = True, "Searching ..."
        try:
            self._find(is_preview=False)
        finally:
            self.is_searching = False

    def another(self) -> None:
        """Ask for another dance like this one."""
        self.seed += 1

    def use_nearest(self) -> None:
        """Ask for the nearest that the library can reach, because what was asked for is out of reach.

        Raises
        ------
        InputError
            If nothing is out of reach, or nothing near is known.
        """
        if self._nearest is None:
            raise InputError("nothing else is offered", remedy="move a slider")
        settings = self._workshop.settings_near(self._nearest, self.settings)
        # The sliders come near to this goal, but hold one energy and whole numbers only: it stays the goal
        # of these settings, whatever the seed.
        self._agreed.insert(0, (replace(settings, seed=0), self._nearest))
        self._set(settings)

    def undo(self) -> None:
        """Take the last change of a setting back."""
        self._set(self._history.back())

    def redo(self) -> None:
        """Make a change again that was taken back."""
        self._set(self._history.forth())

    def save(self, folder: str | Path) -> None:
        """Write the dance that plays to files: see `studykit.library.write_dances`.

        Raises
        ------
        InputError
            If there is no dance yet, or the folder cannot be written.
        """
        if self._dance is None or self.found != "dance":
            raise InputError("there is only a preview", where="save", remedy="find the dance first")
        name = self._workshop.save(self._dance, folder)
        self.status = f"Saved as {name} in {folder}."

    @traitlets.validate(*(name for name in _SETTINGS if name not in ("weights", "speed_limits_rad_s")))
    def _setting_can_be_used(self, proposal: Any) -> Any:
        return checked(proposal["trait"].name, proposal["value"])

    def _heed_settings(self, change: Any) -> None:
        """Search a preview of what is set now, once for all values that changed together."""
        if self.settings == self._last:
            return
        self._history.record(self.settings, change=change["name"] if change["name"] in _SLIDERS else "")
        self._look()

    def _set(self, settings: Settings) -> None:
        """Set all at once, and record it."""
        self.unobserve(self._heed_settings, list(_SETTINGS))
        try:
            with self.hold_sync():
                for name in _SETTINGS:
                    self.set_trait(name, getattr(settings, name))
                self._history.record(settings)
                self._look()
        finally:
            self.observe(self._heed_settings, list(_SETTINGS))

    def _look(self) -> None:
        self._last = self.settings
        self.set_trait("can_undo", self._history.can_go_back)
        self.set_trait("can_redo", self._history.can_go_forth)
        self._find(is_preview=True)

    def _find(self, *, is_preview: bool) -> None:
        """Search a dance and show it, or say why there is none."""
        settings = replace(self.settings, seed=0)
        agreed = next((goal for known, goal in self._agreed if known == settings), None)
        goal = agreed or self._workshop.goal(settings)
        if isinstance(goal, Obstacle):
            self._refuse(goal, targets={})
            return
        dance = self._workshop.dance(goal, self.seed, is_preview=is_preview)
        if isinstance(dance, Obstacle):
            self._refuse(dance, targets=self._workshop.targets(goal))
            return
        self._present(goal, dance, is_preview=is_preview)

    def _refuse(self, obstacle: Obstacle, *, targets: dict[str, str]) -> None:
        self._goal = self._dance = None
        self._nearest = obstacle.nearest
        self.show(
            np.zeros((0, len(self.parents), 3)),
            is_playing=False,
            title="",
            found="",
            status="No dance is as asked.",
            obstacle={"sentence": obstacle.sentence, "has_offer": obstacle.nearest is not None},
            targets=targets,
            blocks=[],
            segments=[],
            joint_report=[],
        )

    def _present(self, goal: Goal, dance: Dance, *, is_preview: bool) -> None:
        self._goal, self._dance, self._nearest = goal, dance, None
        self.show(
            joint_positions(dance.motion),
            frame_rate_hz=dance.motion.frame_rate_hz,
            title=f"{'Preview' if is_preview else 'Dance'}, {dance.motion.duration_s:g} s, seed {dance.seed}",
            is_synthetic=dance.is_synthetic,
            found="preview" if is_preview else "dance",
            status=self._workshop.words(goal, dance, is_preview=is_preview),
            obstacle={},
            targets=self._workshop.targets(goal),
            blocks=self._workshop.blocks(goal, dance),
            segments=account.segment_rows(dance),
            joint_report=account.joint_rows(dance, goal.mask),
        )

    def _heed(self, message: Any) -> None:
        """Act on what was pressed in the browser."""
        deeds: dict[str, Callable[[], None]] = {
            "search": self.search,
            "another": self.another,
            "nearest": self.use_nearest,
            "undo": self.undo,
            "redo": self.redo,
        }
        try:
            match message:
                case {"deed": "save", "folder": str(folder)}:
                    self.save(folder)
                case {"deed": str(deed)} if deed in deeds:
                    deeds[deed]()
                case _:
                    self.status = "The browser asked for something that a designer does not know."
        except (InputError, OSError) as error:
            self.status = f"Not done. {error}"
