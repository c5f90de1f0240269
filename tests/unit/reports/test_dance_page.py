"""A page of dances: its numbers are those of the dances, names stay text, and nothing is fetched."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studykit.choreography.dance import Animation, Dance, DanceBlock, DanceMeasures, DanceSegment
from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.rjmcmc.trace import TraceRow
from studykit.core.errors import InputError
from studykit.figures import film
from studykit.library.dance_file import write_dances
from studykit.motion import kinematics, rotation
from studykit.motion.joint_mask import spare
from studykit.motion.motion import Motion
from studykit.motion.skeleton import NEUTRAL_BODY
from studykit.reports import dance_page
from studykit.reports.beside_library import BesideLibrary
from studykit.reports.dance_facts import Reading, beyond_stage_m, facts, segments, spared_joints
from studykit.reports.dance_page import write_dance_page
from studykit.reports.page import Picture

KG = 50.0
ELBOW = NEUTRAL_BODY.index("right_elbow")
HOSTILE = "</script><script>document.title='broken'</script><img src=x>"


def measures(linear: float, rotational: float, variety: float) -> DanceMeasures:
    return DanceMeasures(duration_s=12.0, linear_energy=linear, rotational_energy=rotational, variety=variety)


@pytest.fixture(scope="module")
def made() -> Dance:
    """Make up a dance A B A′ whose right elbow turns at 1.2 rad/s at most."""
    times_s = np.arange(360) / 30.0
    vectors = np.zeros((360, 24, 3))
    vectors[:, ELBOW, 1] = 0.6 * np.sin(2.0 * times_s)
    vectors[:, 1, 0] = 0.5 * np.sin(5.0 * times_s)
    motion = Motion(
        skeleton=NEUTRAL_BODY,
        rotations=rotation.exp(vectors),
        root_positions=np.tile([0.5, 0.95, -1.0], (360, 1)),
        frame_rate_hz=30.0,
    )
    whole = {
        "asked": measures(2.0, 1.0, 80.0),
        "achieved": measures(2.02, 1.01, 80.5),
        "achieved_blended": measures(2.06, 0.93, 80.0),
    }
    return Dance(
        condition="intense-easy-on",
        seed=7,
        preset="studykit",
        targets_from="percentiles",
        segments=tuple(
            DanceSegment(
                id=number, take=take, start_s=2.5, mirrored=mirrored, licence="CC0-1.0", spliced_from=other
            )
            for number, take, mirrored, other in (
                (3, "kick", False, ""),
                (5, "wave", False, "right arm: calm at 1.00 s"),
                (4, "kick", True, ""),
            )
        ),
        motion=motion,
        **whole,
        blocks=(DanceBlock(**whole),),
        mask=spare("right_elbow", speed_limits_rad_s=1.5),
        cost_total=0.25,
        cost_terms={"linear": 0.04, "transition": 0.5},
        weights={"linear": 1.0, "rotational": 1.0, "variety": 1.0, "transition": 0.5},
        displacements_m=(0.031, 0.057),
        chain_costs=(0.75, 0.25, 0.5),
        trace=tuple(
            TraceRow(
                iteration=100 * row, temperature=1.0 / row, width=1.0, cost=1.0 / row, best_cost=1.0 / row,
                segments=3, accepted=0.5, terms={"linear": 1.0 / row},
            )
            for row in range(1, 5)
        ),
        library_sha256="1" * 64,
        is_synthetic=True,
        animation=Animation(blend="offset", is_cleaned=True, stage_m=(3.0, 2.5)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def library(made_library: Callable[..., DanceLibrary]) -> DanceLibrary:
    """Make up the library that the dance says it is made of."""
    return replace(made_library(8), sha256="1" * 64)


@pytest.fixture(scope="module")
def whole(made: Dance, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Give the page of the dance with all its figures."""
    path = tmp_path_factory.mktemp("page") / "page.html"
    return write_dance_page({"dance": made}, path, body_mass_kg=KG).read_text()


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """Write a page and read it; where only words matter its figures are left out, which take a second."""

    def without(title: str, _: Any, caption: str) -> Picture:
        return Picture(title=title, caption=caption, problem="left out")

    def written(*dances: Dance, **options: Any) -> str:
        monkeypatch.setattr(dance_page, "picture", without)
        named = {f"dance {number}": dance for number, dance in enumerate(dances)}
        return write_dance_page(named, tmp_path / "page.html", body_mass_kg=KG, **options).read_text()

    return written


