"""Programs as a table of steps that one compiled loop executes, for any linkage: frames in blocks, values in rows.

The loop knows nothing of linkages: it executes the same operations as NumPy, from the same tape. Its compilation takes
some seconds; numba caches it on disk, from where it loads in half a second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import prod
from typing import Any

import numba
import numpy as np
from numba.core import types
from numba.extending import intrinsic

from ...plane.vec import Array
from .program import TapeProgram, base, shared
from .tape import VIEWS, Operation, Tape, chosen_from, imag_part, larger, paired

# Frames, or linkages, in a block. With more the rows leave the cache; with fewer dispatching a step takes too long.
WIDTH = 128

# The tables of inputs, and the number of rows of a value of each kind in the output.
NUMBERS, OUTER, INNER, BOTH = range(4)
WIDTHS = {float: 1, complex: 2, bool: 0}

# Codes of the loop's operations on rows of real numbers.
MULTIPLY, ADD, SUBTRACT, DIVIDE, ROOT, NEGATIVE, ABSOLUTE, COSINE, SINE, ANGLE, SIGNED, LEAST, LARGER, LESS = range(14)
AT_MOST, FINITE, CHOSEN, COPY, CROSSWISE, ALONG, LENGTH, QUOTIENT, CIRCLE = range(14, 23)
# A step: its code, the row it writes, the rows it reads. The table gives the steps of an operation for the rows of its
# result and arguments. A complex number has two rows, the real part first.
Steps = list[tuple[int, ...]]
ON_ROWS: dict[tuple[Operation, str], Callable[..., Steps]] = {
    (np.multiply, "ff"): lambda o, a, b: [(MULTIPLY, o, a, b)],
    (np.add, "ff"): lambda o, a, b: [(ADD, o, a, b)],
    (np.subtract, "ff"): lambda o, a, b: [(SUBTRACT, o, a, b)],
    (np.divide, "ff"): lambda o, a, b: [(DIVIDE, o, a, b)],
    (np.sqrt, "f"): lambda o, a: [(ROOT, o, a)],
    (np.square, "f"): lambda o, a: [(MULTIPLY, o, a, a)],
    (np.negative, "f"): lambda o, a: [(NEGATIVE, o, a)],
    (np.positive, "f"): lambda o, a: [(COPY, o, a)],
    (np.absolute, "f"): lambda o, a: [(ABSOLUTE, o, a)],
    (np.cos, "f"): lambda o, a: [(COSINE, o, a)],
    (np.sin, "f"): lambda o, a: [(SINE, o, a)],
    (np.arctan2, "ff"): lambda o, a, b: [(ANGLE, o, a, b)],
    (np.copysign, "ff"): lambda o, a, b: [(SIGNED, o, a, b)],
    (np.fmin, "ff"): lambda o, a, b: [(LEAST, o, a, b)],
    (larger, "ff"): lambda o, a, b: [(LARGER, o, a, b)],
    (np.less, "ff"): lambda o, a, b: [(LESS, o, a, b)],
    (np.greater, "ff"): lambda o, a, b: [(LESS, o, b, a)],
    (np.less_equal, "ff"): lambda o, a, b: [(AT_MOST, o, a, b)],
    (np.greater_equal, "ff"): lambda o, a, b: [(AT_MOST, o, b, a)],
    (np.isfinite, "f"): lambda o, a: [(FINITE, o, a, a)],
    (np.isfinite, "c"): lambda o, a: [(FINITE, o, a, a + 1)],
    (np.logical_and, "bb"): lambda o, a, b: [(MULTIPLY, o, a, b)],
    (chosen_from, "bff"): lambda o, a, b, c: [(CHOSEN, o, a, b, c)],
    (chosen_from, "bcc"): lambda o, a, b, c: [(CHOSEN, o, a, b, c), (CHOSEN, o + 1, a, b + 1, c + 1)],
    (paired, "ff"): lambda o, a, b: [(COPY, o, a), (COPY, o + 1, b)],
    (np.multiply, "cc"): lambda o, a, b: [(CROSSWISE, o, a, b, a + 1, b + 1), (ALONG, o + 1, a, b + 1, a + 1, b)],
    (np.multiply, "cf"): lambda o, a, b: [(MULTIPLY, o, a, b), (MULTIPLY, o + 1, a + 1, b)],
    (np.multiply, "fc"): lambda o, a, b: [(MULTIPLY, o, a, b), (MULTIPLY, o + 1, a, b + 1)],
    (np.add, "cc"): lambda o, a, b: [(ADD, o, a, b), (ADD, o + 1, a + 1, b + 1)],
    (np.add, "cf"): lambda o, a, b: [(ADD, o, a, b), (COPY, o + 1, a + 1)],
    (np.add, "fc"): lambda o, a, b: [(ADD, o, a, b), (COPY, o + 1, b + 1)],
    (np.subtract, "cc"): lambda o, a, b: [(SUBTRACT, o, a, b), (SUBTRACT, o + 1, a + 1, b + 1)],
    (np.subtract, "cf"): lambda o, a, b: [(SUBTRACT, o, a, b), (COPY, o + 1, a + 1)],
    (np.divide, "cf"): lambda o, a, b: [(DIVIDE, o, a, b), (DIVIDE, o + 1, a + 1, b)],
    (np.divide, "cc"): lambda o, a, b: [(QUOTIENT, o, a, b)],
    (np.absolute, "c"): lambda o, a: [(LENGTH, o, a, a + 1)],
    (np.conjugate, "c"): lambda o, a: [(COPY, o, a), (NEGATIVE, o + 1, a + 1)],
    (np.negative, "c"): lambda o, a: [(NEGATIVE, o, a), (NEGATIVE, o + 1, a + 1)],
    (np.positive, "c"): lambda o, a: [(COPY, o, a), (COPY, o + 1, a + 1)],
}

# The angle whose tangent is s, between -pi/8 and pi/8, is s + s^3 times this polynomial in s^2, highest power first, to
# a relative 4e-17. Derived here, by Remez' exchange.
POLYNOMIAL = (
    0.02127852419713506, -0.043606945728317824, 0.056931200549258626, -0.0664123782061731, 0.07690082402655676,
    -0.09090783462693137, 0.11111106700816628, -0.14285714196462654, 0.19999999999103937, -0.3333333333333022,
)  # fmt: skip
# tan(pi/8), beyond which the angle is computed from its difference to pi/4. pi/4 as a double, and its rounding error,
# without which angles near pi/2 lose a unit in the last place.
FAR, EIGHTH, BEYOND = 0.41421356, math.pi / 4, 3.061616997868383e-17


@numba.njit(cache=True, error_model="numpy")
def _angle(y, x):  # type: ignore[no-untyped-def]
    """atan2 to three units in the last place, ten times faster: without a call it can be vectorised."""
    along, across = abs(x), abs(y)
    low, high = (across, along) if across <= along else (along, across)
    far = low > FAR * high or low == np.inf
    s = (low - high if far else low) / (low + high if far else high)
    s = 0.0 if low == high else s
    rest = POLYNOMIAL[0]
    for coefficient in POLYNOMIAL[1:]:
        rest = coefficient + s * s * rest
    angle, eighths = s + s * (s * s * rest), 1.0 if far else 0.0
    if across > along:
        angle, eighths = -angle, 2.0 - eighths
    if math.copysign(1.0, x) < 0:
        angle, eighths = -angle, 4.0 - eighths
    return math.copysign(eighths * EIGHTH + (angle + eighths * BEYOND), y)


@intrinsic
def _number_at(_, address):  # type: ignore[no-untyped-def]
    """The number at an address: programs differ in the number of input arrays, which no compiled signature allows."""

    def load(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.load(builder.inttoptr(arguments[0], context.get_value_type(types.float64).as_pointer()))

    return types.float64(types.int64), load


@numba.njit(cache=True, error_model="numpy")
def _run(steps, rows, numbers, outer, inner, both, out, flags, stores, repeats, length):  # type: ignore[no-untyped-def]
    """Steps (steps, 6): code, row written, rows read. For many linkages frames repeat, and `length` is their number.

    Rows hold first numbers (rows,), outer (rows, repeats), inner (rows, length) and both (rows, 2): address and stride
    of repeats * length numbers. stores (rows, 3): a row, its start in `out` and its stride; stride 0 for flags.
    """
    w = np.empty((rows, WIDTH))
    for k in range(len(numbers)):
        w[k, :] = numbers[k]
    first_outer = len(numbers)
    first_inner = first_outer + len(outer)
    first_both = first_inner + len(inner)
    for start in range(0, length, WIDTH):
        n = min(WIDTH, length - start)
        for k in range(len(inner)):
            w[first_inner + k, :n] = inner[k, start : start + n]
        for repeat in range(repeats):
            at = repeat * length + start
            for k in range(len(outer)):
                w[first_outer + k, :n] = outer[k, repeat]
            for k in range(len(both)):
                begin, step = both[k, 0] + at * both[k, 1], both[k, 1]
                for j in range(n):
                    w[first_both + k, j] = _number_at(begin + j * step)
            for s in range(len(steps)):
                code, o, a, b, c, d = steps[s, 0], steps[s, 1], steps[s, 2], steps[s, 3], steps[s, 4], steps[s, 5]
                if code == MULTIPLY:
                    for j in range(n):
                        w[o, j] = w[a, j] * w[b, j]
                elif code == ADD:
                    for j in range(n):
                        w[o, j] = w[a, j] + w[b, j]
                elif code == SUBTRACT:
                    for j in range(n):
                        w[o, j] = w[a, j] - w[b, j]
                elif code == DIVIDE:
                    for j in range(n):
                        w[o, j] = w[a, j] / w[b, j]
                elif code == CROSSWISE:
                    for j in range(n):
                        w[o, j] = w[a, j] * w[b, j] - w[c, j] * w[d, j]
                elif code == ALONG:
                    for j in range(n):
                        w[o, j] = w[a, j] * w[b, j] + w[c, j] * w[d, j]
                elif code == COPY:
                    for j in range(n):
                        w[o, j] = w[a, j]
                elif code == ROOT:
                    for j in range(n):
                        w[o, j] = math.sqrt(w[a, j])
                elif code == NEGATIVE:
                    for j in range(n):
                        w[o, j] = -w[a, j]
                elif code == ABSOLUTE:
                    for j in range(n):
                        w[o, j] = abs(w[a, j])
                elif code == COSINE:
                    for j in range(n):
                        w[o, j] = math.cos(w[a, j])
                elif code == SINE:
                    for j in range(n):
                        w[o, j] = math.sin(w[a, j])
                elif code == CIRCLE:
                    # Cosine and sine of the same angle are one call, in three fifths of the time.
                    for j in range(n):
                        x = w[b, j]
                        w[o, j], w[a, j] = math.cos(x), math.sin(x)
                elif code == ANGLE:
                    for j in range(n):
                        w[o, j] = _angle(w[a, j], w[b, j])
                elif code == SIGNED:
                    for j in range(n):
                        w[o, j] = math.copysign(w[a, j], w[b, j])
                elif code == LEAST:
                    for j in range(n):
                        x, y = w[a, j], w[b, j]
                        w[o, j] = x if x <= y or y != y else y
                elif code == LARGER:
                    for j in range(n):
                        x, y = w[a, j], w[b, j]
                        w[o, j] = x if x >= y or x != x else y
                elif code == LESS:
                    for j in range(n):
                        w[o, j] = 1.0 if w[a, j] < w[b, j] else 0.0
                elif code == AT_MOST:
                    for j in range(n):
                        w[o, j] = 1.0 if w[a, j] <= w[b, j] else 0.0
                elif code == FINITE:
                    for j in range(n):
                        w[o, j] = 1.0 if abs(w[a, j]) < np.inf and abs(w[b, j]) < np.inf else 0.0
                elif code == CHOSEN:
                    for j in range(n):
                        w[o, j] = w[b, j] if w[a, j] != 0.0 else w[c, j]
                elif code == LENGTH:
                    for j in range(n):
                        w[o, j] = math.hypot(w[a, j], w[b, j])
                elif code == QUOTIENT:
                    # Scaled by the larger part of the divisor, so that no square overflows.
                    for j in range(n):
                        x, y, u, v = w[a, j], w[a + 1, j], w[b, j], w[b + 1, j]
                        if abs(u) >= abs(v):
                            share = v / u
                            scale = 1.0 / (u + v * share)
                            w[o, j], w[o + 1, j] = (x + y * share) * scale, (y - x * share) * scale
                        else:
                            share = u / v
                            scale = 1.0 / (v + u * share)
                            w[o, j], w[o + 1, j] = (x * share + y) * scale, (y * share - x) * scale
            for k in range(len(stores)):
                row, stride = stores[k, 0], stores[k, 2]
                begin = stores[k, 1] + at * stride
                if stride == 0:
                    for j in range(n):
                        flags[begin + at + j] = w[row, j] != 0.0
                else:
                    for j in range(n):
                        out[begin + j * stride] = w[row, j]


def runs(program: TapeProgram) -> bool:
    """Whether the loop has all operations of a program."""
    tape = program.tape
    return all((tape.steps[n].operation, _kinds(tape, n)) in ON_ROWS for n in program.made)


def run(program: TapeProgram, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
    """Like `TapeProgram.run`."""
    count = prod(linkages)
    if count > 1:
        # Values that are equal for all linkages are evaluated once per frame, by NumPy.
        if "common" not in program.prepared:
            program.prepared["common"] = _split(program)
        common, program = program.prepared["common"]
        common.run(values, frames, linkages)
    constants = program.tape.constants
    given = [constants[n] if n in constants else values[n] for n in (*program.fixed, *program.given)]
    places = tuple([_place(array, frames, count) for array in given])
    if places not in program.prepared:
        program.prepared[places] = _table(program, places)
    steps, rows, complexes, kept_rows = program.prepared[places]
    tables: list[list[Any]] = [[], [], [], []]
    # Referenced until the loop ends, since it gets only their addresses.
    flat = [
        np.ascontiguousarray(array, complex if parted else float).reshape(-1) for array, parted in zip(given, complexes)
    ]
    for row, place, parted in zip(flat, places, complexes):
        if place == BOTH:
            tables[BOTH] += [(row.ctypes.data + 8 * part, row.itemsize) for part in range(1 + parted)]
        else:
            tables[place] += [row.real, row.imag] if parted else [row]
    numbers, outer, inner = (
        np.array(table, dtype=float).reshape(len(table), count) for table, count in zip(tables, (1, frames, count))
    )
    size, stores = frames * count, []
    widths = [WIDTHS[program.tape.steps[n].kind] for n in program.kept]
    out, flags = np.empty(size * sum(widths)), np.empty(size * widths.count(0), dtype=np.bool_)
    at = marks = 0
    for n, row, width in zip(program.kept, kept_rows, widths):
        if width:
            stores += [(row + part, at + part, width) for part in range(width)]
            kept: Array = out[at : at + width * size]
            at += width * size
        else:
            stores.append((row, marks, 0))
            kept = flags[marks : marks + size]
            marks += size
        values[n] = (kept.view(complex) if width == 2 else kept).reshape(frames, *linkages)
    arrays = [np.array(t, dtype=np.int64).reshape(-1, columns) for t, columns in ((tables[BOTH], 2), (stores, 3))]
    repeats, length = (1, frames) if count == 1 else (frames, count)
    _run(steps, rows, numbers[:, 0], outer, inner, arrays[0], out, flags, arrays[1], repeats, length)


def _split(program: TapeProgram) -> tuple[TapeProgram, TapeProgram]:
    """The steps that are equal for all linkages, and the others."""
    tape = program.tape
    varying = [n for n in program.steps if tape.steps[n].extent == 2]
    common = [n for n in program.steps if tape.steps[n].extent < 2]
    used = {base(tape, argument) for n in varying for argument in tape.steps[n].of}.union(program.kept)
    return TapeProgram.of(tape, common, used.intersection(common)), TapeProgram.of(
        tape, varying, set(program.kept).intersection(varying)
    )


def _kinds(tape: Tape, number: int) -> str:
    return "".join(
        {float: "f", complex: "c", bool: "b"}[tape.steps[argument].kind] for argument in tape.steps[number].of
    )


def _place(array: Array, frames: int, many: int) -> int:
    """The table for an input array."""
    if array.size == 1:
        return NUMBERS
    if array.size == frames * many and len(array) == frames:
        return BOTH
    return OUTER if array.ndim > 1 else INNER


def _table(program: TapeProgram, places: tuple[int, ...]) -> tuple[Any, int, list[bool], list[int]]:
    """The steps with their rows, the number of rows, which inputs are complex, and the rows of the kept results.

    places: the tables of the inputs.
    """
    tape, first_row, count = program.tape, {}, 0
    given = [*program.fixed, *program.given]
    ordered = [n for table in range(4) for n, place in zip(given, places) if place == table]
    for n in (*ordered, *program.kept):
        first_row[n] = count
        count += 2 if tape.steps[n].kind is complex else 1
    arrays, holding = shared(tape, program.steps, first_row)
    starts = np.cumsum([count, *(2 if letter == "D" else 1 for letter, _ in arrays)]).tolist()
    first_row |= {n: starts[array] for n, array in holding.items()}

    def row_of(number: int) -> int:
        step = tape.steps[number]
        return row_of(step.of[0]) + (step.operation is imag_part) if step.operation in VIEWS else first_row[number]

    coded: Steps = []
    for n in program.made:
        step = tape.steps[n]
        coded += ON_ROWS[step.operation, _kinds(tape, n)](row_of(n), *map(row_of, step.of))
        if len(coded) > 1 and [code for code, *_ in coded[-2:]] == [COSINE, SINE] and coded[-2][2] == coded[-1][2]:
            (_, cosine, of), (_, sine, _) = coded[-2:]
            coded[-2:] = [(CIRCLE, cosine, sine, of)]
    steps = np.zeros((len(coded), 6), dtype=np.int64)
    for k, step_codes in enumerate(coded):
        steps[k, : len(step_codes)] = step_codes
    return steps, starts[-1], [tape.steps[n].kind is complex for n in given], [first_row[n] for n in program.kept]
