"""How a report calls conditions, outcomes and declared results."""

from __future__ import annotations

from studykit.analysis.tables import TRIALS
from studykit.protocol.condition import ALL_CONDITIONS

_UNITS = {"bpm": "beats/min", "1": "", "": ""}
_NAMES = {
    "heart_rate_mean_bpm": "mean heart rate",
    "heart_rate_peak_bpm": "peak heart rate",
    "vigorous_fraction": "share of time at vigorous intensity",
    "dtw_m": "distance between dancer and guide",
    "dtw_lag_s": "lag behind the guide",
    "smoothness_rating": "rating of smoothness",
    "linear_energy_asked": "linear energy of the dance",
    "rotational_energy_asked": "rotational energy of the dance",
    "variety_achieved": "variety of the dance",
}


def condition(name: str) -> str:
    """Write a condition as people read it.

    Examples
    --------
    >>> condition("light-easy-on"), condition("intense-hard")
    ('Light – Easy, on', 'Intense – Hard')
    """
    levels = name.split("-")
    return " – ".join(level.capitalize() for level in levels[:2]) + "".join(f", {x}" for x in levels[2:])


def place(name: str) -> int:
    """Tell where a condition stands in every table: light before intense, easy before hard, on before off."""
    return ALL_CONDITIONS.index(name) if name in ALL_CONDITIONS else len(ALL_CONDITIONS)


def outcome(name: str) -> str:
    """Say in words what a column of the trials holds."""
    return _NAMES.get(name, name.replace("_", " "))


def unit(name: str) -> str:
    """Give the unit of a column of the trials; empty if it has none."""
    units = {column.name: column.unit for column in TRIALS.columns}
    return _UNITS.get(units.get(name, ""), units.get(name, ""))


def with_unit(name: str) -> str:
    """Say what a column of the trials holds, and in which unit."""
    return f"{outcome(name)} ({unit(name)})" if unit(name) else outcome(name)


def sentence(words: str) -> str:
    """Begin with a capital and leave the rest as it is."""
    return words[:1].upper() + words[1:]


def titled(name: str) -> str:
    """Write the name of a declared result as a heading."""
    return sentence(name.replace("_", " "))
