"""What the columns of every table mean, and the check that a table keeps to it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

from studykit.core.errors import InputError, nearest
from studykit.protocol.condition import ALL_CONDITIONS, Intensity, Transition, Variety
from studykit.protocol.study_protocol import Blinded

if TYPE_CHECKING:
    import pandas as pd

Kind = Literal["text", "integer", "number", "boolean"]

_DTYPES: dict[Kind, str] = {"text": "str", "integer": "int64", "number": "float64", "boolean": "bool"}
_ARTICLES: dict[Kind, str] = {
    "text": "text", "integer": "a whole number", "number": "a number", "boolean": "True or False"
}  # fmt: skip


@dataclass(frozen=True, kw_only=True, slots=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    name : str
        As in the file's first line.
    kind : {"text", "integer", "number", "boolean"}
        What its values are.
    description : str
        What it means.
    unit : str
        Unit of the values; empty if they have none.
    allowed : tuple of str
        The only values of a text; empty if any will do.
    minimum, maximum : float or None
        Range of a number.
    may_be_missing : bool
        Whether a cell may be empty.
    """

    name: str
    kind: Kind
    description: str
    unit: str = ""
    allowed: tuple[str, ...] = ()
    minimum: float | None = None
    maximum: float | None = None
    may_be_missing: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class TableSchema:
    """The columns of a table, in order.

    Parameters
    ----------
    name : str
        The file that holds such a table.
    columns : tuple of Column
    """

    name: str
    columns: tuple[Column, ...]

    @property
    def column_names(self) -> tuple[str, ...]:
        """The names of the columns, in order."""
        return tuple(column.name for column in self.columns)

    @property
    def dtypes(self) -> dict[str, str]:
        """The type of each column, for reading: ``pandas.read_csv(path, dtype=TRIALS.dtypes)``."""
        return {column.name: _DTYPES[column.kind] for column in self.columns}

    def column(self, name: str) -> Column:
        """Give a column by its name.

        Raises
        ------
        InputError
            If there is none; it says which one is spelt most like it.
        """
        for column in self.columns:
            if column.name == name:
                return column
        raise InputError(
            f'there is no column "{name}"', where=self.name, remedy=nearest(name, self.column_names)
        )


def _text(name: str, description: str, **options: Any) -> Column:
    return Column(name=name, kind="text", description=description, **options)


def _measured(
    name: str,
    description: str,
    unit: str = "1",
    *,
    minimum: float | None = 0.0,
    maximum: float | None = None,
) -> Column:
    return Column(
        name=name,
        kind="number",
        description=description,
        unit=unit,
        minimum=minimum,
        maximum=maximum,
        may_be_missing=True,
    )


def _counted(name: str, description: str) -> Column:
    return Column(name=name, kind="integer", description=description, minimum=1)


def _truth(name: str, description: str) -> Column:
    return Column(name=name, kind="boolean", description=description)


DANCED_AGAIN = "danced again"
"""Why a trial does not count though nothing is wrong with it: the same person danced the condition again."""

TRIALS = TableSchema(
    name="trials.csv",
    columns=(
        _text("participant", "who danced, such as 07"),
        _text("session", "which visit, such as 01"),
        _counted("sequence", "row of the Latin square that gave the order of the conditions"),
        _counted("period", "place of this condition in the session's order"),
        _text("condition", "intensity, variety and transition joined", allowed=ALL_CONDITIONS),
        _text("intensity", "how much energy the dance has", allowed=get_args(Intensity)),
        _text("variety", "how much its parts differ", allowed=get_args(Variety)),
        _text("transition", "whether it was made to join its parts smoothly", allowed=get_args(Transition)),
        _text(
            "previous_condition",
            "the condition before; empty in the first period",
            allowed=ALL_CONDITIONS,
            may_be_missing=True,
        ),
        _truth("is_valid", "whether the trial is analysed"),
        _text("exclusion_reason", "why it is not; empty if it is", may_be_missing=True),
        _measured("heart_rate_mean_bpm", "mean heart rate, weighted by time", "bpm", maximum=300.0),
        _measured("heart_rate_peak_bpm", "highest heart rate", "bpm", maximum=300.0),
        _measured("vigorous_fraction", "share of time at or above the vigorous threshold", maximum=1.0),
        _measured("dtw_m", "mean joint distance from the guide per aligned frame", "m"),
        _measured("dtw_lag_s", "how late the dancer was; negative when early", "s", minimum=None),
        _measured("linear_energy_asked", "linear energy of the dance as shown, over all poses", "J/kg"),
        _measured(
            "rotational_energy_asked", "rotational energy of the dance as shown, over all poses", "J/kg"
        ),
        _measured(
            "linear_energy_danced",
            "linear energy of the dancer as seen by the camera, its trembling taken off, over all poses",
            "J/kg",
        ),
        _measured(
            "rotational_energy_danced",
            "rotational energy of the dancer as seen by the camera, its trembling taken off, over all poses",
            "J/kg",
        ),
        _measured("variety_achieved", "mean feature distance between the dance's segments"),
        _measured("smoothness_rating", "answer to the question about smoothness", minimum=None),
        _truth("simulated", "whether the person or a device was simulated"),
        _text("protocol_sha256", "digest of the protocol"),
        _text("data_sha256", "digest of the recording"),
        _counted("repetition", "which time this condition was begun in the visit, from 1"),
        _measured(
            "heart_rate_resting_bpm",
            "mean heart rate in the last minute of the visit's baseline",
            "bpm",
            maximum=300.0,
        ),
        _measured(
            "heart_rate_recovery_bpm",
            "fall of the heart rate in the minute after dancing; empty if that minute was no rest",
            "bpm",
            minimum=None,
        ),
        _measured(
            "heart_rate_coverage", "share of the heart-rate window for which a reading stood", maximum=1.0
        ),
        _measured(
            "rr_corrected_share",
            "share of the times between beats in the window that were wrong; empty if the belt sent none",
            maximum=1.0,
        ),
        _measured(
            "vigorous_fraction_reserve",
            "share of time at or above 60 % of the heart-rate reserve",
            maximum=1.0,
        ),
        _measured("dtw_arms_m", "as dtw_m, of shoulders, elbows and wrists", "m"),
        _measured("dtw_legs_m", "as dtw_m, of hips, knees and ankles", "m"),
        _measured("dtw_trunk_m", "as dtw_m, of neck, head and chest", "m"),
        _measured("dtw_lag_sd_s", "how unsteadily late the dancer was: standard deviation of the lag", "s"),
        _measured(
            "smoothness_ldlj",
            "log dimensionless jerk, mean of wrists and ankles; nearer to 0 is smoother",
            minimum=None,
        ),
        _measured(
            "range_of_motion_rad", "how far shoulders, elbows, hips and knees turned on average", "rad"
        ),
        _measured(
            "skeleton_coverage", "share of joints and frames compared in which a joint was seen", maximum=1.0
        ),
        _measured(
            "energy_noise_share",
            "share of the energy seen that was the camera's trembling, which is taken off; empty if the "
            "person was not filmed standing still, so that nothing could be taken off",
            minimum=None,
            maximum=1.0,
        ),
        _text(
            "blinded",
            "who did not know which condition it was; empty where the protocol does not say",
            allowed=get_args(Blinded),
            may_be_missing=True,
        ),
    ),
)
"""One row a trial: one condition performed once."""

