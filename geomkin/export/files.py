"""Writing so that what stands under a name is always whole: the old file or the new one."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ..core.errors import FileError, shown
from ..core.names import file_name_flaw, folded

# Of the names of files that are being written; hidden, so that nobody takes one for a part.
PREFIX = ".making-"
# Seconds after which a temporary file is what a killed run has left; no run that still works takes so long to write.
LEFT_BEHIND = 3600


def write_whole(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files, by name, all under temporary names first; only then rename each over its old one.

    A full disk leaves all old files. A kill or a second run at the same moment leaves each file old or new, never
    a part of either. Raises FileError with what stood in the way, and for a name that is not one plain file's name
    in the folder or that another differs from only by case, wherever it came from.
    """
    _refuse_strange(folder, contents)
    with _uninterrupted():
        temporary: dict[str, Path] = {}
        try:
            for name, content in contents.items():
                with naming(folder / name):
                    temporary[name] = _set_down(folder / name, content)
            for name in contents:
                with naming(folder / name):
                    temporary[name].replace(folder / name)
                del temporary[name]
        finally:
            for path in temporary.values():
                path.unlink(missing_ok=True)
        _sweep(folder)


def _refuse_strange(folder: Path, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        flaw = file_name_flaw(name) or ("another file has the same name" if folded(name) in seen else "")
        if flaw:
            problem = f"no file can be written as {shown(name)} ({flaw})"
            raise FileError(folder, problem, "give another name", "file-unwritable")
        seen.add(folded(name))


def _set_down(path: Path, content: bytes) -> Path:
    """A file with this content beside the path, whole and on the disk."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file():
        raise FileExistsError("something that is not a file stands under this name")
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


def _sweep(folder: Path) -> None:
    """Remove what killed runs have left; another run's own, still being written, is younger."""
    for path in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > LEFT_BEHIND:
                path.unlink()


@contextmanager
def naming(path: Path, done: str = "written") -> Iterator[None]:
    """Turns what the system says into an error that names the file, which cannot be `done`."""
    try:
        yield
    except (OSError, ValueError) as error:
        # A path with a sign that none may have is a ValueError.
        reason = getattr(error, "strerror", None) or str(error)
        problem = f"cannot be {done} ({reason})"
        raise FileError(path, problem, "choose another place (--out)", "file-unwritable") from error


def remove(path: Path) -> None:
    """Remove a file; one that is gone already is fine. Raises FileError with what stood in the way."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        problem = f"cannot be removed ({error.strerror})"
        raise FileError(path, problem, "remove it yourself", "file-unwritable") from error


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
