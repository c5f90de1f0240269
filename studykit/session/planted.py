"""What is planted in simulated people, written down where analysis never looks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from studykit.core.errors import InputError
from studykit.participant.effects import Effects
from studykit.participant.person import Person
from studykit.recording.journal import unwritable


def plant(path: Path, *, effects: Effects, seed: int, people: Sequence[Person]) -> None:
    """Write down the effects and the people of a simulated study, once.

    Parameters
    ----------
    path : Path
        The file.
    effects : Effects
        How outcomes depend on conditions.
    seed : int
        What all chance grows from.
    people : sequence of Person
        Everybody, with their true parameters.

    Raises
    ------
    InputError
        If other effects or people were planted in this study before, or the folder cannot be written.
    """
    content = json.dumps(
        {
            "note": "Simulated people and the effects planted in them. Analysis must not read this file.",
            "seed": seed,
            "effects": effects.model_dump(mode="json"),
            "people": {person.id: asdict(person) for person in people},
        },
        indent=1,
    )
    if path.exists():
        if path.read_text(encoding="utf-8") != content:
            raise InputError(
                "this study was simulated with other effects or another seed",
                where=path,
                remedy="use the same ones or another study folder",
            )
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8", newline="\n")
    except OSError as error:
        raise unwritable(path.parent, error) from error