def words(text: str) -> str:
    """Give what a person reads: without scripts, styles, marks and line breaks."""
    text = re.sub(r"<(script|style)\b.*?</\1>", " ", text, flags=re.DOTALL)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", text)).split())


def played(text: str) -> dict[str, Any]:
    """Give what the page hands to its player."""
    found = re.search(r'<script type="application/json" id="dances">(.*?)</script>', text, re.DOTALL)
    assert found
    return dict(json.loads(found[1]))


def test_the_page_says_what_was_asked_and_how_close_the_dance_came(
    made: Dance, page: Callable[..., str]
) -> None:
    read = words(page(made))
    assert "Intense – Easy, transition on, sparing right elbow" in read
    assert "a dance of 12 s: linear energy 100.0 J; rotational energy 50.0 J; variety 80.0;" in read
    assert "sparing the right elbow, with all beyond. Energies are for a body of 50 kg." in read
    assert "Not all of it is within 5 %" in read
    assert "linear energy 3.0 % above, rotational energy 7.0 % below, variety as asked." in read
    assert "103.0 J 3.0 % above 100.0 J asked (103.0 % of it); 101.0 J in the segments" in read
    assert "At its 2 joins, the poses that meet are 44 mm apart on average and 57 mm at most" in read
    assert "SYNTHETIC MOVEMENT" in read
    assert "stopped before its end" not in read


def test_a_dance_within_5_per_cent_is_called_so_and_an_interrupted_search_is_told(
    made: Dance, page: Callable[..., str]
) -> None:
    near = replace(
        made, achieved_blended=measures(2.06, 0.96, 80.0), is_interrupted=True, is_synthetic=False, mask=None
    )
    read = words(page(near))
    assert "All of it is within 5 % of what was asked" in read
    assert "The search was stopped before its end." in read
    assert "SYNTHETIC" not in read
    assert "Spared joints" not in read


@pytest.mark.parametrize(
    ("shown", "verdict", "is_close"),
    [
        (100.04, "as asked", True), (104.9, "4.9 % above", True), (94.0, "6.0 % below", False),
    ],
)  # fmt: skip
def test_a_reading_is_judged_by_the_movement_as_shown(shown, verdict, is_close) -> None:
    reading = Reading(name="energy", unit="J", asked=100.0, achieved=200.0, shown=shown)
    assert (reading.verdict, reading.is_close) == (verdict, is_close)
    assert Reading(name="energy", unit="J", asked=None, achieved=1.0, shown=1.0).verdict == "not asked for"


def blocks_of(made: Dance, *shown: DanceMeasures) -> Dance:
    """Give a dance whose blocks, 6 s each, came out so; as a whole it is as asked."""
    near = measures(2.0, 1.0, 80.0)
    return replace(
        made,
        achieved_blended=near,
        blocks=tuple(
            DanceBlock(asked=replace(near, duration_s=6.0), achieved=near, achieved_blended=one)
            for one in shown
        ),
    )


def test_of_a_dance_of_blocks_every_block_must_be_as_asked(made: Dance, page: Callable[..., str]) -> None:
    good, off = measures(2.06, 0.97, 80.0), measures(1.96, 1.06, 90.0)
    read = words(page(blocks_of(made, good, good)))
    assert (
        "Found: Every block is within 5 % of what was asked; over the whole dance: linear energy as" in read
    )
    text = page(blocks_of(made, good, off))
    read = words(text)
    assert (
        "Found: Not every block is within 5 % of what was asked: block 2 (6–12 s): "
        "rotational energy 6.0 % above, variety 12.5 % above; over the whole dance: linear energy as asked"
    ) in read
    assert "All of it is within" not in read
    assert text.count('<td class="far">') == 2


