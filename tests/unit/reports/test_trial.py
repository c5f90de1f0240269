"""Trials that went wrong are measured as far as they can be, and stop nobody."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.motion.motion import JointTracks
from studykit.recording.session_record import SessionRecord
from studykit.reports.draw import draw
from studykit.reports.trials import trials


def test_a_trial_that_no_camera_saw_keeps_its_heart_and_stops_nobody(
    recorded_study: Callable[[], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = recorded_study()
    as_recorded = SessionRecord.frames

    def frames(record: SessionRecord, step: int) -> JointTracks:
        tracks = as_recorded(record, step)
        first = next(one.step for one in record.steps if one.phase == "perform")
        if step != first or record.participant != "01":
            return tracks
        return replace(tracks, positions=np.full_like(tracks.positions, np.nan))

    monkeypatch.setattr(SessionRecord, "frames", frames)
    table = trials(study)
    blind = table["dtw_m"].isna()
    assert blind.tolist() == table["linear_energy_danced"].isna().tolist()
    assert table.loc[blind, ["participant", "period"]].to_numpy().tolist() == [["01", 1]]
    assert table["heart_rate_mean_bpm"].notna().all()
    assert draw(study, only=["7", "6"])
