"""Write files that appear complete or not at all."""

from __future__ import annotations

import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tusqh.errors import OutputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary name in the folder of `path`, renamed to `path` when the block succeeds.

    The temporary file keeps the suffix, by which many libraries choose the format.  If the
    block fails, it is removed, and an existing file at `path` is not changed.

    Parameters
    ----------
    path
        The file to write; its folder is made.

    Yields
    ------
    Path
        The temporary file, which exists and is empty.

    Raises
    ------
    OutputError
        The folder cannot be made or written to, or the disk is full.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with replacing(folder / "table.csv") as temporary:
    ...     _ = temporary.write_text("a,b")
    >>> [(p.name, p.read_text()) for p in folder.iterdir()]
    [('table.csv', 'a,b')]
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor, name = tempfile.mkstemp(
            prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent
        )
    except OSError as reason:
        raise _not_writable(path, str(reason.strerror or reason)) from reason
    os.close(descriptor)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes files private; give the result the permissions of any other new file.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except OSError as reason:
        if reason.filename not in (None, name):
            raise  # The error concerns another file.
        raise _not_writable(path, str(reason.strerror or reason)) from reason
    finally:
        temporary.unlink(missing_ok=True)


def require_writable(path: Path) -> None:
    """Raise an error if a file cannot be written, without writing it; call it before long work.

    Parameters
    ----------
    path
        The file to be written later.

    Raises
    ------
    OutputError
        The path is a folder, or its folder cannot be made or written to.

    Examples
    --------
    >>> require_writable(Path("new folder/mesh.vtu"))
    >>> require_writable(Path("."))
    Traceback (most recent call last):
    tusqh.errors.OutputError: .: cannot be written: it is a folder
      expected: a file name in a folder that can be written to
      remedy:   choose another place, or correct its permissions
    """
    if path.is_dir():
        raise _not_writable(path, "it is a folder")
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if not folder.is_dir():
        raise _not_writable(path, f"{folder} is a file")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise _not_writable(path, f"the folder {folder} is read-only")


def write_text(path: Path, text: str) -> None:
    r"""Write a UTF-8 text file with ``\n`` line ends; it appears complete or not at all.

    Parameters
    ----------
    path
        The file to write.
    text
        Its content.

    Raises
    ------
    OutputError
        The folder cannot be made or written to, or the disk is full.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode())


def remove_leftovers(path: Path) -> None:
    """Remove temporary files that a killed process left in the folder of a file.

    Parameters
    ----------
    path
        The file; no other process may be writing it.
    """
    for leftover in path.parent.glob(f".{glob.escape(path.stem)}-????????{path.suffix}"):
        leftover.unlink(missing_ok=True)


def _not_writable(path: Path, why: str) -> OutputError:
    return OutputError(
        f"cannot be written: {why}",
        where=str(path),
        expected="a file name in a folder that can be written to",
        remedy="choose another place, or correct its permissions",
    )
