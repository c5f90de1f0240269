"""The search in compiled form: the same as `rjmcmc.reference`, every change in constant time."""

from __future__ import annotations

import sys
from pathlib import Path

COMPILING = "Compiling the search once, about 15 s (half a minute on a slow computer) ..."


def is_compiled() -> bool:
    """Tell whether the search can begin at once, because this process or an earlier one has compiled it."""
    running = sys.modules.get(f"{__name__}.running")
    if running is not None and running.run.signatures:
        return True
    # Where the compiler keeps what it made, unless told otherwise; what is older than its source is void.
    source = Path(__file__).with_name("running.py")
    kept = source.with_name("__pycache__").glob("running.run-*.nbi")
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in kept)
