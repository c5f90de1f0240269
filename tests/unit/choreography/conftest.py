"""Goals that made-up libraries reach, and searches that are over in a moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from studykit.choreography.dance_library import DanceLibrary
from studykit.choreography.goal import Goal
from studykit.choreography.preset import STUDYKIT, Preset
from studykit.choreography.rjmcmc.annealing import Annealing
from studykit.choreography.rjmcmc.repertoire import allowed
from studykit.motion import kinematics, rotation


def short(iterations: int) -> Annealing:
    return Annealing.geometric(iterations=iterations, start=0.3, end=0.001, start_width=6.0)


HAND = 23
"""The right hand."""


@pytest.fixture(scope="session")
def swinging(made_library: Callable[..., DanceLibrary]) -> Callable[..., DanceLibrary]:
    """Make up a library in which the right hand swings to and fro: in some segments little, in others far."""

    def make(segments: int, *, seed: int = 0) -> DanceLibrary:
        library = made_library(segments, seed=seed)
        rng = np.random.default_rng(seed)
        times = np.arange(120) / 30.0
        swings = rng.uniform(0.02, 0.5, size=(segments, 1)) * np.sin(
            rng.uniform(4.0, 7.0, size=(segments, 1)) * times + rng.uniform(0.0, 6.0, size=(segments, 1))
        )
        turns = np.zeros((segments, 120, 3))
        turns[..., 0] = swings
        rotations = np.array(library.rotations)
        rotations[:, :, HAND] = rotation.exp(turns)
        return replace(
            library,
            rotations=rotations,
            peak_speeds=kinematics.angular_speeds(np.moveaxis(rotations, 1, 0), 30.0).max(axis=0),
            peak_angles=kinematics.rest_angles(rotations).max(axis=1),
        )

    return make


@pytest.fixture(scope="session")
def quick() -> Preset:
    """Give studykit's preset with two short chains."""
    return replace(STUDYKIT, annealing=short(4000), preview=short(2000), chains=2)


@pytest.fixture(scope="session")
def within_reach(quick: Preset) -> Callable[..., Goal]:
    """Give a goal the energies of middling segments of a library, and a quick search."""

    def make(goal: Goal, library: DanceLibrary, *, factor: float = 1.0) -> Goal:
        rows = allowed(library, goal.mask)
        linear = factor * library.linear_energies[rows].sum(axis=1).mean()
        rotational = factor * library.rotational_energies[rows].sum(axis=1).mean()
        blocks = (
            replace(
                block,
                linear_energy=float(linear * block.segments),
                rotational_energy=float(rotational * block.segments),
            )
            for block in goal.blocks
        )
        return replace(goal, blocks=tuple(blocks), preset=quick)

    return make
