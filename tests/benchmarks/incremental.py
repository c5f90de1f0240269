"""The search as one would write it in NumPy: sums carried along, one array operation a change.

A peer for the compiled search: the same moves for a dance of one block, the same costs, reduced distances.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from studykit.choreography.rjmcmc.kernel.arrays import SUMS, VARIETY, Tables, Targets


def run(  # noqa: PLR0915 - one loop, as one would write it
    tables: Tables, targets: Targets, temperatures: np.ndarray, iterations: int, rng: np.random.Generator
) -> tuple[float, int]:
    """Search for so many iterations and give the lowest cost and the number of changes accepted."""
    coordinates = tables.coordinates.astype(np.float64)
    first = tables.first_poses.astype(np.float64)
    last = tables.last_poses.astype(np.float64)
    size = tables.values.shape[1]
    low, high = int(targets.lowest[0]), int(targets.highest[0])
    novelty = float(targets.novelties[0])

    def distances(segment: int, others: list[int]) -> float:
        gap = coordinates[others] - coordinates[segment]
        squares = (gap * gap).sum(axis=1) + tables.residuals[others] + tables.residuals[segment]
        return float(np.where(np.array(others) == segment, 0.0, np.sqrt(squares)).sum())

    def jump(before: int, after: int) -> float:
        return float(np.sqrt(((first[after] - last[before]) ** 2).sum(axis=0)).mean())

    def cost(count: int, sums: np.ndarray, pairs: float, jumps: list[float]) -> float:
        deviations = [4.0 * count - targets.blocks[0, 0]]
        deviations.append(2.0 * pairs / (count * (count - 1)) - targets.blocks[VARIETY, 0])
        deviations += list(np.log(sums / targets.blocks[SUMS:, 0]))
        scaled = np.array(deviations) / targets.tolerances[:, 0]
        joins = -np.expm1(-0.5 * (np.array(jumps) / targets.transition_tolerance_m) ** 2)
        return float(targets.weights @ -np.expm1(-0.5 * scaled**2) + targets.transition_weight * joins.mean())

    dance = [int(s) for s in rng.choice(size, 8, replace=False)]
    sums = tables.values[:, dance].sum(axis=1)
    pairs = sum(distances(segment, dance) for segment in dance) / 2.0
    jumps = [jump(a, b) for a, b in pairwise(dance)]
    now = best = cost(len(dance), sums, pairs, jumps)
    accepted = 0
    for iteration in range(iterations):
        temperature = temperatures[iteration * len(temperatures) // iterations]
        kind, draws = rng.random(), rng.random(2)
        count = len(dance)
        changed = list(dance)
        if kind < 0.4:
            if count >= high:
                continue
            place, odds, gone = int(rng.integers(count + 1)), math.log(0.5), []
        else:
            place = int(rng.integers(count))
            gone = [changed.pop(place)]
            odds = math.log(2.0) if kind < 0.6 else 0.0
            if kind < 0.6 and count <= low:
                continue
        new = []
        if not 0.4 <= kind < 0.6:
            copies = novelty > 0.0 and draws[0] * (1.0 + len(changed) / novelty) >= 1.0
            pool = changed if copies else range(size)
            new = [pool[int(draws[1] * len(pool))]]
        sum_of = sums + tables.values[:, new].sum(axis=1) - tables.values[:, gone].sum(axis=1)
        pair_of = pairs + sum(distances(s, changed) for s in new) - sum(distances(s, changed) for s in gone)
        around = [*changed[max(place - 1, 0) : place], *new, *changed[place : place + 1]]
        made = [jump(a, b) for a, b in pairwise(around)]
        after = place + 1 if gone else place
        jump_of = [*jumps[: max(place - 1, 0)], *made, *jumps[after:]]
        changed[place:place] = new
        proposed = cost(len(changed), sum_of, pair_of, jump_of)
        if math.log(1.0 - rng.random()) <= odds - (proposed - now) / temperature:
            dance, sums, pairs, jumps, now = changed, sum_of, pair_of, jump_of, proposed
            best, accepted = min(best, now), accepted + 1
    return best, accepted
