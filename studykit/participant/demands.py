"""What the quiet parts of a visit ask of a simulated person, and how long answering takes."""

from __future__ import annotations

DEMANDS: dict[str, float] = {
    "calibrate": 0.06,
    "baseline": 0.0,
    "train": 0.15,
    "watch": 0.03,
    "rest": 0.0,
    "smoothness": 0.02,
    "paces": 0.02,
    "demographics": 0.02,
}
"""Share of the heart-rate reserve by phase; what a dance asks for is planted."""

ANSWERING_S: dict[str, float] = {"smoothness": 6.0, "paces": 90.0, "demographics": 30.0}
"""How long a simulated person needs for a questionnaire, s."""
