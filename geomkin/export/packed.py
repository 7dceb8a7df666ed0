"""A row of numbers as a short text: how much they change, one sign each where the change is small."""

from __future__ import annotations

from itertools import accumulate

import numpy as np

from ..plane.vec import Real, rounded

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
    whole = [round(value * 10.0**decimals) if decimals >= 0 else round(value / 10.0**-decimals) for value in exact]
    tried = [whole]
    for _ in range(MOST_TIMES):
        tried.append([b - a for a, b in zip([0, *tried[-1]], tried[-1])])
    texts = [[_signs(value) for value in values] for values in tried]
    times = min(range(len(texts)), key=lambda k: sum(map(len, texts[k])))
    signs = iter(texts[times])
    return f"{decimals} {times} {''.join(next(signs) if there else NONE for there in known.tolist())}"


def _signs(value: int) -> str:
    rest, text = 2 * abs(value) + (value < 0), ""
    while rest > 31:
        text += SIGNS[32 + rest % 32]
        rest //= 32
    return text + SIGNS[rest]


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
