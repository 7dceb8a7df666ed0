"""Symmetric equations whose unknowns meet near ones only, on a line or round a ring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Array

# Neighbours to either side that an unknown meets: those of a quintic spline.
BAND = 5


@dataclass(frozen=True, eq=False)
class BandMatrix:
    """bands (BAND + 1, n): entry (i + k) mod n, i at [k, i]. free (n,): unknowns that are; the others stay 0."""

    bands: Array
    free: Array

    @classmethod
    def of(cls, numbers: Array, basis: Array, weights: Array, size: int, free: Array) -> BandMatrix:
        """Sum of weighted squares of rows; rows of neighbouring unknowns: numbers, basis (BAND + 1, rows)."""
        bands = np.zeros((BAND + 1, size))
        for one in range(BAND + 1):
            for other in range(one, BAND + 1):
                bands[other - one] += np.bincount(numbers[one], basis[one] * basis[other] * weights, size)
        return cls(bands, free)

    def plus(self, other: BandMatrix) -> BandMatrix:
        return BandMatrix(self.bands + other.bands, self.free)

    def solve(self, right: Array) -> Array:
        """x with the matrix times x = right (n,): by Gauss, without pivots, which positive equations do not need.

        nan where rounding leaves them not positive.

        Plain numbers one by one: for bands as narrow as these that takes no longer than calls for arrays.
        """
        n = len(right)
        bands = np.where(self.free, self.bands, 0.0)
        for k in range(1, BAND + 1):
            bands[k] *= np.roll(self.free, -k)
        bands[0, ~self.free] = 1.0
        # Round a ring, all but the last unknowns are a line, both of whose ends meet those: its border.
        edge = BAND if bands[1, -1] else 0
        line = n - edge
        rows = [[*row, *[0.0] * edge] for row in bands.T.tolist()]
        for i in range(line - BAND, n) if edge else ():
            for k in range(BAND + 1):
                one, other = sorted([i, (i + k) % n])
                if one < line <= other:
                    rows[one][BAND + 1 + other - line], rows[i][k] = rows[i][k], 0.0
        border = [[rows[one + line][other - one] if other >= one else 0.0 for other in range(edge)]
                  for one in range(edge)]  # fmt: skip
        v = np.where(self.free, right, 0.0).tolist()
        for i in range(line):
            row = rows[i]
            if not row[0] > 0:
                return np.full(n, np.nan)
            for k in range(1, min(BAND, line - 1 - i) + 1):
                if row[k]:
                    share, below = row[k] / row[0], rows[i + k]
                    for j in range(k, BAND + 1):
                        below[j - k] -= share * row[j]
                    for j in range(BAND + 1, BAND + 1 + edge):
                        below[j] -= share * row[j]
                    v[i + k] -= share * v[i]
            for k in range(edge):
                share = row[BAND + 1 + k] / row[0]
                for j in range(k, edge):
                    border[k][j] -= share * row[BAND + 1 + j]
                v[line + k] -= share * v[i]
        for k in range(edge):
            if not border[k][k] > 0:
                return np.full(n, np.nan)
            for under in range(k + 1, edge):
                share = border[k][under] / border[k][k]
                for j in range(under, edge):
                    border[under][j] -= share * border[k][j]
                v[line + under] -= share * v[line + k]
        for k in reversed(range(edge)):
            for j in range(k + 1, edge):
                v[line + k] -= border[k][j] * v[line + j]
            v[line + k] /= border[k][k]
        for i in reversed(range(line)):
            total = v[i]
            for k in range(1, min(BAND, line - 1 - i) + 1):
                total -= rows[i][k] * v[i + k]
            for k in range(edge):
                total -= rows[i][BAND + 1 + k] * v[line + k]
            v[i] = total / rows[i][0]
        return np.array(v)
