from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance import Dance
from studykit.core.errors import InputError
from studykit.library.dance_file import read_dances
from studykit.motion.joint_mask import spare
from studykit.recording.session_record import read_session
from studykit.recording.study_folder import StudyFolder
from studykit.reports.draw import Material, draw, figure
from studykit.reports.paper_drawings import _strip
from studykit.reports.trials import trials


def test_only_the_figure_asked_for_is_drawn(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    paths = draw(study, only=["7"])
    names = ["figure-7.svg", "figure-7.pdf", "figure-7.png"]
    assert [path.name for path in paths] == names
    assert {path.name for path in StudyFolder(study).figures.iterdir()} == set(names)


def test_an_unknown_figure_is_refused_before_anything_is_measured(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='no figure "5"; choose from 1, 2, 3, 4, 6, 7, 8, 9, 10a, 10b'):
        draw(tmp_path, only=["7", "5"])


def test_curves_are_those_of_the_recordings(recorded_study: Callable[[], Path]) -> None:
    folder = StudyFolder(recorded_study())
    table = trials(folder)
    dance = read_dances(folder.dances)["intense-hard-on"]
    strip = _strip(dance, Material(folder=folder, trials=table))
    some = table[table["condition"] == dance.condition].sort_values("participant")
    # The mean over the path (trials) weighs frames otherwise than the mean over the dance (curve).
    assert strip.distance_m.mean(axis=1) == pytest.approx(some["dtw_m"].to_numpy(), rel=0.05)
    record = read_session(folder.sessions()[0])
    (step,) = [s for s in record.steps if s.phase == "perform" and s.condition == dance.condition]
    for time_s, shown in zip(strip.times_s, strip.heart_rate_bpm[0], strict=True):
        before = record.heart_rate_times_s <= step.start_s + time_s
        assert shown == record.heart_rate_bpm[np.flatnonzero(before)[-1]]


def test_a_notebook_gets_one_figure_without_files(recorded_study: Callable[[], Path]) -> None:
    study = recorded_study()
    shown = figure(study, 1, dances=[_sparing_dance(study), *read_dances(StudyFolder(study).dances).values()])
    assert shown.axes
    assert not StudyFolder(study).figures.exists()
    with pytest.raises(InputError, match='no figure "5"'):
        figure(study, 5)


def _sparing_dance(study: Path) -> Dance:
    return replace(read_dances(StudyFolder(study).dances)["intense-hard-on"], mask=spare("right_elbow"))
