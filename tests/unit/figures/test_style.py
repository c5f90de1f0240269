"""Colours that everybody tells apart, and never colours alone."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from studykit.figures import style

# Linear RGB as seen without red or green receptors (Viénot, Brettel and Mollon 1999).
KINDS = {
    "all receptors": np.eye(3),
    "protanopia": np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]),
    "deuteranopia": np.array([[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]),
}
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
CLEARLY_DIFFERENT = 15.0
"""CIE 1976 colour difference; about 2.3 is just noticeable."""


def lab(colour: str, seen: np.ndarray) -> np.ndarray:
    """Give CIE L*a*b* (D65) of a colour as somebody sees it."""
    encoded = np.array([int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)])
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(seen @ linear, 0.0, 1.0) / [0.95047, 1.0, 1.08883]
    x, y, z = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def least_difference(colours: list[str], kind: str) -> float:
    seen = [lab(colour, KINDS[kind]) for colour in colours]
    return min(float(np.linalg.norm(a - b)) for a, b in combinations(seen, 2))


@pytest.mark.parametrize("kind", KINDS)
def test_colours_that_stand_beside_each_other_differ_for_every_common_kind_of_vision(kind: str) -> None:
    assert least_difference([colour for colour, _, _ in style.SERIES], kind) > CLEARLY_DIFFERENT
    assert least_difference([*style.INTENSITY.values(), style.INK], kind) > CLEARLY_DIFFERENT


def test_red_and_green_of_equal_lightness_would_not_do() -> None:
    wrong = ["#c0392b", "#6b7a00"]
    assert least_difference(wrong, "all receptors") > CLEARLY_DIFFERENT
    assert min(least_difference(wrong, kind) for kind in KINDS) < CLEARLY_DIFFERENT


def test_lines_differ_in_marker_and_dashes_too() -> None:
    for part in zip(*style.SERIES, strict=True):
        assert len({str(one) for one in part}) == len(style.SERIES)
    assert len(set(style.MARKERS.values())) == len(style.MARKERS)


def test_the_map_of_intensities_gets_darker_all_along() -> None:
    from studykit.figures.body import shades

    colours = shades(1.0, power=1.0).to_rgba(np.linspace(0.0, 1.0, 50))[:, :3]
    for seen in KINDS.values():
        lightness = [
            lab("#" + "".join(f"{round(255 * v):02x}" for v in colour), seen)[0] for colour in colours
        ]
        assert np.all(np.diff(lightness) < 0.5)


def test_widths_are_those_of_journals() -> None:
    assert 85.0 <= style.COLUMN_MM <= 90.0
    assert 170.0 <= style.PAGE_MM <= 180.0
