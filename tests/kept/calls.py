"""The net's second half: calls of the library that no recipe makes, or makes only in one way, and what they gave.

The calls stand in `calls.toml`, things by name first; what each gave stands in `calls.json`: of an array its sizes, of a
curve its points, velocities and curvatures, of whatever else is public its fields and properties, of a refused call the
whole message. What such a net is for, `net.py` says. A change that is meant is written down with

    python -m tests.kept.calls
"""

import dataclasses
import functools
import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

import geomkin as gk
from tests.kept import net

HERE = Path(__file__).parent
# How deep in a result things are told of: a motion's bodies and what they do.
DEPTH = 3
# Places of a curve that are looked at, between all its breaks, their ends among them.
SHARES = np.array([0, 0.13, 0.41, 0.77, 1])
# Rounding of what would be 0: a number this small tells nothing.
NOTHING = 1e-11


def calls():
    """Text of every call."""
    return [call for room in _held()["calls"].values() for call in room]


def kept():
    return json.loads((HERE / "calls.json").read_text("utf-8"))


@functools.cache
def _held():
    return tomllib.loads((HERE / "calls.toml").read_text("utf-8"))


class Things(dict):
    """The things by name, each made when it is first asked for."""

    def __missing__(self, name):
        if name not in _held()["things"]:
            raise KeyError(name)
        self[name] = eval(_held()["things"][name], self)
        return self[name]


THINGS = Things({"gk": gk, "np": np})


def outcome(call):
    """{label: list of texts and numbers} of what a call gives."""
    try:
        with np.errstate(all="ignore"):
            value = eval(call, THINGS)
    except gk.GeomkinError as error:
        return {"refused": [type(error).__name__, str(error)]}
    with np.errstate(all="ignore"):
        return dict(told("", value, DEPTH))


def told(label, value, depth):
    """(label, row) for everything in a value."""
    if value is None or isinstance(value, bool | str | np.bool_):
        yield label, [value if value is None or isinstance(value, str) else bool(value)]
    elif isinstance(value, int | float | complex | np.number):
        parts = [value.real, value.imag] if isinstance(value, complex | np.complexfloating) else [value]
        yield label, [_small(part) for part in parts]
    elif isinstance(value, np.ndarray):
        yield label, of_array(value)
    elif isinstance(value, gk.AbstractCurve):
        yield from _of_curve(label, value)
        yield from _of_members(label, value, depth, set(dir(gk.AbstractCurve)))
    elif isinstance(value, Mapping):
        yield f"{label}#", [len(value)]
        for key, held in value.items():
            yield from told(f"{label}[{key}]", held, depth - 1)
    elif isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        yield f"{label}#", [len(value)]
        for k, held in enumerate(value):
            yield from told(f"{label}[{k}]", held, depth - 1)
    elif hasattr(value, "_fields") or type(value).__module__.startswith("geomkin"):
        yield from _of_members(label, value, depth, set())


def _small(value):
    return 0.0 if abs(value) < NOTHING else net.number(float(value))


def of_array(value):
    flat = value.ravel()
    if value.dtype.kind not in "fc":
        return [*value.shape, *(flat.astype(str).tolist()[:60])]
    parts = [flat.real, flat.imag] if value.dtype.kind == "c" else [flat]
    return [*value.shape, *(part for one in parts for part in net.sizes(np.where(np.abs(one) < NOTHING, 0, one)))]


def _of_curve(label, curve):
    b = np.asarray(curve.breaks, dtype=float)[:40]
    t = np.unique((b[:-1, None] + np.diff(b)[:, None] * SHARES).ravel())
    yield f"{label} breaks", [*of_array(np.asarray(curve.breaks)), curve.closed]
    yield f"{label} point", of_array(curve.point(t))
    yield f"{label} velocity", of_array(curve.velocity(t))
    # Where pieces meet, rounding decides on whose side a place is.
    inner = (b[:-1, None] + np.diff(b)[:, None] * SHARES[1:-1]).ravel()
    yield f"{label} curvature", of_array(gk.curvature(curve, inner))


def _of_members(label, value, depth, left_out):
    if depth <= 0:
        return
    names = list(getattr(value, "_fields", ()))
    if dataclasses.is_dataclass(value):
        names += [field.name for field in dataclasses.fields(value)]
    for held in type(value).__mro__:
        names += [k for k, v in vars(held).items() if isinstance(v, property | functools.cached_property)]
    # How a motion is found is the library's own affair, and what it keeps for that depends on the calls before.
    for name in sorted(
        {name for name in names if not name.startswith("_")} - left_out - {"solution", "plans", "formulas"}
    ):
        try:
            member = getattr(value, name)
        except gk.GeomkinError as error:
            yield f"{label}.{name}", [str(error)]
        else:
            yield from told(f"{label}.{name}", member, depth - 1)


def differences(old, new):
    """Lines that say what is no longer as it was kept; what a result has besides is new, and changes nothing."""
    yield from net.differences({".call": old}, {".call": {label: row for label, row in new.items() if label in old}})


def main():
    before = kept() if (HERE / "calls.json").exists() else {}
    found = {}
    for call in calls():
        found[call] = json.loads(json.dumps(outcome(call)))
        for line in differences(before.get(call, {}), found[call]):
            print(f"{call}: {re.sub('^[.]call ?', '', line)}")
    lines = []
    for call, rows in found.items():
        inside = ",\n".join(
            f"  {json.dumps(label, ensure_ascii=False)}: {json.dumps(row, ensure_ascii=False)}"
            for label, row in rows.items()
        )
        lines.append(f" {json.dumps(call, ensure_ascii=False)}: {{\n{inside}\n }}")
    (HERE / "calls.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


if __name__ == "__main__":
    main()
