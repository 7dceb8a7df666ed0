"""A row of numbers as a short text: how much they change, in few bits each where the change is small."""

from __future__ import annotations

import numpy as np

from ..plane.vec import Mask, Real, Whole, rounded

# Of six bits each, in the order of base 64.
SIGNS = np.frombuffer(b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", dtype=np.uint8)
# How often differences are taken at most: what smooth motion leaves after three times is rounding, which grows with
# each one more.
MOST_TIMES = 3
# The most low bits that every number is told with. More are for numbers that jump about, of which there are few.
MOST_ORDER = 5


def packed(row: Real, decimals: int) -> str:
    """A row (n,), rounded to `decimals`, as a text: "decimals times order runs signs"; or the one number that all is.

    Taken as whole numbers of the last decimal, they are replaced by the differences to the one before, so many times.
    Each difference d is then told as 2 d, or as -2 d - 1 below 0, by the Exp-Golomb code of the order, as in video;
    signs hold these bits, six each, the highest first. runs: how many numbers are known, then how many are nan, in
    turns with commas between; nothing where all are known.
    """
    known = np.isfinite(row)
    exact = rounded(row[known], decimals)
    if known.all() and len(exact) and (exact == exact[0]).all():
        return f"{exact[0]:.12g}"
    whole = np.rint(exact * 10.0**decimals if decimals >= 0 else exact / 10.0**-decimals).astype(np.int64)
    tried = [whole]
    for _ in range(MOST_TIMES):
        tried.append(tried[-1].copy())
        tried[-1][1:] -= tried[-2][:-1]
    folded = np.array([np.where(values < 0, -2 * values - 1, 2 * values) for values in tried])
    times = int(np.argmin(_sizes(folded, 1).sum(axis=1)))
    orders = np.arange(MOST_ORDER + 1)
    order = int(np.argmin(_sizes(folded[times], orders[:, None]).sum(axis=1)))
    runs = "" if known.all() else _runs(known)
    return f"{decimals} {times} {order} {runs} {_signs(folded[times], order)}"


def _sizes(values: Whole, order: Whole | int) -> Whole:
    """Bits that the code of the order takes for each number from 0."""
    exponents: Whole = np.frexp((values + np.left_shift(1, order)).astype(float))[1].astype(np.int64)
    return 2 * exponents - 1 - order


def _signs(values: Whole, order: int) -> str:
    """All numbers in a row: each with the bit of the order added, zeros before it for the bits beyond the order."""
    sizes = _sizes(values, order)
    # A row for each bit: its number, and how many bits of it come after. What stands before a number is zeros.
    after = np.repeat(np.cumsum(sizes), sizes) - np.arange(1, sizes.sum() + 1)
    bits = np.repeat(values + (1 << order), sizes) >> np.minimum(after, 62) & 1
    bits = np.concatenate([bits, np.zeros(-len(bits) % 6, dtype=bits.dtype)])
    return SIGNS[bits.reshape(-1, 6) @ (1 << np.arange(5, -1, -1))].tobytes().decode()


def _runs(known: Mask) -> str:
    """Lengths of runs, the first of known numbers, be it of none."""
    edges = np.flatnonzero(np.diff(known, prepend=True, append=not known[-1]))
    return ",".join(map(str, np.diff(edges, prepend=0)))
