"""Many chains from different beginnings, on all cores."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from threading import Event

from studykit.choreography.goal import CLOSE, Goal
from studykit.choreography.rjmcmc.chain import Found, Search
from studykit.choreography.rjmcmc.repertoire import Repertoire
from studykit.core.errors import InputError
from studykit.core.progress import Progress, silent
from studykit.core.seeding import stream

PATIENCE = 4
"""How many times the preset's chains are tried while none has hit all goals."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Outcome:
    """All that the chains found, in their order.

    Parameters
    ----------
    found : tuple of Found
        One a chain.
    is_interrupted : bool
        Whether the search was stopped before its end.
    """

    found: tuple[Found, ...]
    is_interrupted: bool

    def ranked(self, goal: Goal) -> list[Found]:
        """Put dances in order: the allowed first, of these what misses least, is closest, cheapest."""

        def rank(one: Found) -> tuple[bool, int, int, float]:
            missed = goal.misses(one.measures)
            close = goal.misses(one.measures, share=CLOSE)
            return not one.is_allowed, len(missed), len(close), one.cost

        return sorted(self.found, key=rank)


def search(  # noqa: PLR0913
    goal: Goal,
    known: Repertoire,
    *,
    seed: int,
    is_preview: bool = False,
    workers: int | None = None,
    stop: Event | None = None,
    progress: Progress = silent,
) -> Outcome:
    """Run chains until one hits all goals; whole batches, so that the number of cores changes nothing.

    The plain implementation, which terms that do not add up need, runs the shorter chains of a first look.

    Parameters
    ----------
    goal : Goal
        What is wanted.
    known : Repertoire
        What is danced.
    seed : int
        Every chain has a random stream of its own from it.
    is_preview : bool
        Whether a first look suffices.
    workers : int or None
        Chains that run side by side; as many as there are cores if not given.
    stop : Event, optional
        Ends a plain search from another thread.
    progress : Progress
        Told of each chain.
    """
    if workers is not None and workers < 1:
        raise InputError(f"{workers} workers", where="workers", remedy="give 1 or more, or none")
    preset = goal.preset
    run = Search.sized(goal, known, preset.annealing)
    is_short = is_preview or not run.is_compiled
    if is_short:
        run = Search.sized(goal, known, preset.preview)
    if stop is not None:
        run = replace(run, stop=stop)
    chains = preset.preview_chains if is_short else preset.chains
    found: list[Found] = []
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for batch in range(PATIENCE if preset.is_reached and not is_short else 1):
            numbers = range(batch * chains, (batch + 1) * chains)
            futures: list[Future[Found]] = []
            try:
                futures.extend(
                    pool.submit(run.run, stream(seed, "dance", goal.condition, chain)) for chain in numbers
                )
                found += [one.result() for one in progress(futures, label="Searching", total=chains)]
            except KeyboardInterrupt:
                run.stop.set()
                found += _finished(futures)
                if not found:
                    raise
                return Outcome(found=tuple(found), is_interrupted=True)
            if any(one.is_allowed and not goal.misses(one.measures) for one in found):
                break
    return Outcome(found=tuple(found), is_interrupted=False)


def _finished(futures: list[Future[Found]]) -> Iterator[Found]:
    """Call off what has not begun and wait for the rest: chains are short, or told to stop."""
    for future in futures:
        future.cancel()
    for future in futures:
        with suppress(CancelledError):
            yield future.result()
