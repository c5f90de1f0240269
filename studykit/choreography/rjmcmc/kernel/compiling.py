"""How the search is compiled.

Kernels allocate nothing, so they need no reference counting, which would take most of the time: grouped
arrays are counted at every use otherwise. What is tried at every iteration is inlined into one loop; where
sums may be taken in any order they are taken several numbers at a time. Only what is called from outside gets
a door to Python and a place in the cache on disk; since that knows its own file only, clear it (`make clean`)
after changing another of these modules.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
_INSIDE = {**_OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def compiled(function: _Function) -> _Function:
    """Compile a function that is called from Python."""
    made: _Function = njit(**_OPTIONS, cache=True)(function)
    return made


def inside(function: _Function) -> _Function:
    """Compile a function that other compiled ones call now and then."""
    made: _Function = njit(**_INSIDE)(function)
    return made


def inlined(function: _Function) -> _Function:
    """Compile a function into those that call it."""
    made: _Function = njit(**_INSIDE, forceinline=True)(function)
    return made


def summing(function: _Function) -> _Function:
    """Compile a function into those that call it, its sums in whatever order is fastest."""
    made: _Function = njit(**_INSIDE, forceinline=True, fastmath={"reassoc", "contract", "nsz"})(function)
    return made
