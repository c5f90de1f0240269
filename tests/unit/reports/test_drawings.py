"""Figures that take dances which a study may lack, and what the others are drawn from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studykit.choreography.dance import Dance, DanceBlock, DanceMeasures
from studykit.core.errors import InputError
from studykit.library.dance_file import read_dances, write_dances
from studykit.motion.joint_mask import spare
from studykit.participant.effects import PAPER
from studykit.recording.study_folder import StudyFolder
from studykit.reports import simulated_people
from studykit.reports.draw import DRAWINGS, Material, draw
from studykit.reports.paper_drawings import _sparing
from studykit.reports.review_drawings import axis_label
from studykit.reports.simulated_people import block_conditions, distances, heart_rates
from studykit.reports.trials import trials


@pytest.fixture
def dance(recorded_study: Callable[[], Path]) -> Dance:
    return read_dances(StudyFolder(recorded_study()).dances)["intense-hard-on"]


def in_blocks(dance: Dance, energies: list[float], varieties: list[float]) -> Dance:
    """Give a dance in blocks of 4 s that were asked for so."""
    count = len(energies)
    motion = replace(
        dance.motion,
        rotations=np.tile(dance.motion.rotations, (count, 1, 1)),
        root_positions=np.tile(dance.motion.root_positions, (count, 1)),
    )
    asked = [
        DanceMeasures(duration_s=4.0, linear_energy=energy, rotational_energy=energy / 4.0, variety=variety)
        for energy, variety in zip(energies, varieties, strict=True)
    ]
    return replace(
        dance,
        condition="hiit-on",
        motion=motion,
        segments=dance.segments * count,
        displacements_m=(0.1,) * (count - 1),
        blocks=tuple(DanceBlock(asked=one, achieved=one, achieved_blended=one) for one in asked),
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("1", "--spare right_elbow --spare right_shoulder --out SPARED', then add --dances SPARED"),
        ("9", "no dance spares a joint"),
        ("10a", "--schedule hiit --out BLOCKS', then add --dances BLOCKS"),
        ("10b", "--schedule waves --out BLOCKS', then add --dances BLOCKS"),
    ],
)
def test_without_its_dance_a_figure_says_what_to_make(
    name: str, words: str, recorded_study: Callable[[], Path]
) -> None:
    with pytest.raises(InputError) as error:
        draw(recorded_study(), only=[name])
    assert words in str(error.value)
    assert str(error.value).count("\n") == 0


def test_further_dances_are_drawn_and_marked_as_simulated(
    recorded_study: Callable[[], Path], dance: Dance, tmp_path: Path
) -> None:
    study = recorded_study()
    spared = replace(dance, mask=spare("right_elbow"))
    blocks = in_blocks(dance, [2.0, 1.0], [1.0, 1.0])
    write_dances({dance.condition: spared}, tmp_path / "spared")
    write_dances({"hiit-on": blocks}, tmp_path / "blocks")
    paths = draw(study, only=["1", "9", "10a"], dances=[tmp_path / "spared", tmp_path / "blocks"])
    assert [path.name for path in paths if path.suffix == ".pdf"] == [
        "figure-1.pdf", "figure-9.pdf", "figure-10a.pdf",
    ]  # fmt: skip
    again = draw(study, only=["9"], dances=[tmp_path / "spared"])
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in paths[3:6]]
    material = Material(folder=StudyFolder(study), trials=trials(study), further=(spared, blocks))
    marks = {
        drawing.name: drawing.of(material).marks for drawing in DRAWINGS if drawing.name in ("1", "9", "10a")
    }
    assert marks["1"] == ("SYNTHETIC MOVEMENT",)
    assert marks["9"] == marks["10a"] == ("SIMULATED DATA", "SYNTHETIC MOVEMENT")


def test_a_sparing_dance_is_compared_with_one_of_its_own_library(
    recorded_study: Callable[[], Path], dance: Dance
) -> None:
    study = recorded_study()
    own = replace(dance, library_sha256="2" * 64, seed=9)
    spared = replace(own, mask=spare("right_elbow"))
    material = Material(folder=StudyFolder(study), trials=trials(study), further=(spared, own))
    assert _sparing(material) == (spared, own)


def test_blocks_are_named_after_the_conditions_that_they_are_nearest_to(dance: Dance) -> None:
    found = block_conditions(in_blocks(dance, [2.0, 1.0, 2.1], [80.0, 80.0, 140.0]))
    assert found == (
        ("intense-easy-on", 0.0, 4.0), ("light-easy-on", 4.0, 8.0), ("intense-hard-on", 8.0, 12.0),
    )  # fmt: skip
    assert block_conditions(dance) == (("intense-hard-on", 0.0, 4.0),)
    alike = block_conditions(in_blocks(dance, [1.0, 1.02], [80.0, 80.0]))
    assert {name for name, _, _ in alike} == {"light-easy-on"}


def test_hearts_rise_in_intense_blocks_and_recover_in_light_ones(dance: Dance) -> None:
    # Long enough for hearts to follow: sixteen blocks of 4 s make four stretches.
    levels = [2.0] * 4 + [1.0] * 4
    curve = heart_rates(in_blocks(dance, levels * 2, [80.0] * 16))
    at = {time: float(curve.values.mean(axis=0)[round(time / 0.5)]) for time in (0.0, 15.5, 31.5, 47.5, 63.5)}
    assert at[0.0] < at[15.5] > at[31.5] < at[47.5] > at[63.5]
    assert 55.0 < at[0.0] < 85.0


def test_distances_are_the_errors_that_were_planted(dance: Dance) -> None:
    curve = distances(dance, people=6)
    planted = PAPER.movement_error.expected("intense-hard-on")
    assert curve.values.shape == (6, 8)
    assert float(curve.values.mean()) == pytest.approx(planted, rel=0.25)


def test_the_same_seed_simulates_the_same_people_and_another_one_others(dance: Dance) -> None:
    first, again, other = (simulated_people.heart_rates(dance, seed=seed).values for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_every_outcome_has_words_for_its_axis() -> None:
    assert axis_label("dtw_lag_s") == "How late the dancer was; negative when early (s)"


def test_figures_have_distinct_names_and_the_papers_numbers_come_in_order() -> None:
    names = [drawing.name for drawing in DRAWINGS]
    assert len(set(names)) == len(names)
    assert [name for name in names if name[0].isdigit()] == [
        "1",
        "2",
        "3",
        "4",
        "6",
        "7",
        "8",
        "9",
        "10a",
        "10b",
    ]
