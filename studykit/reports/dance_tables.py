"""Tables of the paper's supplement that describe dances: bodies, parameters, targets and what was found."""

from __future__ import annotations

import numpy as np

from studykit.choreography.preset import PRESETS, Preset
from studykit.choreography.targets import PAPER_ENERGIES, PAPER_VARIETIES
from studykit.figures.samples import ORDER
from studykit.motion.body import DEFAULT_BODY_MASS_KG, segments
from studykit.motion.skeleton import JOINT_NAMES
from studykit.reports.material import Material
from studykit.reports.paper_table import Cell, Heading, PaperTable
from studykit.reports.trials import dances

_FACTORS = {"linear_energy": DEFAULT_BODY_MASS_KG, "rotational_energy": DEFAULT_BODY_MASS_KG, "variety": 1.0}
_PUBLISHED_SPREADS = {"linear_energy": 88.4, "rotational_energy": 48.0, "variety": 48.3}


def body_segments(_: Material | None = None) -> PaperTable:
    """Give the mass, radius of gyration and length of what each joint carries."""
    body = segments()
    rows: list[dict[str, Cell]] = [
        {
            "joint": name.replace("_", " "),
            "mass_fraction": float(body.masses[joint]),
            "mass_kg": float(DEFAULT_BODY_MASS_KG * body.masses[joint]),
            "gyration_radius": float(body.gyration_radii[joint]),
            "length_m": float(body.lengths[joint]),
        }
        for joint, name in enumerate(JOINT_NAMES)
    ]
    return PaperTable(
        name="body-segments",
        caption="Share of body mass, radius of gyration and length of the segment that each joint moves "
        "(m, k and L of Eq. 8 and 11).",
        headings=(
            Heading(key="joint", words="Joint"),
            Heading(key="mass_fraction", words="Mass (share)", decimals=4),
            Heading(key="mass_kg", words=f"Mass (kg of {DEFAULT_BODY_MASS_KG:g})", decimals=2),
            Heading(key="gyration_radius", words="k (share of L)", decimals=3),
            Heading(key="length_m", words="L (m)", decimals=3),
        ),
        rows=tuple(rows),
        note="Winter 2009, table 4.1; lengths of the SMPL skeleton scaled to the average adult male.",
    )


def parameters(material: Material) -> PaperTable:
    """Give every parameter of the search, beside those of the paper."""
    plan = material.protocol.dance
    here, published = (_searched(PRESETS[name]) for name in (plan.preset, "paper"))
    own = {
        "duration of a dance (s)": plan.duration_s,
        **{f"weight of {name}": value for name, value in plan.weights.model_dump().items()},
        "tolerance of energies": f"{100.0 * plan.intensity.tolerance:g} % of the target",
        "tolerance of variety": f"{100.0 * plan.variety.tolerance:g} % of Hard − Easy",
    }
    theirs = {
        "duration of a dance (s)": 32.0,
        **{f"weight of {name}": "1" for name in plan.weights.model_dump()},
        "weight of variety": "not told",
        "weight of transition": "1, or 0 without transition cost",
        "tolerance of energies": "88.4 (linear), 48.0 (rotational)",
        "tolerance of variety": "48.3",
    }
    own |= here
    theirs |= published
    return PaperTable(
        name="parameters",
        caption=f"Parameters of the search for dances (preset {plan.preset}) and those of the paper.",
        headings=(
            Heading(key="parameter", words="Parameter"),
            Heading(key="here", words="Here"),
            Heading(key="paper", words="Paper"),
        ),
        rows=tuple(
            {"parameter": name, "here": _plain(value), "paper": _plain(theirs.get(name))}
            for name, value in own.items()
        ),
        note="What the paper leaves open is that of the preset “paper”.",
    )


