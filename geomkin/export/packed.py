"""A row of numbers as a short text: how much they change, one sign each where the change is small."""

from __future__ import annotations

from itertools import accumulate

import numpy as np

from ..plane.vec import Mask, Real, Whole, rounded

# Of six bits each, in the order of base 64.
SIGNS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
# What stands where there is no number.
NONE = "~"
# How often differences are taken at most: smooth motion leaves a sign for each number after three times, and rounding
# grows with each one more.
MOST_TIMES = 3


def packed(row: Real, decimals: int) -> str:
    """A row (n,), rounded to `decimals`, as a text: `decimals times signs`, or the one number that all of it is.

    Taken as whole numbers of the last decimal, they are replaced by the differences to the one before, so many times;
    each difference, its sign as its lowest bit, is told from the low end in pieces of five bits, of which every one but
    the last has the sixth bit set (as in the base 64 VLQ of source maps). "~" stands for nan.
    """
    known = np.isfinite(row)
    exact = rounded(row[known], decimals)
    if known.all() and len(exact) and (exact == exact[0]).all():
        return f"{exact[0]:.12g}"
    whole = np.rint(exact * 10.0**decimals if decimals >= 0 else exact / 10.0**-decimals).astype(np.int64)
    # Each difference as a whole number from 0, its sign in its lowest bit, and how many signs all of them take.
    tried = [whole]
    for _ in range(MOST_TIMES):
        tried.append(np.diff(tried[-1], prepend=0))
    folded = [2 * np.abs(values) + (values < 0) for values in tried]
    times = int(np.argmin([_pieces(values).sum() for values in folded]))
    return f"{decimals} {times} {_signs(folded[times], known)}"


def _pieces(values: Whole) -> Whole:
    """How many pieces of five bits each number takes."""
    most = int(values.max(initial=0)).bit_length() // 5 + 1
    further: Whole = (values[:, None] >= 32 ** np.arange(1, most, dtype=np.int64)).sum(axis=1)
    return 1 + further


def _signs(values: Whole, known: Mask) -> str:
    """All signs in a row; values: (numbers,), the ones that are known."""
    pieces = _pieces(values)
    place = np.arange(pieces.max(initial=1))
    bits = (values[:, None] >> (5 * place)) & 31
    codes = np.full((len(known), len(place)), ord(NONE), dtype=np.uint8)
    codes[known] = np.frombuffer(SIGNS.encode(), dtype=np.uint8)[bits + 32 * (place < pieces[:, None] - 1)]
    used = np.ones(len(known), dtype=np.intp)
    used[known] = pieces
    return codes[place < used[:, None]].tobytes().decode()


def unpacked(text: str, count: int) -> Real:
    """What `packed` tells of `count` numbers, as the player reads it."""
    if " " not in text:
        return np.full(count, float(text))
    decimals, times, signs = text.split(" ")
    values: list[int] = []
    known: list[bool] = []
    value = shift = 0
    for sign in signs:
        bits = 0 if sign == NONE else SIGNS.index(sign)
        value += (bits % 32) << shift
        shift = shift + 5 if bits > 31 else 0
        if not shift:
            known.append(sign != NONE)
            values += [] if sign == NONE else [-(value // 2) if value % 2 else value // 2]
            value = 0
    for _ in range(int(times)):
        values = list(accumulate(values))
    row = np.full(count, np.nan)
    row[np.array(known)] = [float(f"{value}e{-int(decimals)}") for value in values]
    return row
