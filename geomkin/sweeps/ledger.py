"""What a sweep has worked out so far, kept line by line, so that one that was stopped goes on where it was."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..export.files import naming

# Bytes that are read back; those of the most combinations there may be stay below it.
LARGEST = 500_000_000


class Ledger:
    """Rows by key in a file of JSON lines, whose first says what they are of.

    It begins anew if that is something else, or if any line is damaged: then no other can be relied on.

    Parameters
    ----------
    path : Path
        The file.
    title : Mapping
        What the rows are of: recipe, wishes, version.
    is_row : callable
        Whether a row is one that may be used.

    Attributes
    ----------
    known : dict
        Rows by key.
    anew : bool
        Whether there were rows, of something else or damaged.
    """

    def __init__(self, path: Path, title: Mapping[str, Any], is_row: Callable[[Any], bool]):
        self.path = path
        self.known: dict[str, Any] = {}
        with naming(path, "used"):
            content = self._content()
            # What follows the last end of a line was being written when the run was stopped.
            whole = content[: content.rfind(b"\n") + 1]
            lines = whole.split(b"\n")
            entries = list(map(_read, lines[1:-1]))
            sound = _read(lines[0]) == title and all(
                isinstance(entry, dict) and isinstance(entry.get("key"), str) and is_row(entry.get("row"))
                for entry in entries
            )
            self.anew: bool = bool(whole) and not sound
            if self.anew or not whole:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(_line(title))
                return
            self.known |= {entry["key"]: entry["row"] for entry in entries}
            if len(whole) < len(content):
                os.truncate(path, len(whole))

    def _content(self) -> bytes:
        if not os.path.lexists(self.path):
            return b""
        # A link may lead to what is no sweep's, and would be written over.
        if self.path.is_symlink() or not self.path.is_file():
            raise FileExistsError(0, "something that is no plain file stands under this name")
        if self.path.stat().st_size > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        return self.path.read_bytes()

    def add(self, rows: Mapping[str, Any]) -> None:
        """Set down further rows, by key, whole lines at once."""
        with naming(self.path, "used"), self.path.open("ab") as file:
            file.write(b"".join(_line({"key": key, "row": row}) for key, row in rows.items()))


def _line(held: Mapping[str, Any]) -> bytes:
    return (json.dumps(held) + "\n").encode()


def _read(line: bytes) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
