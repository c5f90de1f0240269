"""Which trials of a study count, and why others do not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from studykit.analysis.tables import DANCED_AGAIN
from studykit.recording.session_record import StepRecord

if TYPE_CHECKING:
    import pandas as pd

OTHER_PROTOCOL = "recorded with another protocol"
EARLIER_VISIT = "danced in an earlier visit"
SAME_RECORDING = "the same recording as another participant's"
TOO_LITTLE_SEEN = "heart rate or skeleton seen for too short a time"

_FINGERPRINT = ["condition", "dtw_m", "linear_energy_danced", "rotational_energy_danced"]


def of_step(step: StepRecord, last: Mapping[str | None, int]) -> str | None:
    """Say why a step in which somebody danced does not count within its visit; None if it does.

    Parameters
    ----------
    step : StepRecord
        The step.
    last : mapping
        Condition to the last step in which it was danced to its end.
    """
    if not step.is_complete:
        return "interrupted"
    if step.exclusion_reason is not None:
        return step.exclusion_reason
    return None if last[step.condition] == step.step else DANCED_AGAIN


def across_visits(trials: pd.DataFrame, protocol_sha256: str) -> pd.DataFrame:
    """Mark trials that must not count beside others: nobody is counted twice, and one protocol is followed.

    Trials recorded with another protocol than the study's do not count, unless all were. Of somebody who
    danced a condition in several visits the first counts, and of one recording under two names the first.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, the columns of `analysis.tables.TRIALS`.
    protocol_sha256 : str
        Digest of the study's protocol.

    Returns
    -------
    DataFrame
        The same rows; `is_valid` and `exclusion_reason` changed where need be.
    """
    judged = trials.copy()
    is_other = judged["protocol_sha256"] != protocol_sha256
    if not is_other.all():
        _exclude(judged, is_other, OTHER_PROTOCOL)
    for columns, reason in ((["participant", "condition"], EARLIER_VISIT), (_FINGERPRINT, SAME_RECORDING)):
        is_measured = judged["is_valid"] & judged[columns].notna().all(axis=1)
        _exclude(
            judged, judged[is_measured].duplicated(columns).reindex(judged.index, fill_value=False), reason
        )
    return judged


def _exclude(trials: pd.DataFrame, wrong: pd.Series[bool], reason: str) -> None:
    valid = wrong & trials["is_valid"]
    trials.loc[valid, "exclusion_reason"] = reason
    trials.loc[valid, "is_valid"] = False
