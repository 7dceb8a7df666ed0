"""A file of another program as a recipe, by its content."""

from __future__ import annotations

from pathlib import Path

from ..core.errors import FileError
from . import linkage_xml, pmks_link, pylinkage_json
from .drawn import recipe_of, refuse

# Largest file, bytes.
LARGEST = 1_000_000


def imported(path: Path) -> str:
    """The text of a recipe with the linkage of a file of pylinkage, PMKS+ or Linkage.

    Parameters
    ----------
    path : Path
        JSON of pylinkage's `mechanism_to_json`, a text file with a link that PMKS+ shares, or a `.linkage2` file.

    Returns
    -------
    str
        A recipe of the kind `linkage`, with the linkage where it was drawn.

    Raises
    ------
    FileError
        If the file cannot be read.
    RecipeError
        If it holds something that is not understood, which the message names.
    """
    try:
        with path.open("rb") as opened:
            content = opened.read(LARGEST + 1)
    except OSError as error:
        raise FileError(path, f"cannot be read ({error.strerror})", "give a file", "file-unreadable") from error
    file = str(path)
    if len(content) > LARGEST:
        refuse(file, "", f"it is larger than {LARGEST:,} bytes", "give the file of one linkage", "too-much-work")
    try:
        text = content.decode("utf-8-sig").strip()
    except UnicodeDecodeError:
        refuse(file, "", "it is not UTF-8 text", "save it again", "file-unreadable")
    reader = {"{": pylinkage_json, "<": linkage_xml}.get(text[:1], pmks_link)
    return recipe_of(reader.read(text, file), file)
