"""Writing so that what stands under a name is always whole: the old file or the new one."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import FileError, printable


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under a temporary name beside it, then rename it over the old one.

    A full disk, a kill or a second run at the same moment leaves the old file or the new one, never a
    part of either. Raises FileError with what stood in the way.
    """
    with _uninterrupted():
        _write(path, content)


def _write(path: Path, content: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():
            raise FileExistsError("something that is not a file stands under this name")
        handle, temporary = tempfile.mkstemp(prefix=".making-", dir=path.parent)
    except OSError as error:
        raise _refusal(path, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except BaseException as error:
        Path(temporary).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise _refusal(path, error) from error
        raise


def remove(path: Path) -> None:
    """Remove a file; one that is gone already is fine. Raises FileError with what stood in the way."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise FileError(f"{printable(path)}: cannot be removed ({error.strerror}); remove it yourself") from error


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C waits until the temporary file is gone again, where the system can make it wait."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _umask() -> int:
    """The permissions the user does not give to new files; temporary files start private."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _refusal(path: Path, error: OSError) -> FileError:
    reason = error.strerror or str(error)
    return FileError(f"{printable(path)}: cannot be written ({reason}); choose another place with --out")
