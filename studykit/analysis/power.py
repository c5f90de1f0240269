"""How many people a study needs, found by making it up many times and analysing it as declared."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from studykit.analysis import multiplicity
from studykit.analysis.friedman import centred_ranks, chi_squared_of_ranks, friedman
from studykit.analysis.outcome_model import OutcomeModel
from studykit.analysis.wilcoxon import Zeros, wilcoxon
from studykit.core.arrays import Floats, Integers
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.protocol.analysis_plan import TestPlan
from studykit.protocol.latin_square import assignment
from studykit.protocol.study_protocol import StudyProtocol

if TYPE_CHECKING:
    import pandas as pd

ANY_CONDITION = "conditions differ"
ANY_PAIR = "any pair"

_CORRECTIONS: dict[str, Callable[[Sequence[float]], Floats]] = {
    "holm": multiplicity.holm,
    "bonferroni": multiplicity.bonferroni,
    "none": np.asarray,
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Chance:
    """How often one declared question was answered with "significant".

    Parameters
    ----------
    test : str
        Name of the declared test.
    question : str
        `ANY_CONDITION` (the test itself), `ANY_PAIR` of its pairs, or a pair such as "a - b".
    participants : int
        People in each study.
    power : float
        Share of studies, 0 to 1.
    low, high : float
        Where the share of all possible studies lies with 95 % confidence (Clopper and Pearson).
    """

    test: str
    question: str
    participants: int
    power: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Power:
    """The power of a study's declared tests by number of people.

    Parameters
    ----------
    outcome : str
        What is measured.
    studies : int
        Studies made up for each number of people.
    alpha : float
        Corrected p below this count as significant.
    chances : tuple of Chance
        By test, question and number of people.
    """

    outcome: str
    studies: int
    alpha: float
    chances: tuple[Chance, ...]

    def table(self) -> pd.DataFrame:
        """Give one row a test, question and number of people."""
        import pandas as pd

        return pd.DataFrame([asdict(chance) for chance in self.chances])

    def people_needed(
        self, wanted: float = 0.8, *, test: str | None = None, question: str = ANY_CONDITION
    ) -> int | None:
        """Give the smallest number of people whose power is surely at least as wanted, or None.

        Parameters
        ----------
        wanted : float
            The power, 0 to 1; the lower end of its interval must reach it.
        test : str, optional
            Name of the test; the first declared one if not given.
        question : str
            As in `Chance`.
        """
        name = self.chances[0].test if test is None else test
        enough = [
            chance.participants
            for chance in self.chances
            if (chance.test, chance.question) == (name, question) and chance.low >= wanted
        ]
        return min(enough, default=None)


def power(
    protocol: StudyProtocol,
    model: OutcomeModel,
    *,
    participants: Sequence[int] = (8, 12, 16, 20, 24),
    studies: int = 2000,
    rng: np.random.Generator,
    progress: Progress = silent,
) -> Power:
    """Find how often the declared tests of an outcome would find what a model says is there.

    Each study is made up whole: the orders that the protocol would give so many people, the model's values in
    them, lost trials, the people left who have all conditions; then the declared tests, post hoc pairs and
    corrections at the declared level. These are the p of `analysis.run`.

    Parameters
    ----------
    protocol : StudyProtocol
        Gives the order, the tests and alpha.
    model : OutcomeModel
        What is taken to be true.
    participants : sequence of int
        Numbers of people to try.
    studies : int
        How many studies are made up for each.
    rng : numpy.random.Generator
        All chance.
    progress : Progress
        Told of each number of people.

    Raises
    ------
    InputError
        If no declared test compares the model's outcome.
    """
    declared = protocol.analysis.tests
    plans = [plan for plan in declared if plan.outcome == model.outcome]
    if not plans:
        raise InputError(
            f"no declared test compares {model.outcome}",
            where="analysis.tests",
            remedy=f"use one of: {', '.join(dict.fromkeys(plan.outcome for plan in declared))}",
        )
    found: list[Chance] = []
    alpha = protocol.analysis.alpha
    for count in progress(participants, label="Making up studies", total=len(participants)):
        values = model.draw(orders(protocol, count), protocol.order.labels, studies=studies, rng=rng)
        for plan in plans:
            columns = [protocol.order.labels.index(name) for name in plan.conditions]
            p = decisions(plan, values[:, :, columns], rng=rng)
            names = [ANY_CONDITION, *(f"{a} - {b}" for a, b in plan.pairs_list()), ANY_PAIR]
            hits = np.column_stack([p < alpha, (p[:, 1:] < alpha).any(axis=1)]).sum(axis=0)
            found += [
                _chance(plan.name, name, count, int(hit), studies)
                for name, hit in zip(names, hits, strict=True)
            ]
    order = {name: place for place, name in enumerate(dict.fromkeys((c.test, c.question) for c in found))}
    found.sort(key=lambda chance: (order[chance.test, chance.question], chance.participants))
    return Power(outcome=model.outcome, studies=studies, alpha=alpha, chances=tuple(found))


def orders(protocol: StudyProtocol, participants: int) -> Integers:
    """Give what so many people would dance, shape (person, period), as places in the protocol's labels."""
    labels = protocol.order.labels
    given = assignment(protocol.with_participants(participants))
    return np.array([[labels.index(name) for name in sequence.conditions] for sequence in given])