@pytest.mark.parametrize(
    ("condition", "title"),
    [("hiit-on", "HIIT"), ("warm-up-on", "Warm-up"), ("waves-off", "Waves"), ("60-0.7-on", "60 – 0.7")],
)
def test_schedules_have_the_names_that_people_give_them(made: Dance, condition: str, title: str) -> None:
    transition = condition.rpartition("-")[2]
    named = facts(replace(made, condition=condition, mask=None), KG)["title"]
    assert named == f"{title}, transition {transition}"


def test_limits_come_from_the_library_and_the_page_is_no_medical_advice(
    made: Dance, page: Callable[..., str], library: DanceLibrary
) -> None:
    peaks = np.tile(np.arange(1.0, 9.0)[:, None] / 2.0, (1, 24))  # 0.5 to 4.0 rad/s; the limit is 1.5
    read = words(page(made, library=replace(library, peak_speeds=peaks)))
    assert "1.50 rad/s (86°/s) 38 %" in read  # 3 of 8
    assert (
        "a speed limit is a percentile of how fast the segments of the library turn the joint at most" in read
    )
    assert "It measures the dance and is no medical advice." in read
    assert "Segments that keep it" not in words(page(made))


def test_the_joins_stand_beside_what_the_dancers_do_themselves(
    made: Dance, page: Callable[..., str], library: DanceLibrary
) -> None:
    usual = BesideLibrary(library=library, acceleration=1e-3, jolting=0.07)
    hard = usual.joins(made)
    assert hard is not None
    assert (hard["beyond"], hard["count"], hard["share"], hard["usual_share"]) == (2, 2, 1.0, 0.07)
    assert hard["words"].startswith(
        "As shown, 2 of 2 joins jolt harder than dancers do in all but a thousandth"
    )
    calm = replace(usual, acceleration=1e6).joins(made)
    assert calm is not None
    assert calm["words"].startswith("As shown, no join jolts harder")
    assert usual.joins(replace(made, segments=made.segments[:1])) is None
    read = words(page(made, library=library))
    measured = BesideLibrary.measured(library)
    assert f"Hardest jolt {hard['hardest']:.1f} m/s² below {measured.acceleration:.1f} m/s² in 99.9 %" in read
    assert "Joins as shown" not in words(page(made))


def test_a_page_beside_another_library_is_refused(
    made: Dance, page: Callable[..., str], library: DanceLibrary
) -> None:
    with pytest.raises(InputError, match="dance 0: it was not made of the library made-up"):
        page(made, library=replace(library, sha256="2" * 64))


@pytest.mark.parametrize("segments", [1, 2])
def test_very_short_dances_have_room_on_their_page(made: Dance, tmp_path: Path, segments: int) -> None:
    motion = replace(
        made.motion,
        rotations=made.motion.rotations[: 120 * segments],
        root_positions=made.motion.root_positions[: 120 * segments],
    )
    short = replace(
        made, motion=motion, segments=made.segments[:segments], displacements_m=(0.031,) * (segments - 1)
    )
    text = write_dance_page({"short": short}, tmp_path / "page.html").read_text()  # warnings are errors
    assert text.count("<figure>") == 5
    assert ("1 segment" in words(text), "joins as smooth" in words(text)) == (segments == 1, segments > 1)


def test_what_weighs_nothing_was_not_asked_for(made: Dance, page: Callable[..., str]) -> None:
    read = words(page(replace(made, weights=made.weights | {"variety": 0.0, "transition": 0.0})))
    assert "variety 80.0" not in read.split("Energies are for")[0]
    assert "joins however they come" in read
    assert "smoothness not asked for" in read


def test_spared_joints_stand_beside_their_limits(made: Dance, page: Callable[..., str]) -> None:
    elbow, wrist, hand = spared_joints(made)
    peak = float(kinematics.angular_speeds(made.motion.rotations, 30.0)[:, ELBOW].max())
    assert peak == pytest.approx(1.2, abs=0.01)
    assert elbow["peak"] == peak
    assert elbow["used"] == pytest.approx(peak / 1.5)
    assert elbow["angle"] == pytest.approx(0.6, abs=0.01)
    assert (wrist["peak"], hand["limit"]) == (pytest.approx(0.0, abs=1e-6), 1.5)
    read = words(page(made))
    assert f"right elbow 80 % {peak:.2f} rad/s ({np.degrees(peak):.0f}°/s) 1.50 rad/s (86°/s)" in read
    assert "Every spared joint stays below its limit; the right elbow comes nearest, at 80 %" in read


