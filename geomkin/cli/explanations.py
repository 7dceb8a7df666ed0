"""What is known of each check and of each term of the field, from `explanations.toml`; the site shows the same."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
# The name, meaning, limit and remedy of each check by its id, without the name of a part.
CHECKS: Mapping[str, Mapping[str, str]] = _TABLE["checks"]
# Terms of the field.
TERMS: Mapping[str, str] = _TABLE["terms"]


def check_entry(id: str) -> str | None:
    """The longest key of `CHECKS` in the id of a check, which may have names of parts before or behind it."""
    framed = f"_{id}_"
    return max((key for key in CHECKS if f"_{key}_" in framed), key=len, default=None)


def explained(text: str) -> str | None:
    """Some lines on a check, given by its id, or on a term; None if it is neither."""
    wanted = text.strip()
    lines = [
        f"{term}: {about}" for term, about in TERMS.items() if term.casefold() == wanted.casefold().replace("_", " ")
    ]
    if key := check_entry(wanted.replace(" ", "_")):
        entry = CHECKS[key]
        lines += [
            f"{wanted}: {entry['name']}",
            f"  compared: {entry['meaning']}",
            f"  limit:    {entry['limit']}",
            f"  remedy:   {entry['remedy']}",
        ]
    return "\n".join(lines) or None
