"""What must be true of an importer whatever it is given, and a record of where it was not."""

from __future__ import annotations

import contextlib
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from studykit.core.errors import InputError

MOST_CPU_S = 1.0
MOST_BYTES = 2**29
_GIVEN_UP_CPU_S = 10.0
_SLACK_BYTES = 2**25
_GUARD_BYTES = 2**31
"""Room beyond what the process has; without it a bomb would fell the whole machine."""


class GivenUpError(BaseException):
    """Reading takes so long that it is broken off."""


@dataclass(kw_only=True)
class Input:
    """Files by their path within a folder, and how they are read."""

    files: dict[str, bytes]
    read: Callable[[Path], list[object]]
    about: str = ""


@dataclass(kw_only=True)
class Record:
    """What came of many inputs."""

    name: str
    seed: int
    inputs: int = 0
    accepted: int = 0
    refused: int = 0
    slowest_s: float = 0.0
    findings: dict[str, str] = field(default_factory=dict)
    """What was wrong, the first of each kind, and where its input is kept."""

    def row(self) -> str:
        """Give the line of the table."""
        return f"{self.name:18}{self.inputs:9}{self.accepted:10}{self.refused:9}{1000 * self.slowest_s:12.0f}"


class Oracle:
    """Lets an importer read one input after the other and notes each broken promise.

    Parameters
    ----------
    folder : Path
        Empty; the inputs are laid out below it, and it is the current folder meanwhile.
    record : Record
        What is filled in.
    kept : Path
        Where inputs that broke a promise are kept.
    most_cpu_s, most_bytes : float
        Allowed for one input.
    """

    def __init__(
        self,
        folder: Path,
        record: Record,
        kept: Path,
        *,
        most_cpu_s: float = MOST_CPU_S,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        self.folder, self.record, self.kept = folder, record, kept
        self.most_cpu_s, self.most_bytes = most_cpu_s, most_bytes
        self.modules = set(sys.modules)
        self.there: dict[str, bytes] = {}
        self.peak = 0

    def learn(self, one: Input) -> list[object]:
        """Read a good input; what it imports may be imported by others."""
        self._lay_out(one)
        found = one.read(self.folder)
        self.modules = set(sys.modules)
        return found

    def judge(self, one: Input) -> None:
        """Read one input and note what was wrong."""
        self._lay_out(one)
        if _peak_bytes() > self.peak + _SLACK_BYTES:  # making the inputs takes memory, too
            with contextlib.suppress(OSError):
                Path("/proc/self/clear_refs").write_text("5")  # Linux: forget how large the process ever was
            self.peak = _peak_bytes()
        start = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, max(_GIVEN_UP_CPU_S, 4 * self.most_cpu_s))
        try:
            problem = self._outcome(one)
        except GivenUpError as error:
            problem = f"was given up after {_GIVEN_UP_CPU_S} s{_place(error)}"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
        took = time.process_time() - start
        self.record.inputs += 1
        self.record.slowest_s = max(self.record.slowest_s, took)
        problem = problem or self._traces(took)
        if problem:
            self._keep(problem, one)

    def _outcome(self, one: Input) -> str:
        try:
            found = one.read(self.folder)
        except InputError as error:
            self.record.refused += 1
            return self._bad_message(error)
        except Exception as error:  # noqa: BLE001 - this is what is looked for
            return f"lets {type(error).__name__} through{_place(error)} ({str(error)[:80]!r})"
        self.record.accepted += 1
        return "" if found and all(_is_finite(take) for take in found) else "gives a take that is not finite"

    def _bad_message(self, error: InputError) -> str:
        text = str(error)
        cause: BaseException | None = error
        while cause is not None:
            if isinstance(cause, MemoryError):
                return f"fills the memory{_place(cause)}"
            cause = cause.__cause__ or cause.__context__
        if str(self.folder) not in text:
            return f"names no path{_place(error)} ({text[:80]!r})"
        if not error.remedy or not text.endswith(f"; {error.remedy}.") or len(text.splitlines()) != 1:
            return f"is not one sentence with a remedy{_place(error)} ({text[:200]!r})"
        return ""

    def _traces(self, took: float) -> str:
        """Say what an input left behind or used up."""
        if took > self.most_cpu_s:
            return f"takes {took:.1f} s"
        new = {name for name in sys.modules.keys() - self.modules if not name.startswith("encodings.")}
        if new:  # a text in another encoding may well need the reader of that
            self.modules |= new
            return f"imports {sorted(new)[0]}"
        there = {
            path.relative_to(self.folder).as_posix() for path in self.folder.rglob("*") if path.is_file()
        }
        if there != set(self.there):
            for name in there - set(self.there):
                (self.folder / name).unlink()
            self.there = {name: data for name, data in self.there.items() if name in there}
            return "changes the files beside it"
        if (peak := _peak_bytes()) - self.peak > self.most_bytes:
            grown, self.peak = peak - self.peak, peak
            return f"takes {grown / 2**20:.0f} MiB"
        return ""

    def _lay_out(self, one: Input) -> None:
        for name in self.there.keys() - one.files.keys():
            (self.folder / name).unlink()
        for name, data in one.files.items():
            if self.there.get(name) != data:
                path = self.folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
        self.there = dict(one.files)

    def _keep(self, problem: str, one: Input) -> None:
        kind = problem.partition(" (")[0].rstrip("0123456789. sMiB")
        if kind in self.record.findings:
            return
        place = self.kept / f"{self.record.name}-{len(self.record.findings)}"
        for name, data in one.files.items():
            path = place / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        seed = f"seed {self.record.seed}, input {self.record.inputs - 1}"
        self.record.findings[kind] = f"{self.record.name}: {problem}; {seed}; {one.about}; kept in {place}"


@contextlib.contextmanager
def guarded() -> Iterator[None]:
    """Bound time and memory of this process for a while."""

    def give_up(*_: object) -> None:
        raise GivenUpError

    old, limits = signal.signal(signal.SIGPROF, give_up), resource.getrlimit(resource.RLIMIT_AS)
    with contextlib.suppress(OSError):  # only Linux says how much address space is used
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + _GUARD_BYTES, limits[1]))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, old)
        resource.setrlimit(resource.RLIMIT_AS, limits)


def _peak_bytes() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "studykit/" in frame.filename] or frames[-1:]
    return f" at {Path(ours[-1].filename).name}:{ours[-1].lineno}" if ours else ""


def _is_finite(found: object) -> bool:
    motion = getattr(found, "motion", None)
    if motion is None:
        return True
    arrays = (motion.rotations, motion.root_positions)
    return all(bool(np.all(np.isfinite(array))) for array in arrays)
