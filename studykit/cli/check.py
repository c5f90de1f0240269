"""studykit check: whether published numbers can be true together."""

from __future__ import annotations

import sys
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from studykit.cli import show
from studykit.cli.library import AsJson

HELP = """Check printed numbers against each other.

Write what belongs together with commas, and ";" or a new line between claims; what stands before a colon is
only a name. Every number stands for all values that would be rounded to it.

\b
chi2(3)=30.00, p<.001, W=0.50, n=20       p, Kendall's W, and whether ranks can give it
Friedman chi2(2)=8.4, n=7, no ties        only the ranks
F(3, 57)=4.20, p=.009;  t(19)=2.10, p=.049;  z=-3.05, r=.64, n=23
r=.90, p=.04                              which number of points gives both
V=40, n=9, p=.039                         Wilcoxon, exact and normal; half ranks too
Wilcoxon, pairs=6, Bonferroni, p<.01, n=20    whether p can be so small
M=5.18, SD=1.19, n=28, items=1, scale=1-7     whole answers (GRIM, GRIMMER)
17/20=85%;  85%, n=20;  items=18, scale=1-7, 85%;  12+8=20

Exit code 1 if something cannot be true, 2 if something cannot be read.
"""


def check(
    numbers: Annotated[
        str | None, typer.Argument(help="The claims, a file of them, or - for what is piped in.")
    ] = None,
    *,
    example: Annotated[
        bool, typer.Option("--example", help="Check the numbers of the paper that the protocol follows.")
    ] = False,
    json: AsJson = False,
) -> None:
    """Check printed numbers against each other."""
    from studykit.analysis.consistency import check_text
    from studykit.analysis.consistency.published import example as published
    from studykit.core.errors import InputError

    if example == (numbers is not None):
        raise InputError(
            "there is nothing to check",
            remedy='give numbers, such as "chi2(3)=30.00, W=0.50, n=20", or --example',
        )
    findings = check_text(published() if numbers is None else _text(numbers))
    wrong = [finding for finding in findings if not finding.is_consistent]
    if json:
        show.as_json([asdict(finding) for finding in findings])
    else:
        for claim, about in groupby(findings, key=lambda finding: finding.claim):
            show.say(claim)
            for finding in about:
                show.say(
                    f"  {'fits ' if finding.is_consistent else 'WRONG'}  {finding.kind}: {finding.words}"
                )
        show.say(f"{len(wrong)} of {len(findings)} checks fail.")
    if wrong:
        raise typer.Exit(1)


def _text(numbers: str) -> str:
    from studykit.core.errors import InputError

    if numbers == "-":
        return sys.stdin.read()
    path = Path(numbers)
    try:
        return path.read_text(encoding="utf-8") if path.is_file() else numbers
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("cannot be read as text", where=path, remedy="give a text file") from error
