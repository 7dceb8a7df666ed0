"""The folder of a studio, with its recipes and the files that they name, and long work apart from requests."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from stat import S_ISREG
from threading import Event, Lock, Thread
from typing import Any, NamedTuple

from ..core.errors import DesignError, FileError, GeomkinError, printable, shown
from ..core.names import file_name_flaw, read_text_file
from ..core.processes import progress_to
from ..export.summary import write_whole
from ..recipe.toml import LARGEST, parsed

# Texts of a recipe that may be names of files; a longer one is no name.
LONGEST_NAME = 255
# Files that a recipe and those that it names may name; more would take long to read.
MOST_FILES = 100


try:
    import fcntl
except ImportError:  # pragma: no cover
    fcntl = None  # type: ignore[assignment]


class ConflictError(GeomkinError):
    """The file changed since it was opened."""


class Opened(NamedTuple):
    """A recipe's text, and the mark by which a later change of the file is recognised."""

    text: str
    base: str


class Workspace:
    """A folder with recipes.

    Parameters
    ----------
    folder : Path
        The folder; only files in it or below are read, and only recipes in it are written.
    """

    def __init__(self, folder: Path):
        self.folder, self._saving = folder.resolve(), Lock()

    @property
    def recipes(self) -> list[str]:
        """Names of the recipes, without their ending."""
        return sorted(path.stem for path in self.folder.glob("*.toml") if path.is_file())

    def open(self, name: str) -> Opened:
        """A recipe's text; raises FileError."""
        content = self._content(name)
        try:
            return Opened(content.decode("utf-8-sig"), mark_of(content))
        except UnicodeDecodeError:
            raise FileError(f"{name}.toml", "is not UTF-8 text", "save it as UTF-8", "file-unreadable") from None

    def save(self, name: str, text: str, base: str) -> str:
        """Write a recipe whole, and return its new mark.

        base: the mark of the file when it was opened; "" for a new file. Raises ConflictError if the file is another
        one by now, and FileError if it cannot be written.
        """
        path = self._path(name)
        content = text.encode()
        # Of several saves of one base, by this server or another one, the first wins.
        with self._saving, _locked(self.folder):
            if path.exists() and mark_of(self._content(name)) != base:
                raise ConflictError(f"{name}.toml was changed since it was opened")
            write_whole(self.folder, {path.name: content})
        return mark_of(content)

    def mark(self, name: str) -> str:
        """The mark of a recipe's file as it is now; "" if it is gone."""
        try:
            return mark_of(self._content(name))
        except FileError:
            return ""

    def files_of(self, text: str, further: Iterable[str] = ()) -> dict[str, str]:
        """Texts of the files that a recipe names, and of those that recipes among them name.

        Those that cannot be read are left out. further: names of other files.
        """
        texts: dict[str, str] = {}
        pending = [text]
        while pending and len(texts) < MOST_FILES:
            try:
                table = parsed(pending.pop())
            except GeomkinError:
                continue
            for name in {*_texts(table), *further} - set(texts):
                try:
                    if (self.folder / name).is_file():
                        texts[name] = read_text_file(name, self.folder, "a file")
                except (DesignError, OSError, ValueError):
                    continue
                if name.endswith(".toml") and name in texts:
                    pending.append(texts[name])
        return texts

    def _content(self, name: str) -> bytes:
        path = self._path(name)
        try:
            # A pipe or a device could block or never end.
            with open(path, "rb", opener=_open_at_once) as file:
                if not S_ISREG(os.fstat(file.fileno()).st_mode):
                    raise OSError(0, "it is not a file")
                content = file.read(LARGEST + 1)
        except OSError as error:
            problem = f"cannot be read ({error.strerror})"
            raise FileError(path.name, problem, "give a recipe of the folder", "file-unreadable") from None
        if len(content) > LARGEST:
            raise FileError(path.name, f"is larger than {LARGEST:,} bytes", "give a recipe", "too-much-work")
        return content

    def _path(self, name: str) -> Path:
        """The file of a recipe, in the folder itself and no link that leads out."""
        flaw = file_name_flaw(f"{name}.toml") if isinstance(name, str) else "it is no text"
        path = self.folder / f"{name}.toml"
        if flaw or path.parent != self.folder or not path.resolve().is_relative_to(self.folder):
            raise FileError(printable(shown(name)), "is no name of a recipe", "give a plain name", "file-unreadable")
        return path


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, by which other processes wait, on systems that have one."""
    if fcntl is None:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def mark_of(content: bytes) -> str:
    """The mark of a file's content."""
    return sha256(content).hexdigest()


def _texts(held: Any) -> Iterator[str]:
    if isinstance(held, Mapping):
        for value in held.values():
            yield from _texts(value)
    elif isinstance(held, list):
        for value in held:
            yield from _texts(value)
    elif isinstance(held, str) and "\0" not in held and 0 < len(held) <= LONGEST_NAME:
        yield held


# Jobs that are remembered; the oldest is forgotten.
MOST_JOBS = 20


class _Stopped(BaseException):
    """Raised inside the work at its next report of progress. It is no Exception, so that no work swallows it."""


class BackgroundJob:
    """Work in a thread of its own.

    Parameters
    ----------
    work : callable
        Returns the result, a dict; reports its progress as long work does.
    """

    def __init__(self, work: Callable[[], dict[str, Any]]):
        self.share, self.what = 0.0, ""
        self.result: dict[str, Any] | None = None
        self.done, self._stop = Event(), Event()
        self._work = work
        self.thread = Thread(target=self._run, daemon=True)
        self.thread.start()

    def stop(self) -> None:
        """Stop the work at its next report of progress."""
        self._stop.set()

    @property
    def state(self) -> dict[str, Any]:
        """Progress, and the result once it is there."""
        word = "stopped" if self._stop.is_set() else "done" if self.done.is_set() else "running"
        return {"state": word, "share": self.share, "what": self.what, "result": self.result}

    def _run(self) -> None:
        with progress_to(self._report), suppress(_Stopped):
            self.result = self._work()
        self.done.set()

    def _report(self, share: float, what: str) -> None:
        if self._stop.is_set():
            raise _Stopped
        self.share, self.what = share, what


class Jobs:
    """The jobs of a server, by number."""

    def __init__(self) -> None:
        self._jobs: dict[str, BackgroundJob] = {}
        self._lock, self._count = Lock(), 0

    def start(self, work: Callable[[], dict[str, Any]]) -> tuple[str, BackgroundJob]:
        """Start a job, and return its number and itself."""
        job = BackgroundJob(work)
        with self._lock:
            self._count += 1
            self._jobs[str(self._count)] = job
            while len(self._jobs) > MOST_JOBS:
                self._jobs.pop(next(iter(self._jobs))).stop()
            return str(self._count), job

    def get(self, id: str) -> BackgroundJob | None:
        """The job of this number; None if there is none."""
        return self._jobs.get(id)

    def stop_all(self, seconds: float) -> None:
        """Stop all jobs, and wait for their end, at most so many seconds in total."""
        jobs = list(self._jobs.values())
        for job in jobs:
            job.stop()
        join_all([job.thread for job in jobs], seconds)


def join_all(threads: Iterable[Thread], seconds: float) -> None:
    """Wait for the end of all threads, at most so many seconds in total."""
    end = time.monotonic() + seconds
    for thread in threads:
        thread.join(max(0.0, end - time.monotonic()))
