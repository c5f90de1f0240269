"""Raters' plan, sheet and targets: balanced, blind, never lost, and refused when they mean nothing."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.core.errors import InputError
from studykit.library.rating import (
    RatedTargets,
    RatingSheet,
    plan_of_sheet,
    rated_targets,
    rating_plan,
    window_motion,
)
from studykit.library.rating import plan as plan_module

HEADER = "event,rater,window,segments,intensity,variety\n"


@pytest.fixture(scope="module")
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    return made_library(40)


@pytest.fixture(scope="module")
def plan(library: DanceLibrary) -> pd.DataFrame:
    return rating_plan(library, windows=24)


def linear(library: DanceLibrary, segments: tuple[int, ...]) -> float:
    return float(sum(library.linear_energies[segment].sum() for segment in segments))


def variety(library: DanceLibrary, segments: tuple[int, ...]) -> float:
    """Measure by definition: the mean distance of all pairs of standardised vectors."""
    vectors = library.standardised(np.array(segments)).astype(float)
    return float(np.mean([np.linalg.norm(vectors[a] - vectors[b]) for a, b in combinations(range(8), 2)]))


def chains(plan: pd.DataFrame) -> dict[int, tuple[int, ...]]:
    return dict(zip(plan["window"], plan["segments"], strict=True))


def truthful(library: DanceLibrary, plan: pd.DataFrame, *, backwards: bool = False) -> pd.DataFrame:
    """Let every rater say what is so: the upper half of the energy is intense, of the variety hard."""
    measured = {window: (linear(library, own), variety(library, own)) for window, own in chains(plan).items()}
    middle = np.median(list(measured.values()), axis=0)
    rows = []
    for rater, window in zip(plan["rater"], plan["window"], strict=True):
        above = np.array(measured[window]) > middle
        rows.append(
            {
                "rater": rater,
                "window": window,
                "intensity": ("light", "intense")[int(above[0]) ^ backwards],
                "variety": ("easy", "hard")[int(above[1])],
            }
        )
    return pd.DataFrame(rows)


def test_everybody_rates_every_window_once_in_an_order_of_their_own(plan) -> None:
    assert list(plan.columns) == ["rater", "order", "window", "segments", "library"]
    orders = {rater: tuple(own["window"]) for rater, own in plan.groupby("rater")}
    assert set(orders) == {"A", "B", "C"}
    assert all(sorted(order) == list(range(1, 25)) for order in orders.values())
    assert len(set(orders.values())) == 3
    for _, own in plan.groupby("rater"):
        assert list(own["order"]) == list(range(1, 25))
    assert plan.groupby("window")["segments"].nunique().max() == 1


def test_each_window_comes_once_in_each_third_of_a_session(library) -> None:
    plan = rating_plan(library, windows=24, seed=3)
    third = (plan["order"] - 1) // 8
    assert plan.assign(third=third).groupby("window")["third"].agg(set).eq({0, 1, 2}).all()
    # Wrong: one random order each would leave some window early for everybody.
    rng = np.random.default_rng(0)
    random_orders = np.array([rng.permutation(24) for _ in range(3)]) // 8
    assert any(len(set(column)) < 3 for column in random_orders.T)


def test_quarters_of_energy_and_halves_of_variety_are_equally_frequent(library) -> None:
    own, strata = plan_module._stratified(library, 43, np.random.default_rng(1))
    counts = np.bincount(strata, minlength=8)
    assert counts.sum() == 43
    assert set(counts) == {5, 6}
    energies = np.array([linear(library, one) for one in own])
    varieties = np.array([variety(library, one) for one in own])
    for quarter in range(4):
        inside = strata // 2 == quarter
        assert energies[inside].min() > max(energies[strata // 2 < quarter], default=0.0)
        easy, hard = (varieties[strata == 2 * quarter + half] for half in (0, 1))
        assert easy.max() < hard.min()
    # What repeats much varies little: both kinds of dance are shown.
    repeats = np.array([len(set(one)) for one in own.tolist()])
    assert (repeats.min(), repeats.max()) == (2, 8)
    assert repeats[strata % 2 == 0].mean() + 1.0 < repeats[strata % 2 == 1].mean()


def test_neither_numbers_nor_order_tell_what_was_measured(library) -> None:
    plan = rating_plan(library, windows=200, raters=("A",))
    energies = np.array([linear(library, one) for one in plan["segments"]])
    for column in ("window", "order"):
        assert abs(np.corrcoef(plan[column], energies)[0, 1]) < 0.2


def test_windows_are_eight_segments_of_one_genre(library) -> None:
    genres = ["salsa"] * 20 + ["house"] * 16 + ["rare"] * 4
    mixed = replace(library, segments=library.segments.assign(genre=genres))
    plan = rating_plan(mixed, windows=40)
    for segments in plan["segments"]:
        assert len(segments) == 8
        assert len(set(np.array(genres)[list(segments)])) == 1
        assert "rare" not in np.array(genres)[list(segments)]


def test_the_same_seed_gives_the_same_plan(library, plan) -> None:
    assert rating_plan(library, windows=24).equals(plan)
    assert not rating_plan(library, windows=24, seed=1).equals(plan)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"windows": 7}, "7 windows"),
        ({"raters": ()}, "cannot be told apart"),
        ({"raters": ("A", "A")}, "cannot be told apart"),
        ({"raters": "ABC"}, "cannot be told apart"),
        ({"raters": ("A", "B\nC")}, "is no name"),
        ({"raters": ("A", " ")}, "is no name"),
    ],
)
def test_plans_that_cannot_be_are_refused(library, options, problem) -> None:
    with pytest.raises(InputError, match=problem):
        rating_plan(library, **options)


def test_a_library_of_seven_segments_has_no_window(made_library) -> None:
    with pytest.raises(InputError, match="7 segments are too few"):
        rating_plan(made_library(7))


def test_a_window_lasts_32_s_and_goes_through_its_segments(library, plan) -> None:
    segments = plan["segments"].iloc[0]
    motion = window_motion(library, segments)
    assert motion.duration_s == 32.0
    # In the middle of a segment nothing is blended; only the way the body faces follows the one before.
    middle = motion.rotations[3 * 120 + 60, 1:]
    own = library.rotations[segments[3]][60, 1:]
    assert np.abs(np.sum(middle * own, axis=-1)) == pytest.approx(1.0, abs=1e-9)
    with pytest.raises(InputError, match="no segments"):
        window_motion(library, (0, 40))


def test_answers_are_kept_and_resumed(tmp_path: Path, plan) -> None:
    path = tmp_path / "deep" / "ratings.csv"
    sheet = RatingSheet(path, plan)
    first, second, *rest = sheet.remaining("B")
    assert not path.exists()
    sheet.record(rater="B", window=first, intensity="light", variety="hard")
    sheet.record(rater="B", window=second, intensity="intense", variety="easy")
    again = RatingSheet(path, plan)
    assert again.remaining("B") == tuple(rest)
    assert len(again.remaining("A")) == 24
    assert again.ratings().to_dict("records") == [
        {"rater": "B", "window": first, "intensity": "light", "variety": "hard"},
        {"rater": "B", "window": second, "intensity": "intense", "variety": "easy"},
    ]


def test_nothing_is_erased_when_an_answer_is_withdrawn(tmp_path: Path, plan) -> None:
    path = tmp_path / "ratings.csv"
    sheet = RatingSheet(path, plan)
    first, second = sheet.remaining("A")[:2]
    sheet.record(rater="A", window=first, intensity="light", variety="hard")
    sheet.record(rater="A", window=second, intensity="light", variety="hard")
    other = sheet.remaining("C")[0]
    sheet.record(rater="C", window=other, intensity="light", variety="easy")
    before = path.read_bytes()
    assert sheet.undo("A") == second
    assert path.read_bytes().startswith(before)
    assert sheet.remaining("A")[0] == second
    sheet.record(rater="A", window=second, intensity="intense", variety="easy")
    table = RatingSheet(path, plan).ratings().set_index(["rater", "window"])
    assert tuple(table.loc[("A", second)]) == ("intense", "easy")
    assert len(table) == 3
    assert [sheet.undo("A"), sheet.undo("A")] == [second, first]
    with pytest.raises(InputError, match="no answer to withdraw"):
        sheet.undo("A")


def test_whatever_is_left_of_the_last_line_the_sheet_goes_on(tmp_path: Path, plan) -> None:
    path = tmp_path / "ratings.csv"
    sheet = RatingSheet(path, plan)
    first, second = sheet.remaining("A")[:2]
    sheet.record(rater="A", window=first, intensity="light", variety="hard")
    start = path.stat().st_size
    sheet.record(rater="A", window=second, intensity="intense", variety="hard")
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        cut = RatingSheet(path, plan)
        left = cut.remaining("A")
        if length < start - 1:
            assert left[0] == first
        elif length < len(whole) - 1:  # cut of its line's end alone, the last answer is complete
            assert left[0] == second
        for window in left[:2]:
            cut.record(rater="A", window=window, intensity="intense", variety="easy")
        assert len(RatingSheet(path, plan).ratings()) == 24 - len(left) + 2
        assert all(line.count(",") == 5 for line in path.read_text().splitlines())


def test_answers_that_are_none_are_refused(tmp_path: Path, plan) -> None:
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    window = sheet.remaining("A")[0]
    answer = {"rater": "A", "window": window, "intensity": "light", "variety": "easy"}
    for wrong, problem in (
        ({"rater": "D"}, 'no rater "D"'),
        ({"window": 99}, "not asked about window 99"),
        ({"intensity": "easy"}, "no answer about intensity"),
        ({"variety": ""}, "no answer about variety"),
    ):
        with pytest.raises(InputError, match=problem):
            sheet.record(**(answer | wrong))
    with pytest.raises(InputError, match='no rater "D"'):
        sheet.remaining("D")
    assert not sheet.path.exists()
    sheet.record(**answer)
    with pytest.raises(InputError, match="already"):
        sheet.record(**answer)


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda _: b"PK\x03\x04 something else\n", 1),
        (lambda good: HEADER.encode() + b"\n" + good, 2),
        (lambda good: HEADER.encode() + good + b"rated,A\n" + good, 3),
        (lambda good: HEADER.encode() + good + good, 3),
        (lambda good: HEADER.encode() + good.replace(b"light", b"heavy"), 2),
        (lambda good: HEADER.encode() + good.replace(b"rated", b"withdrawn"), 2),
        (lambda good: HEADER.encode() + b"\xff\xfe\n" + good, 2),
        (lambda good: HEADER.encode() + b'rated,"A' + b"\n" + good, 2),
        (lambda good: HEADER.encode() + good.replace(b",A,", b",Z,"), 2),
        (lambda good: HEADER.encode() + good + b"garbage\r" + good, 3),
        (lambda good: HEADER.encode() + b"rated,A," + b"9" * 9000 + b",1,light,easy\n", 2),
        (lambda good: HEADER.encode() + b"\x00" * 200_000 + b"\n", 2),
    ],
)
def test_a_damaged_sheet_is_refused_with_its_line(tmp_path: Path, plan, make, line) -> None:
    path = tmp_path / "ratings.csv"
    sheet = RatingSheet(path, plan)
    sheet.record(rater="A", window=sheet.remaining("A")[0], intensity="light", variety="easy")
    damaged = make(path.read_bytes()[len(HEADER) :])
    path.write_bytes(damaged)
    with pytest.raises(InputError, match=f"ratings.csv, line {line}: "):
        RatingSheet(path, plan)
    assert path.read_bytes() == damaged


def test_a_sheet_of_another_plan_is_refused(tmp_path: Path, library, plan) -> None:
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    sheet.record(rater="A", window=sheet.remaining("A")[0], intensity="light", variety="easy")
    with pytest.raises(InputError, match="line 2: this answer is not about the plan"):
        RatingSheet(sheet.path, rating_plan(library, windows=24, seed=9))
    with pytest.raises(InputError, match="no plan"):
        RatingSheet(sheet.path, plan.drop(columns="segments"))
    with pytest.raises(InputError, match="cannot be read"):
        RatingSheet(tmp_path, plan)


def test_targets_are_the_means_of_what_most_raters_called_so(library) -> None:
    plan = rating_plan(library, windows=32)
    ratings = truthful(library, plan)
    # One rater is contrary about one window: the other two outvote that.
    odd = ratings.index[(ratings["rater"] == "B") & (ratings["window"] == 5)][0]
    flipped = {"light": "intense", "intense": "light"}
    ratings.loc[odd, "intensity"] = flipped[ratings.loc[odd, "intensity"]]
    targets = rated_targets(ratings.sample(frac=1.0, random_state=0), plan, library)

    own = chains(plan)
    energies = np.sort([linear(library, one) for one in own.values()])
    varieties = np.sort([variety(library, one) for one in own.values()])
    assert targets.linear_energy == pytest.approx(
        {"light": energies[:16].mean(), "intense": energies[16:].mean()}
    )
    assert targets.variety == pytest.approx({"easy": varieties[:16].mean(), "hard": varieties[16:].mean()})
    assert targets.spreads["linear_energy"] == pytest.approx(np.std(energies, ddof=1))
    assert targets.counts == {
        "light": 16, "intense": 16, "undecided_intensity": 0, "easy": 16, "hard": 16, "undecided_variety": 0
    }  # fmt: skip
    assert targets.agreement["variety"].alpha == 1.0
    assert 0.9 < targets.agreement["intensity"].alpha < 1.0
    assert targets.library_sha256 == library.sha256

    saved = json.loads(json.dumps(targets.as_dict(), allow_nan=False))
    assert RatedTargets.from_dict(saved).as_dict() == targets.as_dict()
    assert RatedTargets.from_dict(saved).agreement == targets.agreement
    for wrong in ({}, saved | {"variety": None}, saved | {"agreement": {"intensity": {}}}):
        with pytest.raises(InputError, match="no rated targets"):
            RatedTargets.from_dict(wrong)


def test_two_raters_who_differ_leave_a_window_undecided(library) -> None:
    plan = rating_plan(library, windows=32, raters=("A", "B"))
    ratings = truthful(library, plan)
    contrary = ratings["window"].isin([1, 2, 3]) & (ratings["rater"] == "A")
    ratings.loc[contrary, "variety"] = ratings.loc[contrary, "variety"].map({"easy": "hard", "hard": "easy"})
    targets = rated_targets(ratings, plan, library)
    assert targets.counts["undecided_variety"] == 3
    assert targets.counts["easy"] + targets.counts["hard"] == 29


def test_ratings_that_make_no_target_are_refused(library, plan) -> None:
    ratings = truthful(library, plan)
    rare = ratings["window"].isin(sorted(set(ratings["window"]))[:4])
    for table, problem in (
        (ratings.iloc[:0], "0 people rated"),
        (ratings[ratings["rater"] == "A"], "1 people rated"),
        (ratings.assign(intensity="light"), "all ratings are the same"),
        (ratings.assign(intensity=np.where(rare, "intense", "light")), 'called 4 windows "intense"'),
        (ratings.assign(window=ratings["window"] + 7), "window 25 is not in the plan"),
        (ratings.assign(variety="middling"), "no answer about variety"),
        (truthful(library, plan, backwards=True), "have no more linear energy"),
    ):
        with pytest.raises(InputError, match=problem):
            rated_targets(table, plan, library)


def test_a_sheet_alone_gives_the_targets_of_its_plan(tmp_path: Path, library) -> None:
    plan = rating_plan(library, windows=32, raters=("NA", "007", "Ö, B."))
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    for row in truthful(library, plan).to_dict("records"):
        sheet.record(**row)
    again = sheet.undo("007")
    sheet.record(rater="007", window=again, intensity="light", variety="easy")
    own = plan_of_sheet(sheet.path)
    assert chains(own) == chains(plan)
    assert set(own["rater"]) == {"NA", "007", "Ö, B."}
    ratings = RatingSheet(sheet.path, own).ratings()
    from_sheet, from_plan = (rated_targets(ratings, one, library).as_dict() for one in (own, plan))
    assert from_sheet == from_plan


def test_a_torn_line_gives_no_window(tmp_path: Path, plan) -> None:
    sheet = RatingSheet(tmp_path / "ratings.csv", plan)
    for window in sheet.remaining("A")[:2]:
        sheet.record(rater="A", window=window, intensity="light", variety="hard")
    whole = sheet.path.read_bytes()
    start = whole.rstrip(b"\n").rindex(b"\n") + 1
    for length in range(start, len(whole) + 1):
        sheet.path.write_bytes(whole[:length])
        own = plan_of_sheet(sheet.path)
        assert len(own) == (2 if length >= len(whole) - 1 else 1)
        assert len(RatingSheet(sheet.path, own).ratings()) == len(own)
        assert set(own["segments"]) <= set(plan["segments"])


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (b"", "no rating sheet"),
        (b"\x89PNG\r\n\x1a\n\x00\xff", "no rating sheet"),
        (b"a,b\n1,2\n", "no rating sheet"),
        (HEADER.encode(), "nothing is rated yet"),
        (HEADER.encode() + b"rated,A,one,1 2,light,easy\n", "no rating sheet"),
        (HEADER.encode() + b"rated,A,1,1 b,light,easy\n", "no rating sheet"),
        (HEADER.encode() + b"rated,A," + b"9" * 9000 + b",1 2,light,easy\n", "no rating sheet"),
    ],
)
def test_what_is_no_sheet_gives_no_plan(tmp_path: Path, data, problem) -> None:
    path = tmp_path / "ratings.csv"
    path.write_bytes(data)
    with pytest.raises(InputError, match=f"ratings.csv: .*{problem}"):
        plan_of_sheet(path)
    with pytest.raises(InputError, match=r"missing\.csv: there is no such file"):
        plan_of_sheet(tmp_path / "missing.csv")


def test_a_plan_of_a_larger_library_is_refused(library, plan, made_library) -> None:
    with pytest.raises(InputError, match="about other segments than the library has now"):
        rated_targets(truthful(library, plan), plan, made_library(20))
