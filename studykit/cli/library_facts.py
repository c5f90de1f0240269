"""What the commands of a library print of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from studykit.cli import show

TAKE_HEADS = {
    "take": "take",
    "duration_s": "seconds",
    "segments_possible": "segments possible",
    "segments_kept": "kept",
    "segments_paper": "by the paper's rule",
    "frames_speed": "frames too fast",
    "frames_acceleration": "frames too jerky",
    "frames_root": "frames the root jumps",
    "frames_paper": "frames by the paper's rule",
}


def print_calibration(library: Path) -> None:
    """Print what light, intense, easy and hard are measured to be, beside the paper's numbers."""
    import numpy as np

    from studykit.core.seeding import stream
    from studykit.library.calibrate import unit_readings
    from studykit.library.store import open_library
    from studykit.motion.body import DEFAULT_BODY_MASS_KG

    opened = open_library(library)
    calibration = opened.calibration
    chains, windows = len(calibration.chain_linear_energies), len(calibration.window_linear_energies)
    show.say(f"{opened.name}: {chains} random chains of eight segments (32 s) of one genre;")
    show.say(f"  windows of 32 s danced in one go: {windows or 'none, since takes are shorter'}")
    show.table(
        [
            {"in 32 s": f"{what.replace('_', ' ')} of {kind}s"}
            | {
                f"{share} %": f"{np.percentile(values, share) * unit:.1f}"
                for share in (5, 25, 50, 75, 95)
                for values in [getattr(calibration, f"{kind}_{what}")]
            }
            for kind in ("chain", "window")[: 2 if windows else 1]
            for what, unit in (
                ("linear_energies", DEFAULT_BODY_MASS_KG),
                ("rotational_energies", DEFAULT_BODY_MASS_KG),
                ("varieties", 1.0),
            )
        ]
    )
    _print_targets(facts_of(library))
    show.say("  mean energies of 32 s under each reading of the paper's unit:")
    table = unit_readings(opened, stream(0, "unit readings"))
    show.table(
        [
            {"reading": words, "linear": f"{linear:.3g}", "rotational": f"{rotational:.3g}"}
            for words, linear, rotational in table.itertuples(index=False)
        ]
        + [
            {
                "reading": "the paper, light to intense",
                "linear": "56.5 to 147.2",
                "rotational": "31.8 to 106.5",
            }
        ]
    )


def facts_of(library: Path) -> dict[str, Any]:
    """Give all that a library says of itself, and its targets."""
    from studykit.library.calibrate import genres_beside
    from studykit.library.store import open_library, read_manifest, read_rated

    opened, manifest = open_library(library), read_manifest(library)
    calibration = opened.calibration
    rated = read_rated(library)
    light, intense = calibration.energies_of("light", 25.0), calibration.energies_of("intense", 75.0)
    return manifest | {
        "genres_beside_chains": genres_beside(opened),
        "targets": {
            "from": "raters" if rated else "percentiles",
            "linear_energy": {"light": light[0], "intense": intense[0]},
            "rotational_energy": {"light": light[1], "intense": intense[1]},
            "variety": {
                level: calibration.variety_of(level, share)
                for level, share in (("easy", 0.55), ("hard", 0.94))
            },
            "agreement": rated.as_dict()["agreement"] if rated else None,
        },
        "windows": len(calibration.window_linear_energies),
        "median_distance": calibration.median_distance,
        "transition_tolerance_m": calibration.transition_tolerance_m,
    }


def print_info(library: Path) -> None:
    """Print what a library holds and what its dances aim at."""
    facts = facts_of(library)
    kept, paper, left = facts["segments_kept"], facts["segments_paper"], facts["takes_refused"]
    show.say(
        f"{facts['name']}: {facts['segments']} segments ({facts['hours'] * 60:.1f} min)"
        f" of {facts['takes']} takes"
    )
    if facts["stride_s"] < 4.0:
        show.say(f"  segments begin every {facts['stride_s']:g} s and overlap")
    if facts["mirrored"]:
        show.say("  every segment is also there with left and right exchanged")
    if facts["mirrored"] or facts["stride_s"] < 4.0:
        show.say("  minutes and yield count each movement once")
    if facts["takes_empty"]:
        show.say(f"  {facts['takes_empty']} takes give no segment: shorter than 4 s, or flagged throughout")
    if facts["is_synthetic"]:
        show.say("  SYNTHETIC: nobody danced these")
    if left:
        show.say(f"  left out: {left} files that could not be used; see 'library info {library} --takes'")
    show.say(
        f"  yield: {kept} of {facts['segments_possible']} possible; the paper's noise rule would keep {paper}"
    )
    if facts["decisions_ignored"]:
        show.say(
            f"  {facts['decisions_ignored']} decisions of a reviewer were made on other versions of takes"
        )
    if facts["rated_dropped"]:
        show.say(
            "  the raters' targets belonged to other segments, or were lost, and hold no more: rate again"
        )
    for kind in ("genres", "performers", "licences"):
        show.say(f"  {kind}: " + ", ".join(f"{name} ({count})" for name, count in facts[kind].items()))
    _print_targets(facts)


def _print_targets(facts: dict[str, Any]) -> None:
    from studykit.choreography.targets import PAPER_ENERGIES, PAPER_VARIETIES
    from studykit.motion.body import DEFAULT_BODY_MASS_KG

    targets = facts["targets"]
    show.say(
        f"  targets of 32 s, for {DEFAULT_BODY_MASS_KG} kg, linear and rotational energy"
        f" ({'as raters say' if targets['agreement'] else 'percentiles 25 and 75 of chains'}):"
    )
    for level, printed in PAPER_ENERGIES.items():
        linear, rotational = (
            targets[f"{kind}_energy"][level] * DEFAULT_BODY_MASS_KG for kind in ("linear", "rotational")
        )
        show.say(
            f"    {level}: {linear:.1f} and {rotational:.1f} (the paper: {printed[0]:g} and {printed[1]:g})"
        )
    for level, distance in PAPER_VARIETIES.items():
        variety = targets["variety"][level]
        show.say(
            f"    {level}: variety {variety:.1f}, {variety / facts['median_distance']:.2f} of the distance"
            f" between unrelated segments (the paper: {distance:g})"
        )
    if facts["genres_beside_chains"]:
        names = ", ".join(f"{name} ({count})" for name, count in facts["genres_beside_chains"].items())
        show.say(f"    no chain comes from genres of fewer than eight segments: {names}")
    for scale, told in (targets["agreement"] or {}).items():
        low, high = told["interval"]
        show.say(f"    raters agree on {scale}: alpha {told['alpha']:.2f} [{low:.2f}, {high:.2f}]")


def print_takes(library: Path, *, most: int | None = 60) -> None:
    """Print what became of the takes: all of them, or the first ones and every one left out."""
    from studykit.library.store import TAKES, index_folder, read_takes

    table = read_takes(library)
    read = table[table["status"] != "refused"].rename(columns=TAKE_HEADS)[list(TAKE_HEADS.values())]
    rows = read.to_dict("records")[:most]
    if rows:
        show.table([{head: _short(value) for head, value in row.items()} for row in rows])
        if len(rows) < len(read):
            show.say(f"... and {len(read) - len(rows)} takes more in {index_folder(library) / TAKES}")
    for reason in table.loc[table["status"] == "refused", "reason"] if most != 0 else ():
        show.say(f"left out: {reason}")


def _short(value: object) -> str:
    return f"{value:.1f}" if isinstance(value, float) else str(value)