def test_a_joint_beyond_its_limit_is_named(made: Dance, page: Callable[..., str]) -> None:
    too_fast = replace(made, mask=spare("right_elbow", speed_limits_rad_s=1.0))
    assert "Beyond its limit: right elbow; the right elbow reaches 120 % of its limit." in words(
        page(too_fast)
    )
    too_far = replace(made, mask=spare("right_elbow", angle_limits_rad=0.5))
    read = words(page(too_far))
    assert "Beyond its limit: right elbow; the right elbow reaches 120 %" in read
    assert "0.50 rad (29°)" in read


def test_what_reaches_out_of_the_stage_is_told(made: Dance, page: Callable[..., str]) -> None:
    places = kinematics.joint_positions(made.motion)[..., [0, 2]] - [0.5, -1.0]  # where the pelvis begins
    reach_m = np.abs(places).max(axis=(0, 1))
    narrow = replace(made, animation=replace(made.animation, stage_m=(0.5, 10.0)))
    assert beyond_stage_m(narrow) == pytest.approx(reach_m[0] - 0.25)
    assert reach_m[0] > 0.5  # arms
    assert "The pelvis keeps within 0.5 × 10 m; hands and feet reach up to" in words(page(narrow))
    free = replace(made, animation=replace(made.animation, stage_m=None))
    assert beyond_stage_m(free) == 0.0
    assert "The pelvis keeps" not in words(page(free))


def test_a_note_stands_at_the_top_as_text(made: Dance, page: Callable[..., str]) -> None:
    assert 'class="banner">Asked' not in page(made)
    noted = replace(made, note=f"Asked for more {HOSTILE}", is_synthetic=False)
    text = page(noted)
    assert HOSTILE not in text
    assert text.index('class="banner">Asked for more') < text.index("<h1>")
    assert 'class="banner">dance 1: Asked for more' in page(made, noted)


def test_segments_have_the_letters_and_colours_of_the_film_strip(
    made: Dance, page: Callable[..., str]
) -> None:
    rows = segments(made)
    letters = [row["letter"] for row in rows]
    assert letters == ["A", "B", "A′"] == list(film.letters(made))
    colours = {"white": "#ffffff"}
    tints = {letter: colours.get(tint, tint) for letter, tint in film._colours(letters).items()}
    assert [row["colour"] for row in rows] == [tints[letter.rstrip("′")] for letter in letters]
    assert [row["jump_mm"] for row in rows] == [None, pytest.approx(31.0), pytest.approx(57.0)]
    read = words(page(made))
    assert "4–8 s B wave 2.50 s no right arm: calm at 1.00 s 31 mm CC0-1.0" in read
    assert "8–12 s A′ kick 2.50 s yes – 57 mm CC0-1.0" in read


def test_the_search_and_its_source_are_told(
    made: Dance, page: Callable[..., str], library: DanceLibrary
) -> None:
    read = words(page(made, library=library, notes=["Arms were put in."]))
    assert "3 chains of 400 steps" in read
    assert "0.2500 to 0.7500, in the median 0.5000; the dance of this page costs 0.2500" in read
    assert "transition 0.5000 0.50 0.2500" in read
    for told in (
        made.sha256,
        made.library_sha256,
        "Seed 7",
        "from the library made-up",
        "Arms were put in.",
        "the pelvis keeps within 3 × 2.5 m",
    ):
        assert told in read


