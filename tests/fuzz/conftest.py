"""The table at the end of a run."""

from __future__ import annotations

import pytest

HEADING = f"{'importer':18}{'inputs':>9}{'accepted':>10}{'refused':>9}{'slowest ms':>12}"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Print what each importer was given."""
    if "not fuzz" in config.getoption("markexpr"):
        return
    reports = [one for kind in ("passed", "failed") for one in terminalreporter.getreports(kind)]
    rows = sorted(value for one in reports for key, value in one.user_properties if key == "fuzz")
    if rows:
        terminalreporter.write_sep("-", "changed files")
        terminalreporter.write_line(HEADING)
        for row in rows:
            terminalreporter.write_line(row)
        terminalreporter.write_line(f"{'together':18}{sum(int(row[18:27]) for row in rows):9}")
