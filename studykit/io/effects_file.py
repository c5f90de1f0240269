"""Effects to plant in simulated people, by name or from a file."""

from __future__ import annotations

from pathlib import Path

from studykit.io.toml_file import read_model
from studykit.participant.effects import PLANTED, Effects


def read_effects(name: Path | str) -> Effects:
    """Give the effects of a name, "paper" or "none", or those of a TOML file.

    Raises
    ------
    InputError
        If there is no such file, or it holds no effects.
    """
    return PLANTED.get(str(name)) or read_model(name, Effects)
