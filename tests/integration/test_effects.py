"""The study is not circular: what is planted is found, and where nothing is planted nothing is found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from scipy.stats import binom

import studykit as sk
from studykit.analysis.results import Results
from studykit.choreography.dance import Dance
from studykit.io.datasets.read import find_recipe
from studykit.io.protocol_file import default_protocol
from studykit.library.build import build
from studykit.participant.effects import NONE, PAPER, Effects
from studykit.protocol import StudyProtocol

NULL_STUDIES = 10


def shortened(participants: int) -> StudyProtocol:
    """The study with short phases; the heart still comes down between dances."""
    protocol = sk.read_protocol(default_protocol()).with_participants(participants)
    phases = protocol.session.model_copy(
        update={"calibrate_s": 1.0, "baseline_s": 20.0, "train_s": 1.0, "rest_s": 150.0}
    )
    return protocol.model_copy(update={"session": phases})


@pytest.fixture(scope="module", params=["synthetic", "cmu"])
def dances(
    request: pytest.FixtureRequest,
    tmp_path_factory: pytest.TempPathFactory,
    shared_data: Callable[[str], Path],
) -> Mapping[str, Dance]:
    """Dances of both kinds: real ones turn and travel more."""
    folder = tmp_path_factory.mktemp("libraries") / request.param
    if request.param == "synthetic":
        library = sk.library.make_sample(folder)
    else:
        takes = shared_data("motion/cmu-bvh-acrnn")
        library = build({takes: find_recipe(takes)}, folder)
    return sk.choreograph(shortened(8), library, seed=3)


def answered(
    folder: Path, dances: Mapping[str, Dance], *, people: int, effects: Effects, seed: int
) -> Results:
    protocol = shortened(people)
    study = sk.open_study(folder, protocol=protocol)
    sk.library.write_dances(dances, study.folder.dances)
    study.simulate(dances, effects=effects, seed=seed, workers=2)
    return sk.analysis.run(protocol.analysis, sk.reports.trials(study))


def p_values(results: Results) -> list[float]:
    return [test.friedman.p for test in results.tests if test.friedman is not None]


@pytest.mark.slow
def test_planted_effects_are_found(tmp_path: Path, dances: Mapping[str, Dance]) -> None:
    results = answered(tmp_path / "study", dances, people=20, effects=PAPER, seed=5)
    assert len(p_values(results)) == 3
    assert max(p_values(results)) < 0.001


@pytest.mark.slow
def test_where_nothing_is_planted_chance_alone_speaks(tmp_path: Path, dances: Mapping[str, Dance]) -> None:
    found: dict[str, int] = {}
    for seed in range(NULL_STUDIES):
        results = answered(tmp_path / f"{seed}", dances, people=20, effects=NONE, seed=seed)
        for test in results.tests:
            found[test.plan.name] = found.get(test.plan.name, 0) + (
                test.friedman is not None and test.friedman.p < 0.05
            )
            pairs = any(pair.p_corrected < 0.05 for pair in test.pairs)
            found[f"{test.plan.name}, any pair"] = found.get(f"{test.plan.name}, any pair", 0) + pairs
    tests = {name: count for name, count in found.items() if "pair" not in name}
    print(f"significant at 0.05 in {NULL_STUDIES} studies without effects: {found}")
    # No more than chance gives in 99 of 100 such rows of studies.
    assert sum(tests.values()) <= binom.ppf(0.99, len(tests) * NULL_STUDIES, 0.05)
    for count in found.values():
        assert count <= binom.ppf(0.999, NULL_STUDIES, 0.05)
