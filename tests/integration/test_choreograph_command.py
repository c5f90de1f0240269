"""The command that makes dances: what it combines, what it refuses, and what an interruption leaves."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.choreography.dance import Dance
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.cli import main
from studykit.cli.choreograph import print_dances
from studykit.io.protocol_file import default_protocol
from studykit.library import make_sample, open_library, read_dances
from studykit.motion.joint_mask import JointMask, spare
from studykit.motion.skeleton import JOINT_NAMES
from studykit.reports import dance_page
from studykit.reports.page import Picture

SEARCH = import_module("studykit.choreography.choreograph")
KNEE, ELBOW = (JOINT_NAMES.index(name) for name in ("left_knee", "right_elbow"))
SPARE = """[dance.spare]
joints = ["left_knee"]
weight = 0.25
speed_percentile = 70.0
cost_weight = 0.2

[session]"""

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("libraries") / "sample"
    make_sample(out, segments=80, seed=3)
    return out


@pytest.fixture
def run(library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command on the library; give its exit code, what it says and what it complains of."""

    def command(*arguments: object, out: Path = tmp_path / "dances") -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as end:
            main(["choreograph", "--library", str(library), "--out", str(out), *map(str, arguments)])
        said = capsys.readouterr()
        return int(end.value.code or 0), said.out, said.err

    return command


@pytest.fixture
def protocol(tmp_path: Path) -> Path:
    """Write a protocol whose dances spare the left knee."""
    text = default_protocol().read_text(encoding="utf-8")
    path = tmp_path / "knee.toml"
    path.write_text(text.replace("[session]", SPARE, 1), encoding="utf-8")
    return path


class Asked:
    """In place of the search: remembers goals and libraries, and gives dances made before."""

    def __init__(self, dance: Dance) -> None:
        self.dance = dance
        self.goals: dict[str, Goal] = {}
        self.libraries: list[DanceLibrary] = []
        self.stops_at = 10**6
        self.stop: Any = None

    def __call__(self, goal: Goal, library: DanceLibrary, *, seed: int, **_: Any) -> Dance:
        self.goals[goal.condition] = goal
        self.libraries.append(library)
        is_stopped = len(self.goals) == self.stops_at
        if is_stopped and self.stop is not None:
            raise self.stop
        measures = goal.measures
        return replace(
            self.dance,
            condition=goal.condition,
            seed=seed,
            mask=goal.mask,
            note=goal.note,
            asked=measures,
            weights=goal.objective(library).weights,
            blocks=tuple(replace(self.dance.blocks[0], asked=block.measures) for block in goal.blocks),
            library_sha256=library.sha256,
            is_interrupted=is_stopped,
        )


@pytest.fixture(scope="module")
def found(library: Path) -> Dance:
    """Find one short dance, for all that only need one."""
    from studykit.choreography.choreograph import dance
    from studykit.choreography.request import requested

    opened = open_library(library)
    return dance(requested(opened, duration_s=12.0, transition="off"), opened, seed=1)


@pytest.fixture
def asked(found: Dance, monkeypatch: pytest.MonkeyPatch) -> Asked:
    stand_in = Asked(found)
    monkeypatch.setattr(SEARCH, "dance", stand_in)
    monkeypatch.setattr(SEARCH, "require_dances", lambda wanted, library: None)
    monkeypatch.setattr(  # figures take a second a dance
        dance_page,
        "picture",
        lambda title, _, caption: Picture(title=title, caption=caption, problem="left out"),
    )
    return stand_in


def limits(library: Path, joint: int, percentile: float) -> float:
    return float(np.percentile(open_library(library).peak_speeds[:, joint], percentile))


def mask_of(asked: Asked) -> JointMask:
    masks = {goal.mask for goal in asked.goals.values()}
    (mask,) = masks
    assert mask is not None
    return mask


def test_a_joint_that_is_named_is_spared_beside_those_of_the_protocol(
    run: Run, protocol: Path, asked: Asked, library: Path
) -> None:
    code, _, complaints = run("--protocol", protocol, "--spare", "right_elbow")
    assert code == 0, complaints
    assert len(asked.goals) == 8
    mask = mask_of(asked)
    assert mask.speed_limits_rad_s[KNEE] == pytest.approx(limits(library, KNEE, 70.0))
    assert mask.speed_limits_rad_s[ELBOW] == pytest.approx(limits(library, ELBOW, 50.0))
    assert (mask.weights[KNEE], mask.weights[ELBOW]) == (0.25, 0.0)


