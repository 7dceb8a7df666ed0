"""Values of a sweep: ranges and lists as texts, checked values, and all their combinations."""

from __future__ import annotations

import itertools
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, Context, Decimal
from typing import Any

import numpy as np

from ..core.errors import DesignError, printable, shown
from ..core.fields import rounded_up

# Largest number of combinations, with which slow kinds already take hours.
MOST = 10_000
# A range start:stop:step.
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
RANGE = re.compile(rf"\s*({NUMBER})\s*:\s*({NUMBER})\s*:\s*({NUMBER})\s*")
# A dotted key, such as gear.teeth or program[0].rise.
KEY = re.compile(r"[^\W_][\w -]*(?:\[\d{1,6}\])*(?:\.[^\W_][\w -]*(?:\[\d{1,6}\])*)*")
PLAIN = (str, int, float)
# Decimal arithmetic, in which 3 x 0.1 is 0.3, with enough digits for any written step and without overflow.
EXACT = Context(prec=60, traps=[])


def parsed_values(key: str, given: object) -> tuple[Any, ...]:
    """The values of a key, without duplicates, from a text such as `8:120:4` or `-0.5,0,0.5`, or from a sequence."""
    if not isinstance(key, str) or not KEY.fullmatch(key):
        raise DesignError(
            "values", f"found the key {shown(key)}", "give one such as gear.teeth or program[0].rise", "unknown-key"
        )
    if isinstance(given, str):
        values = [value for entry in _split(key, given) for value in _parsed(key, entry)]
    else:
        values = [_checked(key, value) for value in _sequence(key, given)]
    if not values:
        raise DesignError(key, "found no value", "give one or more, such as 8,12 or 8:120:4", "missing-key")
    # 1 and 1.0 are the same value, 1 and true are not.
    return tuple({(isinstance(v, bool), repr(v) if isinstance(v, list) else v): v for v in values}.values())


def combinations(values: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """All combinations; the values of the last key change fastest. DesignError if there are too many."""
    counts = [len(row) for row in values.values()]
    if math.prod(counts) > MOST:
        product = " x ".join(f"{count:,}" for count in counts)
        longest = max(values, key=lambda key: len(values[key]))
        most = MOST * len(values[longest]) // math.prod(counts)
        remedy = f"at most {most:,} values of {longest}" if most else f"values that make at most {MOST:,}"
        raise DesignError(
            "values", f"found {product} = {math.prod(counts):,} combinations", f"give {remedy}", "too-much-work"
        )
    return (dict(zip(values, row)) for row in itertools.product(*values.values()))


def _split(key: str, text: str) -> list[str]:
    """Parts of a text between its commas, except those inside brackets or quotes."""
    parts, depth, quote = [""], 0, ""
    for sign in text:
        quote = (sign if not quote else "" if sign == quote else quote) if sign in "\"'" else quote
        depth += 0 if quote else (sign == "[") - (sign == "]")
        if sign == "," and not quote and not depth:
            parts.append("")
        else:
            parts[-1] += sign
    if any(not part.strip() for part in parts):
        raise DesignError(
            key, f"found {shown(text)}, in which a value is missing", "give a value between two commas", "wrong-type"
        )
    return parts


def _parsed(key: str, entry: str) -> list[Any]:
    """The values of one entry: those of a range, a TOML value, or the entry itself as a text."""
    if (match := RANGE.fullmatch(entry)) is not None:
        return _range(key, entry, *(Decimal(number) for number in match.groups()))
    try:
        table = tomllib.loads(f"value = {entry.strip()}\n")
    except (ValueError, RecursionError):
        table = {}
    return [_checked(key, table["value"] if set(table) == {"value"} else entry.strip())]


def _range(key: str, text: str, start: Decimal, stop: Decimal, step: Decimal) -> list[float | int]:
    """Values from start in steps; the stop is included if a step meets it."""
    steps = EXACT.divide(EXACT.subtract(stop, start), step)
    if not steps.is_finite() or steps < 0:
        raise DesignError(
            key, f"found {shown(text.strip())}", "give start:stop:step, the step towards the stop", "wrong-type"
        )
    if steps >= MOST:
        least = Context(3, ROUND_CEILING, traps=[]).divide(abs(EXACT.subtract(stop, start)), Decimal(MOST - 1))
        problem = f"found {shown(text.strip())}, which is more than {MOST:,} values"
        raise DesignError(key, problem, f"give a step of at least {rounded_up(float(least), 3)}", "too-much-work")
    whole = all(part == part.to_integral_value() for part in (start, step)) and max(abs(start), abs(stop)) < 2**53
    values = [EXACT.add(start, EXACT.multiply(step, Decimal(k))) for k in range(int(steps) + 1)]
    return [int(value) if whole else float(value) for value in values]


def _sequence(key: str, given: object) -> list[Any]:
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if not isinstance(given, (list, tuple, range)):
        raise DesignError(
            "values", f"found {shown(given)} for {printable(key)}", "give a list of values, or a text", "wrong-type"
        )
    if len(given) > MOST:
        raise DesignError(key, f"found {len(given):,} values", f"give at most {MOST:,}", "too-much-work")
    return list(given)


def _checked(key: str, value: Any) -> Any:
    """The value, if TOML can write it: a number, a text, true or false, or a list of these; otherwise DesignError."""
    value = value.item() if isinstance(value, np.generic) else value
    value = [value.real, value.imag] if isinstance(value, complex) else value
    if isinstance(value, (list, tuple)) and len(value) <= MOST:
        return [_checked(key, item) for item in value]
    if not isinstance(value, PLAIN) or (isinstance(value, float) and not math.isfinite(value)):
        raise DesignError(
            key, f"found {shown(value)}", "give finite numbers, texts, true or false, or points [x, y]", "wrong-type"
        )
    if isinstance(value, int) and abs(value) > 2**63:
        raise DesignError(key, f"found {shown(value)}", "give a smaller number", "out-of-range")
    return value