def energy_targets(material: Material) -> PaperTable:
    """Give what was asked of the dances, beside the targets of the paper."""
    rows = []
    for goal, words, factor in (
        ("linear_energy", "linear energy (J)", DEFAULT_BODY_MASS_KG),
        ("rotational_energy", "rotational energy (J)", DEFAULT_BODY_MASS_KG),
        ("variety", "variety (mean feature distance)", 1.0),
    ):
        published = (
            PAPER_VARIETIES if goal == "variety" else
            {level: PAPER_ENERGIES[level][goal == "rotational_energy"] for level in PAPER_ENERGIES}
        )  # fmt: skip
        for level, value in published.items():
            asked = [
                factor * getattr(dance.asked, goal)
                for name, dance in material.dances.items()
                if level in name.split("-")
            ]
            rows.append(
                {
                    "goal": words,
                    "level": level,
                    "here": float(np.mean(asked)) if asked else None,
                    "paper": value,
                    "paper_sigma": _PUBLISHED_SPREADS[goal],
                }
            )
    return PaperTable(
        name="targets",
        caption="What was asked of the dances and what the paper prints (section 5.6).",
        headings=(
            Heading(key="goal", words="Goal"),
            Heading(key="level", words="Level"),
            Heading(key="here", words="Here", decimals=1),
            Heading(key="paper", words="Paper", decimals=1),
            Heading(key="paper_sigma", words="Paper, sigma", decimals=1),
        ),
        rows=tuple(rows),
        note=f"Energies of {material.protocol.dance.duration_s:g} s for {DEFAULT_BODY_MASS_KG:g} kg here. "
        "The paper gives no unit; its numbers are labels, not comparable constants.",
    )


def achieved_targets(material: Material) -> PaperTable:
    """Give what each dance was asked for and what it has."""
    found = {str(row["condition"]): row for row in dances(material.dances).to_dict("records")}
    rows: list[dict[str, Cell]] = []
    for name in (f"{cell}-{transition}" for cell in ORDER for transition in ("on", "off")):
        if name not in found:
            continue
        row: dict[str, Cell] = {"condition": name}
        for goal, factor in _FACTORS.items():
            row |= {f"{goal}_{kind}": factor * found[name][f"{goal}_{kind}"] for kind in ("asked", "shown")}
        row |= {
            "distinct_segments": found[name]["distinct_segments"],
            "join_displacement_mm": 1000.0 * found[name]["join_displacement_m"],
        }
        rows.append(row)
    words = {"linear_energy": "linear (J)", "rotational_energy": "rotational (J)", "variety": "variety"}
    return PaperTable(
        name="dances",
        caption="What was asked of each dance, and what the dance as shown has, joins included.",
        headings=(
            Heading(key="condition", words="Dance"),
            *(
                Heading(key=f"{goal}_{kind}", words=f"{words[goal]}, {kind}", decimals=1)
                for goal in _FACTORS
                for kind in ("asked", "shown")
            ),
            Heading(key="distinct_segments", words="distinct segments", decimals=0),
            Heading(key="join_displacement_mm", words="jump at joins (mm)", decimals=0),
        ),
        rows=tuple(rows),
        note=f"Energies for {DEFAULT_BODY_MASS_KG:g} kg.",
    )


def _searched(preset: Preset) -> dict[str, Cell]:
    annealing = preset.annealing
    return {
        "metric of variety": preset.variety,
        "scale of energies": preset.intensity,
        "form of the transition cost": preset.form,
        "iterations": annealing.iterations,
        "chains": preset.chains,
        "first temperature": float(annealing.temperatures[0]),
        "last temperature": float(annealing.temperatures[-1]),
        "first width of tolerances": float(annealing.widths[0]),
        "place of a new segment": preset.moves,
        "acceptance": preset.acceptance,
        "new segments from near joins": preset.neighbour,
        "joining": preset.blend,
    }


def _plain(value: object) -> str:
    if value is None:
        return ""
    return f"{value:g}" if isinstance(value, float) else str(value).replace("_", " ")