def test_the_player_gets_the_very_positions(made: Dance, page: Callable[..., str]) -> None:
    given = played(page(made))
    assert given["body"]["parents"] == list(NEUTRAL_BODY.parents)
    (dance,) = given["dances"]
    positions = np.frombuffer(base64.b64decode(dance["positions"]), dtype="<f4").reshape(-1, 24, 3)
    np.testing.assert_array_equal(positions, kinematics.joint_positions(made.motion).astype("<f4"))
    assert [NEUTRAL_BODY.joint_names[k] for k in np.flatnonzero(dance["spared"])] == [
        "right_elbow", "right_wrist", "right_hand",
    ]  # fmt: skip
    assert [segment["start_s"] for segment in dance["segments"]] == [0.0, 4.0, 8.0]


def test_nothing_is_fetched_and_every_figure_is_within(whole: str) -> None:
    text = whole
    assert text.count("<figure>") == text.count('src="data:image/svg+xml;base64,') == 5
    outside = re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL)
    assert "http" not in outside
    assert not re.search(r"<link|\bsrc=\"(?!data:)|@import|url\(", outside)


def test_names_of_others_stay_text(made: Dance, library: DanceLibrary, tmp_path: Path) -> None:
    hostile = replace(
        made,
        condition=HOSTILE,
        segments=(
            replace(made.segments[0], take=HOSTILE, licence=HOSTILE, spliced_from=HOSTILE), *made.segments[1:]
        ),
    )  # fmt: skip
    out = write_dance_page(
        {HOSTILE: hostile, "other": made},
        tmp_path / "page.html",
        library=replace(library, name=HOSTILE),
        notes=[HOSTILE],
    )
    text = out.read_text()
    assert HOSTILE not in text
    assert "<img src=x" not in text
    assert len(re.findall("</script>", text)) == 2
    assert played(text)["dances"][0]["segments"][0]["words"].startswith(HOSTILE)


def test_files_beside_the_page_are_linked(made: Dance, tmp_path: Path) -> None:
    write_dances({"a dance": made}, tmp_path)
    text = write_dance_page({"a dance": made}, tmp_path / "page.html").read_text()
    assert re.findall(r'<a href="(\./[^"]*)"', text) == [
        f"./a%20dance{suffix}" for suffix in (".npz", ".bvh", ".glb", ".json")
    ]
    alone = tmp_path / "elsewhere" / "page.html"
    alone.parent.mkdir()
    assert "No files of this dance" in write_dance_page({"a dance": made}, alone).read_text()


def test_several_dances_have_a_table_tabs_and_a_figure_of_all(made: Dance, page: Callable[..., str]) -> None:
    blocks = (
        replace(made.blocks[0], asked=replace(made.asked, duration_s=4.0)),
        replace(made.blocks[0], asked=replace(made.asked, duration_s=8.0)),
    )
    text = page(made, replace(made, blocks=blocks, mask=None))
    read = words(text)
    assert "2 dances" in read
    assert "dance 1: Intense – Easy, transition on" in read
    assert "a dance of 12 s in 2 blocks" in read
    assert "2: 4–12 s 100.0 J 103.0 J 3.0 % above" in read
    assert re.findall(r'href="#dance-(\d)" data-tab="(\d)"', text) == [("1", "0"), ("2", "1")]
    told = [segment["words"].rpartition("; ")[2] for segment in played(text)["dances"][1]["segments"]]
    assert told == ["block 1", "block 2", "block 2"]
    assert text.count('<section class="dance"') == 2
    assert text.count("<figure>") == 11
    addresses = set(re.findall(r'href="#([^"]+)"', text))
    assert addresses <= set(re.findall(r'id="([^"]+)"', text))


def test_the_same_dances_give_the_same_page(made: Dance, whole: str, tmp_path: Path) -> None:
    assert write_dance_page({"dance": made}, tmp_path / "page.html", body_mass_kg=KG).read_text() == whole


def test_an_older_dance_that_tells_less_has_a_page(made: Dance, page: Callable[..., str]) -> None:
    older = replace(made, chain_costs=(), weights={}, trace=(), mask=None)
    assert "Where it comes from" in words(page(older))
    assert facts(older, KG)["search"]["median"] is None


def test_a_page_of_no_dance_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no dance to show"):
        write_dance_page({}, tmp_path / "page.html")


def test_a_page_that_cannot_be_written_is_refused(made: Dance, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_dance_page({"a": made}, tmp_path / "file" / "page.html")
