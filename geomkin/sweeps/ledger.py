"""The file of computed rows, from which an interrupted sweep continues."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..export.files import system_errors_as_file_errors

# Largest file that is read back, bytes; the rows of the most combinations stay below it.
LARGEST = 500_000_000


class Ledger:
    """Rows by key in a file of JSON lines; the first line identifies the sweep.

    The file is emptied if it belongs to another sweep or any line is damaged.

    Parameters
    ----------
    path : Path
        The file.
    title : Mapping
        Identity of the sweep: recipe, results, version.
    is_row : callable
        Whether a row has the right form.

    Attributes
    ----------
    known : dict
        Rows by key.
    is_restarted : bool
        Whether the file had rows of another sweep, or was damaged.
    """

    def __init__(self, path: Path, title: Mapping[str, Any], is_row: Callable[[Any], bool]):
        self.path = path
        self.known: dict[str, Any] = {}
        with system_errors_as_file_errors(path, "used"):
            content = self._content()
            # A last line without a line break was incomplete when the run was stopped.
            whole = content[: content.rfind(b"\n") + 1]
            lines = whole.split(b"\n")
            entries = list(map(_parsed, lines[1:-1]))
            is_valid = _parsed(lines[0]) == title and all(
                isinstance(entry, dict) and isinstance(entry.get("key"), str) and is_row(entry.get("row"))
                for entry in entries
            )
            self.is_restarted: bool = bool(whole) and not is_valid
            if self.is_restarted or not whole:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(_line(title))
                return
            self.known |= {entry["key"]: entry["row"] for entry in entries}
            if len(whole) < len(content):
                os.truncate(path, len(whole))

    def _content(self) -> bytes:
        if not os.path.lexists(self.path):
            return b""
        # A link may point to another file, which must not be overwritten.
        if self.path.is_symlink() or not self.path.is_file():
            raise FileExistsError(0, "this name belongs to something other than a plain file")
        if self.path.stat().st_size > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        return self.path.read_bytes()

    def add(self, rows: Mapping[str, Any]) -> None:
        """Append rows by key, in one write."""
        with system_errors_as_file_errors(self.path, "used"), self.path.open("ab") as file:
            file.write(b"".join(_line({"key": key, "row": row}) for key, row in rows.items()))


def _line(entry: Mapping[str, Any]) -> bytes:
    return (json.dumps(entry) + "\n").encode()


def _parsed(line: bytes) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