def test_of_two_that_spare_the_same_joint_the_stricter_holds(
    run: Run, protocol: Path, asked: Asked, library: Path
) -> None:
    run("--protocol", protocol, "--spare", "left_hip", "--speed-percentile", 90)
    mask = mask_of(asked)
    assert mask.speed_limits_rad_s[KNEE] == pytest.approx(limits(library, KNEE, 70.0))  # the protocol's
    assert mask.weights[KNEE] == 0.0  # what hangs on the hip


def test_a_percentile_that_is_said_holds_for_all_spared_joints(
    run: Run, protocol: Path, asked: Asked, library: Path
) -> None:
    run("--protocol", protocol, "--spare", "right_elbow", "--speed-percentile", 20)
    mask = mask_of(asked)
    for joint in (KNEE, ELBOW):
        assert mask.speed_limits_rad_s[joint] == pytest.approx(limits(library, joint, 20.0))
    assert np.isinf(mask.speed_limits_rad_s[JOINT_NAMES.index("left_elbow")])


@pytest.mark.parametrize("is_study", [True, False], ids=["protocol", "one dance"])
def test_limits_come_from_the_library_as_it_was_danced_whatever_arms_it_gets(
    run: Run,
    protocol: Path,
    asked: Asked,
    library: Path,
    monkeypatch: pytest.MonkeyPatch,
    is_study: bool,  # noqa: FBT001
) -> None:
    calm: list[JointMask] = []

    def spliced(danced: DanceLibrary, mask: JointMask, **_: Any) -> DanceLibrary:
        calm.append(mask)
        return replace(danced, peak_speeds=0.5 * danced.peak_speeds, sha256="2" * 64)

    monkeypatch.setattr("studykit.choreography.splicing.spliced", spliced)
    text = protocol.read_text(encoding="utf-8").replace("left_knee", "right_elbow")
    protocol.write_text(text, encoding="utf-8")
    code, _, complaints = run(
        *(("--protocol", protocol) if is_study else ("--spare", "right_elbow", "--speed-percentile", 70)),
        "--splice",
    )
    assert code == 0, complaints
    mask = mask_of(asked)
    assert calm == [mask]  # the protocol's own joint, where none is named
    assert asked.libraries[0].sha256 == "2" * 64
    assert mask.speed_limits_rad_s[ELBOW] == pytest.approx(limits(library, ELBOW, 70.0))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--protocol", "P", "--intensity", "light"], "--intensity: the conditions of a protocol say this"),
        (
            ["--protocol", "P", "--variety", "easy", "--transition", "on"],
            "--variety and --transition: the conditions",
        ),
        (["--protocol", "P", "--schedule", "hiit"], "--schedule: the conditions of a protocol say this"),
        (
            ["--protocol", "P", "--nearest"],
            "--nearest: the dances of a study must be what its conditions say",
        ),
        (["--schedule", "hiit", "--duration", 32], "--duration: a schedule has its own"),
        (["--schedule", "hiit", "--intensity", 60], "--intensity: a schedule has its own"),
        (["--speed-percentile", 50], "--speed-percentile: no joint is spared; name one with --spare."),
        (["--splice"], "--splice: no joint is spared; name one with --spare."),
        (
            ["--spare", "head", "--preset", "paper", "--speed-percentile", 0],
            "--speed-percentile: the printed formulas limit no joint",
        ),
        (["--stage", "3"], "'3' is no stage; say width x depth, such as 3x2.5."),
        (["--stage", "0x2"], "'0x2' is no stage"),
    ],
)
def test_what_would_have_no_effect_is_refused_in_one_sentence(
    run: Run, asked: Asked, tmp_path: Path, arguments: list[object], said: str
) -> None:
    code, _, complaints = run(*(default_protocol() if word == "P" else word for word in arguments))
    assert code == 2
    assert said in complaints.strip().splitlines()[-1]
    assert not asked.goals
    assert not (tmp_path / "dances").exists()


