"""Writing so that what stands under a name is always whole: the old file or the new one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ..errors import FileError, printable


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under a temporary name beside it, then rename it over the old one.

    A full disk, a kill or a second run at the same moment leaves the old file or the new one, never a
    part of either. Raises FileError with what stood in the way.
    """
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


def _umask() -> int:
    """The permissions the user does not give to new files; temporary files start private."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _refusal(path: Path, error: OSError) -> FileError:
    reason = error.strerror or str(error)
    return FileError(f"{printable(path)}: cannot be written ({reason}); choose another place with --out")
