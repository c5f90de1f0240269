"""The file in which an experimenter writes down a study."""

from __future__ import annotations

from pathlib import Path

from studykit.core.errors import InputError
from studykit.io.toml_file import model_text, read_model
from studykit.protocol.study_protocol import StudyProtocol


def read_protocol(path: Path | str) -> StudyProtocol:
    """Read a study's protocol and check that it is complete and consistent.

    Parameters
    ----------
    path : Path or str
        A TOML file like ``protocols/dance-2x2x2.toml``.

    Returns
    -------
    StudyProtocol

    Raises
    ------
    InputError
        Naming file, line, field and remedy.
    """
    return read_model(path, StudyProtocol)


def write_protocol(protocol: StudyProtocol, path: Path | str, *, source: Path | str | None = None) -> None:
    """Freeze a study's protocol into a new file.

    Parameters
    ----------
    protocol : StudyProtocol
        The protocol.
    path : Path or str
        Where to write; an existing file is never replaced.
    source : Path or str, optional
        The file from which the protocol was read: copied byte for byte, with the experimenter's own
        comments. Without it the fields are written with their explanations.

    Raises
    ------
    InputError
        If the file exists, cannot be written, or `source` holds another protocol.
    """
    path = Path(path)
    if source is not None and read_protocol(source) != protocol:
        raise InputError(
            "the file is not the protocol that is to be frozen",
            where=source,
            remedy="read the protocol again",
        )
    content = model_text(protocol).encode() if source is None else Path(source).read_bytes()
    try:
        with path.open("xb") as file:
            file.write(content)
    except FileExistsError:
        raise InputError("a protocol is already there", where=path, remedy="use another folder") from None
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise InputError(
            f"the file cannot be written ({reason})", where=path, remedy="use a folder that you may write to"
        ) from None


def default_protocol() -> Path:
    """Give the file of the study that comes with studykit: three factors with two levels each."""
    package = Path(__file__).parents[1]
    # An installed package carries its protocols; a checkout has them beside it.
    folders = (package / "protocols", package.parent / "protocols")
    return next(folder for folder in folders if folder.is_dir()) / "dance-2x2x2.toml"