def test_the_help_shows_what_holds_where_nothing_is_said(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    _, said, _ = run("--help")
    for word in ("(light)", "(easy)", "(on)", "heart_rate_profile", "the pelvis"):
        assert word in said


def test_one_dance_may_come_nearest_and_says_so_first_in_its_file_and_on_its_page(
    run: Run, tmp_path: Path
) -> None:
    wish = ("--intensity", 100, "--variety", 2, "--duration", 12, "--transition", "off")
    code, _, complaints = run(*wish)
    assert (code, "cannot reach this" in complaints) == (2, True)
    code, said, complaints = run(*wish, "--nearest")
    assert code == 0, complaints
    (made,) = read_dances(tmp_path / "dances").values()
    assert "out of reach" in made.note
    assert said.startswith(f"NOTE on {made.condition}: {made.note}")
    assert "out of reach" in (tmp_path / "dances" / "dances.html").read_text(encoding="utf-8")
    code, _, complaints = run(*wish, "--nearest", "--seed", 1)
    assert (code, "has another seed (0)" in complaints) == (2, True)


@pytest.mark.parametrize("stop", [None, KeyboardInterrupt()], ids=["in a search", "between two"])
def test_of_an_interrupted_study_what_is_finished_is_written_and_the_rest_named(
    run: Run, asked: Asked, tmp_path: Path, stop: Any
) -> None:
    asked.stops_at, asked.stop = 3, stop
    code, said, complaints = run("--protocol", default_protocol())
    assert code == 130
    conditions = list(asked.goals)
    assert len(conditions) == 3  # nothing after the one that was interrupted
    assert list(read_dances(tmp_path / "dances")) == sorted(conditions[:2])
    assert f"INTERRUPTED: there is no dance yet for {conditions[2]}, " in complaints
    assert complaints.count("-on") + complaints.count("-off") >= 6
    assert conditions[0] in said
    asked.stops_at = 10**6
    asked.goals.clear()
    code, _, complaints = run("--protocol", default_protocol())
    assert code == 0, complaints
    assert len(asked.goals) == 6  # what is there is not searched again
    assert len(read_dances(tmp_path / "dances")) == 8


def test_an_interrupted_study_without_a_finished_dance_writes_nothing(
    run: Run, asked: Asked, tmp_path: Path
) -> None:
    asked.stops_at = 1
    code, _, complaints = run("--protocol", default_protocol())
    assert code == 130
    assert "INTERRUPTED" in complaints
    assert not (tmp_path / "dances").exists()


def test_the_best_so_far_of_one_dance_is_kept_and_not_taken_for_a_whole_one(
    run: Run, asked: Asked, tmp_path: Path
) -> None:
    asked.stops_at = 1
    code, said, complaints = run()
    assert code == 130
    assert "INTERRUPTED: light-easy-on is the best dance found until then." in said
    assert "goes on where it was" not in complaints
    assert read_dances(tmp_path / "dances")["light-easy-on"].is_interrupted
    asked.stops_at = 10**6
    code, _, complaints = run()
    assert (code, "has a search that was interrupted" in complaints) == (2, True)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (["--seed", 1], "another seed (0)"),
        (["--spare", "head"], "another choice of joints"),
        (["--stage", "3x2.5"], "another stage"),
        (["--weight", "transition=2"], "another goal"),
    ],
)
def test_another_dance_of_the_name_is_refused_before_any_search(
    run: Run, asked: Asked, other: list[object], said: str
) -> None:
    assert run()[0] == 0
    asked.goals.clear()
    code, _, complaints = run(*other)
    assert (code, said in complaints) == (2, True)
    assert not asked.goals
    assert run()[0] == 0  # the same again


def test_a_limit_that_is_not_kept_is_printed_as_broken(
    found: Dance, library: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    opened = open_library(library)
    peak, angle = (float(found.joints()["head"][name] or 0.0) for name in ("peak_rad_s", "angle_rad"))
    for speed, furthest, broken in ((1.1, 1.1, ""), (0.9, 1.1, ", BEYOND"), (1.1, 0.9, ", BEYOND")):
        mask = spare("head", speed_limits_rad_s=speed * peak, angle_limits_rad=furthest * angle)
        print_dances({"d": replace(found, mask=mask)}, opened)
        words = f"head {peak:.2f} of {speed * peak:.2f} rad/s and {angle:.2f} of {furthest * angle:.2f} rad"
        assert f"d spares: {words}{broken}\n" in capsys.readouterr().out


def test_a_stage_binds_the_pelvis_and_what_reaches_beyond_is_told(run: Run, tmp_path: Path) -> None:
    code, said, complaints = run("--duration", 12, "--transition", "off", "--stage", "0.4x0.4")
    assert code == 0, complaints
    (made,) = read_dances(tmp_path / "dances").values()
    # From the table of joints, written anew: how far each lies from where the pelvis began.
    from studykit.motion.kinematics import joint_positions

    away = np.abs(joint_positions(made.motion) - made.motion.root_positions[0])[..., [0, 2]] - 0.2
    beyond = f"hands and feet reach up to {100.0 * away.max():.0f} cm beyond"
    assert away.max() > 0.1
    assert f"{made.condition} keeps its pelvis within 0.4 x 0.4 m; {beyond}\n" in said
    assert beyond in (tmp_path / "dances" / "dances.html").read_text(encoding="utf-8")


def test_the_answer_for_machines_keeps_the_note(run: Run, asked: Asked) -> None:
    _, said, _ = run("--json")
    assert json.loads(said)["light-easy-on"]["note"] == ""
