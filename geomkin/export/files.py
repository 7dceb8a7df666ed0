"""Atomic writing: a file is always either the complete old or the complete new one."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ..core.errors import FileError, shown
from ..core.names import file_name_flaw, folded_name

# Prefix of temporary files, which are hidden so that nobody mistakes one for a part.
PREFIX = ".making-"
# Age, s, after which a temporary file counts as left by a killed run. Writing a file takes far less.
LEFT_BEHIND = 3600


def write_whole(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files, by name: all under temporary names first, then each renamed over the old one.

    A full disk leaves all old files. A kill or a simultaneous second run leaves each file old or new, never partial.
    Raises FileError with the reason, and for a name that is not a plain file name or differs from another only by case.
    """
    _check_names(folder, contents)
    with _uninterrupted():
        temporary: dict[str, Path] = {}
        try:
            for name, content in contents.items():
                with system_errors_as_file_errors(folder / name):
                    temporary[name] = _write_temporary(folder / name, content)
            for name in contents:
                with system_errors_as_file_errors(folder / name):
                    temporary[name].replace(folder / name)
                del temporary[name]
        finally:
            for path in temporary.values():
                path.unlink(missing_ok=True)
        _remove_leftovers(folder)


def _check_names(folder: Path, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        flaw = file_name_flaw(name) or ("another file has the same name" if folded_name(name) in seen else "")
        if flaw:
            problem = f"no file can be written as {shown(name)} ({flaw})"
            raise FileError(folder, problem, "give another name", "file-unwritable")
        seen.add(folded_name(name))


def _write_temporary(path: Path, content: bytes) -> Path:
    """A complete temporary file with this content in the same folder, flushed to the disk."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file():
        raise FileExistsError("this name belongs to something that is not a file")
    handle, name = tempfile.mkstemp(prefix=PREFIX, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o666 & ~_umask())
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
    return Path(name)


def _remove_leftovers(folder: Path) -> None:
    """Remove temporary files of killed runs; those of running ones are younger."""
    for path in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > LEFT_BEHIND:
                path.unlink()


@contextmanager
def system_errors_as_file_errors(path: Path, done: str = "written") -> Iterator[None]:
    """Turn a system error into a FileError for a file that cannot be read, written or removed; done: which of these."""
    try:
        yield
    except (OSError, ValueError) as error:
        # A path with an invalid character raises ValueError.
        reason = getattr(error, "strerror", None) or str(error)
        problem = f"cannot be {done} ({reason})"
        raise FileError(path, problem, "choose another folder (--out)", "file-unwritable") from error


def remove(path: Path) -> None:
    """Remove a file, which may be gone already; FileError with the reason if that fails."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        problem = f"cannot be removed ({error.strerror})"
        raise FileError(path, problem, "remove it yourself", "file-unwritable") from error


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay Ctrl-C until the temporary files are gone, if the system allows it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _umask() -> int:
    """The permission bits removed from new files; temporary files start private."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