def decisions(plan: TestPlan, values: Floats, *, rng: np.random.Generator) -> Floats:
    """Give the p of a declared test and the corrected p of its pairs, in many studies at once.

    Parameters
    ----------
    plan : TestPlan
        What is declared.
    values : ndarray, shape (study, person, condition)
        In the plan's conditions; NaN where a trial was lost.
    rng : numpy.random.Generator
        For a permutation p that cannot be counted out.

    Returns
    -------
    ndarray, shape (study, 1 + pair)
        1 where a test cannot be made, as nobody would claim anything then.
    """
    pairs = [(plan.conditions.index(a), plan.conditions.index(b)) for a, b in plan.pairs_list()]
    p = np.ones((len(values), 1 + len(pairs)))
    for study, table in enumerate(_complete(values)):
        if len(table) < 2 or np.all(table == table[:, :1]):
            continue
        p[study, 0] = _of_test(plan, table, rng)
        if plan.correction == "closed":
            p[study, 1:] = multiplicity.closed_friedman(table, pairs)
        else:
            raw = [_of_pair(table[:, a] - table[:, b], plan.zeros or "drop") for a, b in pairs]
            p[study, 1:] = _CORRECTIONS[plan.correction](raw)
    return p


def _complete(values: Floats) -> Iterator[Floats]:
    """Give each study's people who have all conditions, shape (person, condition)."""
    whole = np.asarray(np.isfinite(values).all(axis=2))
    for table, kept in zip(values, whole, strict=True):
        yield table[kept]


def _of_test(plan: TestPlan, table: Floats, rng: np.random.Generator) -> float:
    if plan.p_from in (None, "chi_squared"):
        return chi_squared_of_ranks(centred_ranks(table))[1]
    found = friedman(table, rng=rng)
    if plan.p_from == "permutation":
        return found.permutation_p
    return 0.0 if found.f_p is None else found.f_p


def _of_pair(differences: Floats, zeros: Zeros) -> float:
    """Give the exact signed-rank p; without ties it hangs on the number of people and the sum alone."""
    sizes = np.abs(differences)
    order = np.argsort(sizes)
    ranked = sizes[order]
    if ranked[0] == 0.0 or np.any(ranked[1:] == ranked[:-1]):
        return wilcoxon(differences, np.zeros_like(differences), zeros=zeros).p
    ranks = np.arange(1, len(ranked) + 1)
    return _p_by_sum(len(ranked))[int(ranks[differences[order] > 0.0].sum())]


@lru_cache(maxsize=64)
def _p_by_sum(people: int) -> tuple[float, ...]:
    """Give the p of every sum of positive ranks, from 0 upwards."""
    found = []
    for total in range(people * (people + 1) // 2 + 1):
        left, signs = total, np.ones(people)
        for rank in range(people, 0, -1):  # the largest ranks first: every sum can be made so
            if rank <= left:
                left -= rank
            else:
                signs[rank - 1] = -1.0
        found.append(wilcoxon(signs * np.arange(1, people + 1), np.zeros(people)).p)
    return tuple(found)


def _chance(test: str, question: str, participants: int, hits: int, studies: int) -> Chance:
    from scipy.stats import binomtest

    interval = binomtest(hits, studies).proportion_ci(method="exact")
    return Chance(
        test=test,
        question=question,
        participants=participants,
        power=hits / studies,
        low=float(interval.low),
        high=float(interval.high),
    )
