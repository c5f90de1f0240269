"""The stages of the framework, from motion capture to the report, each with the module that does it."""

from __future__ import annotations

from studykit.figures.overview import Stage

_LIBRARY, _CHOREOGRAPHY, _STUDY = "Library", "Choreography", "Study"
_TERMS = (
    ("duration", "Duration\nEq. 2", "block"),
    ("transition", "Transition\nEq. 3, 4", "transition"),
    ("variety", "Variety\nEq. 5, 6", "block"),
    ("linear", "Linear intensity\nEq. 7 to 9", "block"),
    ("rotational", "Rotational intensity\nEq. 10 to 12", "block"),
)

PIPELINE: tuple[Stage, ...] = (
    Stage(
        name="takes", lane=_LIBRARY, words="Takes of dancers,\nmany formats", module="studykit.io.datasets",
    ),
    Stage(
        name="body", lane=_LIBRARY, words="One body: 24 joints,\nfacing +Z, 30 Hz",
        module="studykit.motion.retargeting", after=("takes",),
    ),
    Stage(
        name="clean", lane=_LIBRARY, words="Noise found,\nreviewed, removed",
        module="studykit.motion.cleaning", after=("body",),
    ),
    Stage(
        name="cut", lane=_LIBRARY, words="Segments of 4 s,\n120 poses",
        module="studykit.motion.segmentation", after=("clean",),
    ),
    Stage(
        name="measures", lane=_LIBRARY, words="Features and\nenergies",
        module="studykit.motion.features", after=("cut",),
    ),
    Stage(
        name="start", lane=_CHOREOGRAPHY, words="Random dance\nof segments",
        module="studykit.choreography.rjmcmc.search", after=("measures",),
    ),
    Stage(
        name="goal", lane=_CHOREOGRAPHY, words="Goal: intensity,\nvariety, length,\nspared joints",
        module="studykit.choreography.request",
    ),
    Stage(
        name="move", lane=_CHOREOGRAPHY, words="Add, remove or\nreplace a segment",
        module="studykit.choreography.rjmcmc.moves", after=("start",),
    ),
    *(
        Stage(
            name=name, lane=_CHOREOGRAPHY, words=words, module=f"studykit.choreography.cost.{module}",
            after=("move", "goal"),
        )
        for name, words, module in _TERMS
    ),
    Stage(
        name="accept", lane=_CHOREOGRAPHY, words="Total cost (Eq. 1):\naccept or refuse\n(Eq. 13), cool down",
        module="studykit.choreography.rjmcmc.annealing", after=tuple(name for name, _, _ in _TERMS),
        again="move",
    ),
    Stage(
        name="animate", lane=_CHOREOGRAPHY, words="Joins blended,\nfeet held: a dance",
        module="studykit.motion.animation", after=("accept",),
    ),
    Stage(
        name="dance", lane=_STUDY, words="Watch, then dance\nwith the guide",
        module="studykit.session.runner", after=("animate",),
    ),
    Stage(
        name="record", lane=_STUDY, words="Joints, heart rate\nand answers recorded",
        module="studykit.recording.session_record", after=("dance",),
    ),
    Stage(
        name="trials", lane=_STUDY, words="Measures of each\ntrial",
        module="studykit.reports.trials", after=("record",),
    ),
    Stage(
        name="tests", lane=_STUDY, words="Tests declared in\nthe protocol",
        module="studykit.analysis.planned", after=("trials",),
    ),
    Stage(
        name="report", lane=_STUDY, words="Figures, tables,\nreport", module="studykit.reports.report",
        after=("tests",),
    ),
)  # fmt: skip
"""The stages of Figure 2."""
