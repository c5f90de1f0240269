"""The command line: thin, one verb a module."""

from __future__ import annotations

import sys
from typing import cast

_STOPPED = 130  # what a shell says of a command that was interrupted


def main(arguments: list[str] | None = None) -> None:
    """Run one command; a wrong call or a wrong file ends with one sentence and exit code 2."""
    import typer
    from typer.main import get_command

    from studykit.cli.app import app
    from studykit.core.errors import InputError

    # Typer does not say the name of the error that its parser raises; it is what its own one derives from.
    usage_error = cast(type[Exception], typer.BadParameter.__mro__[1])
    try:
        code = get_command(app).main(args=arguments, prog_name="studykit", standalone_mode=False)
    except InputError as error:
        _end(f"studykit: {error}", 2)
    except (typer.Abort, KeyboardInterrupt):
        code = _STOPPED
    except usage_error as error:
        context = getattr(error, "ctx", None)
        command = context.command_path if context else "studykit"
        sentence = str(getattr(error, "format_message", error.__str__)()).rstrip(".?")
        _end(f"{command}: {sentence}; see '{command} --help'.", 2)
    if code == _STOPPED:
        _end("studykit: stopped; the same command goes on where it was, or begins again.", _STOPPED)
    raise SystemExit(code if isinstance(code, int) else 0)


def _end(sentence: str, code: int) -> None:
    print(sentence, file=sys.stderr)
    raise SystemExit(code)
