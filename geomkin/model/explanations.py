"""What is known of each check, refusal and term of the field, from `explanations.toml`; the site shows the same."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
# The name, meaning, limit and remedy of each check by its id, without the name of a part.
CHECKS: Mapping[str, Mapping[str, str]] = _TABLE["checks"]
# Reasons for which a recipe is refused, by the id of the problem.
REFUSALS: Mapping[str, str] = _TABLE["refusals"]
# Terms of the field.
TERMS: Mapping[str, str] = _TABLE["terms"]


def check_entry(id: str) -> str | None:
    """The longest key of `CHECKS` in the id of a check, which may have names of parts before or behind it."""
    framed = f"_{id}_"
    return max((key for key in CHECKS if f"_{key}_" in framed), key=len, default=None)


def explained_check(id: str) -> dict[str, str]:
    """What a check compares, the source of its limit and the remedy, by these words; empty if nothing is known."""
    entry = CHECKS.get(check_entry(id) or "")
    return {"compared": entry["meaning"], "limit": entry["limit"], "remedy": entry["remedy"]} if entry else {}


def explained(text: str) -> str | None:
    """Some lines on a check or a refusal, given by its id, or on a term; None if it is none of these."""
    wanted = text.strip()
    lines = [
        f"{term}: {about}" for term, about in TERMS.items() if term.casefold() == wanted.casefold().replace("_", " ")
    ]
    if about := REFUSALS.get(wanted):
        lines.append(f"{wanted}: {about}")
    id = wanted.replace(" ", "_")
    if key := check_entry(id):
        lines.append(f"{wanted}: {CHECKS[key]['name']}")
        lines += [f"  {word + ':':9} {about}" for word, about in explained_check(id).items()]
    return "\n".join(lines) or None


def named_like(text: str) -> list[str]:
    """Ids and terms with a text in their names; if there are none, those whose explanations have it."""
    wanted = text.strip().casefold()
    abouts = {**TERMS, **{id: entry["meaning"] for id, entry in CHECKS.items()}, **REFUSALS}
    named = [name for name in abouts if wanted in name.casefold().replace("_", " ")]
    return named or [name for name, about in abouts.items() if wanted in about.casefold()]