PACES = TableSchema(
    name="paces.tsv",
    columns=(
        _text("participant_id", "who answered, such as sub-07"),
        *(
            _measured(
                f"item_{number:02d}",
                "answer as ticked: 1 the left pole, 7 the right; empty if left out",
                minimum=1.0,
                maximum=7.0,
            )
            for number in range(1, 19)
        ),
    ),
)
"""One row a participant: the answers to the Physical Activity Enjoyment Scale."""


def check(frame: pd.DataFrame, schema: TableSchema, *, columns: Iterable[str] | None = None) -> pd.DataFrame:
    """Check that a table is what its schema says, and give it back.

    Parameters
    ----------
    frame : pandas.DataFrame
        The table.
    schema : TableSchema
        Its columns: names, order, kinds and allowed values.
    columns : iterable of str, optional
        Check only these, wherever they stand; all columns, in their order, if not given.

    Raises
    ------
    InputError
        Naming the file, the column and the row.
    """
    if columns is None:
        _check_order(list(frame.columns), schema)
        wanted: Iterable[str] = schema.column_names
    else:
        wanted = columns
    for name in wanted:
        column = schema.column(name)
        if name not in frame.columns:
            raise InputError(
                f'the column "{name}" is missing', where=schema.name, remedy="write the table again"
            )
        _check_values(frame[name], column, schema.name)
    return frame


def _check_order(names: list[str], schema: TableSchema) -> None:
    for name in names:
        schema.column(name)
    missing = [name for name in schema.column_names if name not in names]
    if missing:
        raise InputError(
            f'the column "{missing[0]}" is missing', where=schema.name, remedy="write the table again"
        )
    if names != list(schema.column_names):
        wrong = next(name for name, wanted in zip(names, schema.column_names, strict=False) if name != wanted)
        raise InputError(
            f'the column "{wrong}" is not in its place', where=schema.name, remedy="write the table again"
        )


def _check_values(values: pd.Series[Any], column: Column, table: str) -> None:
    missing = values.isna()
    for wrong, problem in (
        (missing & (not column.may_be_missing), "is empty"),
        (~missing & ~_is_of_kind(values, column.kind), f"is not {_ARTICLES[column.kind]}"),
    ):
        _refuse(values, wrong, f'"{column.name}" {problem}', table)
    if column.allowed:
        allowed = f'"{column.name}" is none of {", ".join(column.allowed)}'
        _refuse(values, ~missing & ~values.isin(column.allowed), allowed, table)
    if column.minimum is not None:
        _refuse(values, values < column.minimum, f'"{column.name}" is below {column.minimum:g}', table)
    if column.maximum is not None:
        _refuse(values, values > column.maximum, f'"{column.name}" is above {column.maximum:g}', table)


def _is_of_kind(values: pd.Series[Any], kind: Kind) -> pd.Series[bool]:
    from pandas.api import types

    if kind == "text":
        return values.map(lambda value: isinstance(value, str)).astype(bool)
    fits = {
        "boolean": types.is_bool_dtype(values),
        "integer": types.is_integer_dtype(values),
        "number": types.is_numeric_dtype(values) and not types.is_bool_dtype(values),
    }[kind]
    return values.map(lambda _: fits).astype(bool)


def _refuse(values: pd.Series[Any], wrong: pd.Series[bool], problem: str, table: str) -> None:
    if not wrong.any():
        return
    row = int(wrong.to_numpy().argmax())
    shown = "" if values.isna().iloc[row] else f" ({values.iloc[row]})"
    raise InputError(
        f"{problem}{shown}", where=f"{table}, row {row + 1}", remedy="put it right and try again"
    )
