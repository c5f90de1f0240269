"""The segments that a dance may have, and all that its costs need of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations, pairwise, product

import numpy as np
import pytest

from studykit.choreography.preset import PAPER, STUDYKIT
from studykit.choreography.rjmcmc.repertoire import Repertoire, allowed, repertoire
from studykit.core.errors import InputError
from studykit.motion import kinematics
from studykit.motion.blending import joined
from studykit.motion.joint_mask import JointMask, spare

HAND = 23
BLOCKS = ((3, 1, 1), (0,), (2, 3, 0, 1))


@dataclass
class Jumps:
    """A term of one's own; it can be changed, and so it cannot be hashed."""

    name: str = "jumps"
    weight: float = 1.0
    target: float = 0.5
    tolerance: float = 0.1
    each: object = None

    def values(self, library):
        return np.linspace(0.0, 1.0, len(library)) if self.each is None else self.each


@pytest.fixture(scope="module")
def library(swinging):
    return swinging(24)


@pytest.fixture(scope="module")
def mask(library):
    """Spare the right hand: it stays below what it does in the middle segment."""
    limit = float(np.median(library.peak_speeds[:, HAND]))
    return spare("right_hand", weights=0.25, speed_limits_rad_s=limit)


def test_segments_in_which_a_protected_joint_exceeds_a_limit_are_left_out(library, mask) -> None:
    rows = allowed(library, mask)
    assert rows.tolist() == [
        row for row in range(24) if library.peak_speeds[row, HAND] <= mask.speed_limits_rad_s[HAND]
    ]
    assert 0 < len(rows) < 24
    bent = float(np.sort(library.peak_angles[:, 4])[5])
    both = replace(mask, angle_limits_rad=np.where(np.arange(24) == 4, bent, np.inf))
    assert allowed(library, both).tolist() == [row for row in rows if library.peak_angles[row, 4] <= bent]
    assert allowed(library, None).tolist() == list(range(24))


@pytest.mark.parametrize("field", ["speed_limits_rad_s", "angle_limits_rad"])
def test_a_mask_that_leaves_no_segment_says_how_far_off_it_is(library, field) -> None:
    peaks = library.peak_speeds if field == "speed_limits_rad_s" else library.peak_angles
    limit = 0.5 * float(peaks[:, HAND].min())
    sentence = (
        r"^made-up: right_hand exceed their limits in every segment, at best 2\.00-fold; "
        r"allow more, or splice still limbs in\.$"
    )
    with pytest.raises(InputError, match=sentence):
        Repertoire(library, STUDYKIT, mask=spare("right_hand", **{field: limit}))


def test_measures_are_those_of_the_segments_themselves(library, mask) -> None:
    known = Repertoire(library, STUDYKIT, mask=mask)
    rows = known.library_rows(BLOCKS)
    assert rows == tuple(tuple(int(known.rows[segment]) for segment in block) for block in BLOCKS)
    found = known.measures(BLOCKS, is_exact=True)
    vectors = library.standardised(np.arange(24)).astype(float)
    for number, block in enumerate(rows):
        index = list(block)
        assert found.blocks["duration"][number] == 4.0 * len(block)
        assert found.blocks["linear"][number] == pytest.approx(library.linear_energies[index].sum())
        assert found.blocks["rotational"][number] == pytest.approx(library.rotational_energies[index].sum())
        spared = 0.75 * library.rotational_energies[index, HAND].sum()  # (1 - a) E
        assert found.blocks["mask"][number] == pytest.approx(spared)
        apart = [np.linalg.norm(vectors[a] - vectors[b]) for a, b in combinations(block, 2)]
        assert found.blocks["variety"][number] == pytest.approx(np.mean(apart) if apart else 0.0)
    whole = [segment for block in rows for segment in block]
    assert found.displacements_m == pytest.approx([library.displacement(*join) for join in pairwise(whole)])
    guided = known.measures(BLOCKS)
    assert guided.blocks["variety"] == pytest.approx(found.blocks["variety"], rel=1e-4)


def test_energies_as_printed_leave_spared_joints_out(library, mask) -> None:
    whole, printed = (Repertoire(library, preset, mask=mask) for preset in (STUDYKIT, PAPER))
    # Eq. 8 knows no mask.
    for name, share in (("linear", 0.0), ("rotational", 0.75)):
        by_joint = getattr(library, f"{name}_energies")[whole.rows]
        assert whole.values[name] == pytest.approx(by_joint.sum(axis=1))
        assert printed.values[name] == pytest.approx(by_joint.sum(axis=1) - share * by_joint[:, HAND])


def test_successors_are_the_nearest_of_those_that_may_be_danced(library, mask) -> None:
    known = Repertoire(library, STUDYKIT, mask=mask)
    for segment in range(known.size):
        jumps = [known.displacement(segment, other) for other in range(known.size)]
        jumps[segment] = math.inf
        found = known.successors(segment)
        assert segment not in found
        assert [jumps[other] for other in found] == pytest.approx(sorted(jumps)[: len(found)], rel=1e-5)


