"""Tell whether the order of the conditions mattered: their place, their sequence and what came before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from studykit.analysis import mixed_model
from studykit.analysis.random_intercept import Coefficient, Term

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, kw_only=True, slots=True)
class OrderEffects:
    """Whether the order mattered, in three ways.

    Parameters
    ----------
    period : Term or None
        Whether the places in the session differ: practice, warming up, tiring.
    sequence : Term or None
        Whether people who were given different orders differ altogether; between participants.
    carry_over : Term or None
        Whether the condition before still shows.
    period_means : tuple of Coefficient
        Mean of every place in the session, conditions, sequences and carry-over weighing alike.
    model : MixedModel
        The model that says so. Its notes tell why an effect is None.
    """

    period: Term | None
    sequence: Term | None
    carry_over: Term | None
    period_means: tuple[Coefficient, ...]
    model: mixed_model.MixedModel


def order_effects(
    trials: pd.DataFrame,
    outcome: str,
    *,
    factors: Sequence[str] = ("condition",),
    confidence: float = 0.95,
) -> OrderEffects:
    """Test whether the order of the conditions mattered, beside the conditions themselves.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row a valid trial, columns as in `tables.TRIALS`.
    outcome : str
        Column of the values; rows without one are left out, and counted in the notes.
    factors : sequence of str
        What the conditions are made of.
    confidence : float
        Coverage of the intervals, 0 to 1.

    Raises
    ------
    InputError
        If a column is missing or the data are too few.

    Notes
    -----
    One mixed model (see `mixed_model.mixed_model`): conditions, period, sequence and carry-over, in this
    order, with a random intercept a participant. Period and carry-over are tested by how the participants
    differ, sequence, which is constant within them, against the variance between them, on about
    participants - sequences degrees of freedom. What the
    design cannot tell from the terms before it is left out: with two conditions in the orders AB and BA,
    for example, carry-over cannot be told from sequence (Jones & Kenward 2014, ch. 2). A test of carry-over
    that finds nothing does not show that there is none.
    """
    used, notes = mixed_model.with_values(
        trials, outcome, [*factors, "participant", "sequence", "period", "previous_condition"]
    )
    blocks = mixed_model.factorial(used, factors, notes)
    formula = [block.term for block in blocks if ":" not in block.term]
    blocks.append(mixed_model.categories(used["period"], "period"))
    people, sequences = used["participant"].nunique(), used["sequence"].nunique()
    if people > sequences:
        blocks.append(mixed_model.categories(used["sequence"], "sequence"))
    else:
        notes.append("sequence is left out: no two people danced the same, so it cannot be told from them")
    blocks.append(mixed_model.carry_over(used))
    ordered = [block.term for block in blocks if block.term in {"period", "sequence", "carry-over"}]
    model = mixed_model.fitted(
        used,
        outcome,
        blocks,
        formula=" + ".join((" * ".join(formula), *ordered, "(1 | participant)")),
        notes=notes,
        confidence=confidence,
    )
    found = {term.name: term for term in model.terms}
    return OrderEffects(
        period=found.get("period"),
        sequence=found.get("sequence"),
        carry_over=found.get("carry-over"),
        period_means=tuple(mean for mean in model.means if mean.name.startswith("period: ")),
        model=model,
    )
