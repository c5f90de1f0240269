"""Tables for a paper: numbers as measured, LaTeX that compiles, CSV with every digit."""

from __future__ import annotations

import csv
from pathlib import Path
from shutil import copytree

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.recording.study_folder import StudyFolder
from studykit.reports.dance_tables import body_segments
from studykit.reports.draw import draw
from studykit.reports.paper_table import Heading, PaperTable
from studykit.reports.tables_out import TABLES, csv_text, escaped, latex

TABLE = PaperTable(
    name="made-up",
    caption="50 % of all",
    headings=(Heading(key="name", words="Name_1"), Heading(key="value", words="Value", decimals=2)),
    rows=({"name": "a & b", "value": -1.005}, {"name": "none", "value": None}, {"name": "c", "value": 3}),
    note="#1",
)


@pytest.fixture(scope="module")
def written(_recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    study = Path(copytree(_recorded, tmp_path_factory.mktemp("tables") / "small"))
    draw(study, only=["2"], with_tables=True)
    return StudyFolder(study).derivatives / "tables"


def test_a_table_in_latex_is_one_of_booktabs() -> None:
    assert latex(TABLE).splitlines() == [
        r"\begin{table}",
        r"\centering",
        r"\caption{50 \% of all}",
        r"\label{tab:made-up}",
        r"\begin{tabular}{lr}",
        r"\toprule",
        r"Name\_1 & Value \\",
        r"\midrule",
        r"a \& b & $-$1.00 \\",
        r"none & -- \\",
        r"c & 3.00 \\",
        r"\bottomrule",
        r"\end{tabular}",
        "",
        r"\smallskip{\footnotesize \#1}",
        r"\end{table}",
    ]


def test_a_table_as_csv_has_every_digit() -> None:
    assert csv_text(TABLE) == "name,value\na & b,-1.005\nnone,\nc,3\n"


@given(st.text())
def test_no_character_of_a_text_means_anything_to_latex(text: str) -> None:
    plain = escaped(text)
    for command in ("\\textbackslash{}", "\\textasciitilde{}", "\\textasciicircum{}"):
        plain = plain.replace(command, "")
    for command in ("\\{", "\\}", "\\&", "\\%", "\\$", "\\#", "\\_", "$-$", "$\\ge$", "$\\times$"):
        plain = plain.replace(command, "")
    assert not set(plain) & set("\\{}&%$#_^~")


def test_every_table_is_written_twice_and_rows_are_as_long_as_the_head(written: Path) -> None:
    stems = {path.stem for path in written.iterdir()}
    assert len(stems) == len(TABLES)
    for stem in stems:
        lines = list(csv.reader((written / f"{stem}.csv").read_text(encoding="utf-8").splitlines()))
        assert len({len(line) for line in lines}) == 1
        text = (written / f"{stem}.tex").read_text(encoding="utf-8")
        rows = [line for line in text.splitlines() if line.endswith(r"\\")]
        assert len(rows) == len(lines)
        assert {row.replace(r"\&", "").count("&") for row in rows} == {len(lines[0]) - 1}
        assert text.isascii()


def test_masses_of_a_body_add_up() -> None:
    rows = body_segments().rows
    assert len(rows) == 24
    assert sum(float(row["mass_fraction"]) for row in rows) == pytest.approx(1.0)
    assert sum(float(row["mass_kg"]) for row in rows) == pytest.approx(73.5)


def test_published_numbers_stand_beside_our_own(written: Path) -> None:
    vigorous = pd.read_csv(written / "vigorous.csv")
    assert list(vigorous["paper"]) == pytest.approx([0.0, 2.56, 66.17, 73.67])
    enjoyment = pd.read_csv(written / "enjoyment.csv")
    assert list(enjoyment["percent"])[:5] == [67.0, 74.0, 85.0, 79.0, 85.0]
    assert "PACES-18" in enjoyment["version"].iloc[-1]
    targets = pd.read_csv(written / "targets.csv")
    assert list(targets["paper"]) == [56.5, 147.2, 31.8, 106.5, 67.4, 143.1]


def test_people_are_those_of_the_study(written: Path) -> None:
    study = written.parents[2]
    people = pd.read_csv(study / "participants.tsv", sep="\t")
    table = pd.read_csv(written / "participants.csv", index_col="what")["here"]
    assert table["Participants"].startswith(f"{len(people)} (")
    assert table["Age (years)"].startswith(f"{people['age'].mean():.3g} (SD {people['age'].std():.2g})")
    answers = pd.read_csv(study / "phenotype" / "paces.tsv", sep="\t")
    items = pd.read_csv(written / "enjoyment-items.csv")
    assert items["mean"][1] == pytest.approx(answers["item_02"].mean())
    assert items["mean"][0] == pytest.approx(8.0 - answers["item_01"].mean())  # turned round