def test_joins_are_held_when_the_blend_stays_below_the_limit(library, mask) -> None:
    known = Repertoire(library, STUDYKIT, mask=mask)
    limit = mask.speed_limits_rad_s[HAND]
    verdicts = []
    for before, after in product(range(0, known.size, 2), range(1, known.size, 2)):
        pair = [library.motion(int(known.rows[segment])) for segment in (before, after)]
        peak = kinematics.angular_speeds(joined(pair).rotations, 30.0)[:, HAND].max()
        verdicts.append((known.is_held(before, after), bool(peak <= limit)))
    assert all(said == seen for said, seen in verdicts)
    assert {said for said, _ in verdicts} == {True, False}
    free = Repertoire(library, STUDYKIT)
    assert all(free.is_held(a, b) for a, b in product(range(24), repeat=2))


def test_pieces_of_one_take_are_the_same_movement_only_where_they_overlap(library) -> None:
    starts_s = [0.0, 3.9, 3.99, 8.0] * 6
    table = library.segments.assign(take=np.repeat(range(6), 4), start_s=starts_s)
    known = Repertoire(replace(library, segments=table), STUDYKIT)
    assert [known.same_movement(0, other) for other in (0, 1, 2, 3, 4)] == [True, True, False, False, False]
    assert known.same_movement(1, 2)


def test_terms_of_one_s_own_are_measured_on_what_may_be_danced(library, mask) -> None:
    known = Repertoire(library, STUDYKIT, mask=mask, terms=(Jumps(),))
    assert known.values["jumps"] == pytest.approx(np.linspace(0.0, 1.0, 24)[known.rows])
    (first, _, _) = known.measures(BLOCKS).blocks["jumps"]
    assert first == pytest.approx(sum(known.rows[segment] / 23.0 for segment in BLOCKS[0]))


@pytest.mark.parametrize(
    ("terms", "sentence"),
    [
        (
            [Jumps(each=np.zeros(23))],
            r"^the term jumps: its values have the shape \(23,\) .*; give one number",
        ),
        ([Jumps(each=np.zeros((24, 2)))], r"^the term jumps: its values have the shape \(24, 2\)"),
        (
            [Jumps(each=np.full(24, np.nan))],
            r"^the term jumps: .* are not all numbers; .* each of the 24 seg",
        ),
        ([Jumps(each=[math.inf] * 24)], r"^the term jumps: .* are not all numbers"),
        ([Jumps(tolerance=0.0)], r"^the term jumps: a target of 0.5 and a tolerance of 0; give numbers"),
        ([Jumps(target=math.nan)], r"^the term jumps: a target of nan and"),
        ([Jumps(), Jumps()], r'^terms: there is a term "jumps" already; give it another name\.$'),
        ([Jumps(name="linear")], r'^terms: there is a term "linear" already'),
        ([PAPER], r"^the term paper: it has neither a cost, nor a target"),
    ],
)
def test_a_term_that_cannot_be_meant_is_refused(library, terms, sentence) -> None:
    with pytest.raises(InputError, match=sentence):
        Repertoire(library, STUDYKIT, terms=terms)


def test_a_repertoire_is_kept_unless_its_terms_may_change(library, mask) -> None:
    assert repertoire(library, STUDYKIT, mask, ()) is repertoire(library, STUDYKIT, mask, ())
    term = Jumps()
    before = repertoire(library, STUDYKIT, None, (term,))
    term.each = np.ones(24)
    assert repertoire(library, STUDYKIT, None, (term,)).values["jumps"] == pytest.approx(np.ones(24))
    assert before.values["jumps"] == pytest.approx(np.linspace(0.0, 1.0, 24))


def test_a_mask_of_limits_alone_wants_nothing_of_the_cost(library) -> None:
    limits = JointMask(speed_limits_rad_s=np.where(np.arange(24) == HAND, 1e3, np.inf))
    known = Repertoire(library, STUDYKIT, mask=limits)
    assert known.size == 24
    assert known.measures(((0, 1, 2),)).blocks["mask"] == (0.0,)
    assert known.protected.tolist() == [HAND]


def test_the_compiler_sees_one_type_whether_arrays_lie_on_disk_or_not_and_whatever_is_spared(
    library, mask
) -> None:
    import numba

    on_disk = library.successors.view()
    on_disk.flags.writeable = False
    mapped = replace(library, successors=on_disk, sha256="3" * 64)
    kinds = {
        numba.typeof(repertoire(one, STUDYKIT, spared, ()).tables)
        for one in (library, mapped)
        for spared in (None, mask)
    }
    assert len(kinds) == 1
