"""From samples to numbers: heart rate, movement, enjoyment and the tests that the protocol declares."""

from studykit.analysis.planned import run
from studykit.analysis.results import Results

__all__ = ["Results", "run"]
