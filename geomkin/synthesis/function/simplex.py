"""Many small linear programmes at once."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Real, Whole

# A rate below which a row counts as not approached. Larger, and rows are passed through; smaller, and a row that is
# nearly a sum of those that hold already makes a corner that rounding alone decides.
FLAT = 1e-8
# Price, of a cost of 1, below which a row counts as holding. Smaller, and rounding alone sets rows free.
PRICELESS = 1e-11


def least(cost: Real, rows: Real, bounds: Real, corner: Whole, steps: int = 100) -> tuple[Real, Real]:
    """Minimises cost x where rows x <= bounds, for each of many programmes; from a corner that is allowed.

    cost: (n,); rows: (many, m, n); bounds: (many, m); corner: (many, n), the rows that hold at the start. Gives x
    (many, n) and what each row costs (many, m), 0 and more: cost + prices rows = 0. Walks from corner to corner along
    the edge of the worst price (the primal simplex method: Dantzig, 1947, on the rows themselves); after so many steps
    the corner reached is given, which is allowed though it may not be the best.
    """
    many, m, _ = rows.shape
    each = np.arange(many)
    corner = corner.copy()
    inverse = np.linalg.inv(rows[each[:, None], corner])
    x = np.einsum("kij,kj->ki", inverse, bounds[each[:, None], corner])
    busy = np.ones(many, bool)
    for _ in range(steps):
        prices = -(cost @ inverse)
        worst = np.argmin(prices, axis=1)
        busy &= prices[each, worst] < -PRICELESS
        if not busy.any():
            break
        way = -inverse[each, :, worst]
        rate = np.einsum("kmn,kn->km", rows, way)
        room = np.maximum(bounds - np.einsum("kmn,kn->km", rows, x), 0.0)
        np.put_along_axis(rate, corner, 0.0, axis=1)
        scale = np.abs(way).max(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(rate > FLAT * scale[:, None], room / rate, np.inf)
        met = np.argmin(step, axis=1)
        busy &= np.isfinite(step[each, met])
        go = each[busy]
        x[go] += step[go, met[go], None] * way[go]
        # The new row in the place of the one that is left.
        seen = np.einsum("kn,knj->kj", rows[go, met[go]], inverse[go])
        column = inverse[go, :, worst[go]] / seen[np.arange(len(go)), worst[go], None]
        seen[np.arange(len(go)), worst[go]] = 0.0
        inverse[go] -= column[:, :, None] * seen[:, None, :]
        inverse[go, :, worst[go]] = column
        corner[go, worst[go]] = met[go]
    try:
        inverse = np.linalg.inv(rows[each[:, None], corner])
        x = np.einsum("kij,kj->ki", inverse, bounds[each[:, None], corner])
    except np.linalg.LinAlgError:
        # Rows of one corner that rounding alone tells apart: what was reached is good, but for its last digits.
        pass
    prices = np.zeros((many, m))
    np.put_along_axis(prices, corner, np.maximum(-(cost @ inverse), 0.0), axis=1)
    return x, prices
