"""The real points that two conics have in common, many pairs of conics at once."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Array, Complex, Mask, Real, Whole

# Newton's steps: from a root of the quartic two or three are enough; a double root halves its error a step.
STEPS = 12
# The same of complex points, to tell which of them are real. Fewer, and one that is counts as none; more cost time.
FIRST_STEPS = 2
# Imaginary share of a complex point up to which its real part is tried: two real points that nearly meet come out of
# the quartic as such a pair. Smaller, and they are missed; larger costs time.
NEARLY_REAL = 0.02
# What both conics, their largest coefficients about 1, may be at a point in common. Smaller, and rounding loses true
# ones; larger, and complex pairs close by are taken for one real point that is met twice.
MET = 1e-13
# Distance, on the unit sphere, below which two points are one. Two that nearly meet are known to the root of rounding
# alone. Larger, and they are taken for one; smaller, and one is told twice.
ONE = 3e-8
# Determinant of conics below which each may be two lines, and what both are along a line that they share. Larger, and
# true points close together are lost; smaller, and four points of a shared line stand for all of them.
TWO_LINES, SHARED = 1e-9, 1e-11
# How much more slowly both conics change one way than the other where they nearly touch. Smaller, and one of the two
# points that lie close together is missed; larger costs time.
TOUCHING = 1e-2


def common_points(pair: Real) -> tuple[Real, Mask]:
    """Points (n, 4, 3) of the projective plane, unit vectors up to sign, and which of them there are, (n, 4).

    pair: (n, 2, 3, 3) symmetric matrices of the conics. Bezout: four at most, unless they share a line: then two
    of its points, and the one that they have off it. The quartic of one unknown is solved as the eigenvalues of its
    companion, then all is polished by Newton's steps: complex points as such, then their real parts, both ways where
    the conics nearly touch. Derived here.
    """
    size = np.abs(pair).max(axis=(1, 2, 3), keepdims=True)
    # A pair as good as the given one, whose members are of one size and least alike.
    flat = pair.reshape(len(pair), 2, 9) / np.where(size == 0, 1, size)[..., 0]
    parts = np.linalg.svd(flat, full_matrices=False)[2].reshape(-1, 2, 3, 3)
    starts, _ = _polished(parts, _roots(parts), FIRST_STEPS)
    # Of a complex point, the phase at which its imaginary part is least.
    starts = starts * np.exp(-0.5j * np.angle(np.vecdot(np.conj(starts), starts)))[..., None]
    near = _size(starts.imag)[..., 0] < NEARLY_REAL
    which: Whole = np.nonzero(near)[0]
    tried = starts.real[near]
    which, tried = _both_ways(parts, which, tried / _size(tried))
    found, off = (each[:, 0] for each in _polished(parts[which], tried[:, None], STEPS))
    points, there = _gathered(len(pair), which, found, off)
    for k in np.nonzero((np.abs(np.linalg.det(parts)) <= TWO_LINES).all(axis=1))[0]:
        if (line := _shared_line(parts[k])) is not None:
            points[k], there[k] = _on_and_off(parts[k], line)
    return points, there


def _gathered(count: int, which: Whole, found: Real, off: Real) -> tuple[Real, Mask]:
    """At most four different points of each pair, those that are met best."""
    good = np.nonzero(off <= MET)[0]
    good = good[np.lexsort((off[good], which[good]))]
    row = which[good]
    # Those of each pair side by side, the best first.
    place = np.arange(len(row)) - np.searchsorted(row, row)
    many = max(4, int(place.max(initial=-1)) + 1)
    points, there = np.zeros((count, many, 3)), np.zeros((count, many), dtype=bool)
    points[row, place], there[row, place] = found[good], True
    apart = [np.abs(points[:, :, None] + sign * points[:, None]).max(axis=-1) for sign in (-1, 1)]
    # With those before it only.
    same = np.tril((np.minimum(*apart) < ONE) & there[:, None], -1)
    if many > 4 or same.any():
        for k in range(1, many):
            there[:, k] &= ~(same[:, k] & there).any(axis=-1)
        order = np.argsort(~there, axis=-1, kind="stable")[:, :4]
        points, there = (np.take_along_axis(each, at, 1) for each, at in ((points, order[..., None]), (there, order)))
        points = np.where(there[..., None], points, 0)
    return points, there


def _shared_line(pair: Real) -> Real | None:
    """The line, a unit vector, that is a part of both conics; None if there is none."""
    sizes, ways = np.linalg.eigh(pair[0])
    order = np.argsort(-np.abs(sizes))
    (large, small), (one, other) = sizes[order[:2]], ways.T[order[:2]]
    # The first conic as two lines, which are real if the two signs differ, or one line twice.
    tilt = np.sqrt(max(-small / large, 0.0))
    for line in (one + tilt * other, one - tilt * other):
        along = np.linalg.svd(line[None])[2][1:]
        if np.abs(along @ pair @ along.T).max() <= SHARED:
            return np.asarray(line / np.linalg.norm(line))
    return None


def _on_and_off(pair: Real, line: Real) -> tuple[Real, list[bool]]:
    """Two points (4, 3) of a line that the conics share, and the one off it, and which of them there are."""
    points = np.zeros((4, 3))
    points[:2] = np.linalg.svd(line[None])[2][1:]
    # Each conic is a pair of lines: line x other + other x line, linear in the other.
    each = np.einsum("i,jk->ijk", line, np.eye(3))
    factors = (each + each.transpose(1, 0, 2)).reshape(9, 3)
    others = np.linalg.lstsq(factors, pair.reshape(2, 9).T)[0].T
    point = _across(others[0], others[1])
    size = float(np.linalg.norm(point))
    off = size > ONE and bool(abs(point @ line) > ONE * size)
    points[2] = point / size if off else 0.0
    return points, [True, True, off, False]


def _values(parts: Real, x: Array) -> Array:
    """Both conics (n, k, 2) at vectors (n, k, 3)."""
    value: Array = np.einsum("nki,ncij,nkj->nkc", x, parts, x)
    return value


def _polished(parts: Real, x: Array, steps: int) -> tuple[Array, Real]:
    """Unit vectors (n, k, 3) after Newton's steps on the unit sphere, of all that they come by the best.

    Besides, what the conics are there, at most, (n, k).
    """
    # Both conics as one row of coefficients: a product of matrices takes half the time of einsum's for a few.
    x = x / _size(x)
    forms = parts.transpose(0, 2, 1, 3).reshape(len(parts), 3, 6)
    slopes = _slopes(forms, x)
    value = _at(slopes, x)
    best, least = x, np.abs(value).max(axis=-1)
    for done in range(steps if x.size else 0):
        x = x - _step(slopes, value, x)
        x = x / _size(x)
        slopes = _slopes(forms, x)
        value = _at(slopes, x)
        off = np.abs(value).max(axis=-1)
        # Where the conics touch the last steps are rounding over nearly nothing, and lead away.
        better = off < least
        if not better.any() and (done > 2 or bool((least <= MET).all())):
            break
        best, least = np.where(better[..., None], x, best), np.where(better, off, least)
    return best, least


def _slopes(forms: Real, x: Array) -> Array:
    """Half the gradients (n, k, 2, 3) of both conics at vectors (n, k, 3)."""
    return (x @ forms).reshape(*x.shape[:2], 2, 3)


def _at(slopes: Array, x: Array) -> Array:
    """Both conics (n, k, 2) there."""
    value: Array = np.matmul(slopes, x[..., None])[..., 0]
    return value


def _size(x: Array) -> Real:
    """Lengths (..., 1) of vectors (..., 3); NumPy's own takes three times as long for a few."""
    size: Real = np.sqrt(np.vecdot(x, x).real)[..., None]
    return size


def _step(slopes: Array, value: Array, x: Array) -> Array:
    """Newton's steps (n, k, 3) square to x, 0 where there are many: a point where the conics touch stays.

    s with 2 a s = p, 2 b s = q and c s = 0, where c is x conjugate, is c x (q a - p b) over twice a x b along c.
    """
    a, b = slopes[..., 0, :], slopes[..., 1, :]
    volume = np.vecdot(x, _across(a, b))[..., None]
    way = _across(np.conj(x), value[..., 1:] * a - value[..., :1] * b)
    with np.errstate(divide="ignore", invalid="ignore"):
        step: Array = 0.5 * way / volume
    step = np.where(np.isfinite(step), step, 0.0)
    # A step of more than this leaps away from where the quartic saw a root.
    step = step / np.maximum(1.0, 10 * _size(step))
    return step


# The three places after each one, and before it.
AHEAD, BEHIND = np.array([1, 2, 0]), np.array([2, 0, 1])


def _across(a: Array, b: Array) -> Array:
    """Vector products; NumPy's own takes five times as long for a few."""
    product: Array = a.take(AHEAD, -1) * b.take(BEHIND, -1) - a.take(BEHIND, -1) * b.take(AHEAD, -1)
    return product


# Where in a matrix of nine the coefficients of a conic's powers stand, and how often; see `_roots`.
PLACES, TIMES = np.array([[8, 8, 8], [8, 2, 5], [0, 1, 4]]), np.array([[0, 0, 1], [0, 2, 2], [1, 2, 1]])


def _roots(parts: Real) -> Complex:
    """Complex vectors (n, 4, 3) near all common points: the last unknown eliminated, then told from the others."""
    # Coefficients of z^2, z, 1, each a polynomial in t with (t, 1, z), highest power first, (n, 2, 3, 3).
    by_power = parts.reshape(-1, 2, 9)[..., PLACES] * TIMES
    # First the conic that has the larger leading coefficient.
    swap = np.abs(by_power[:, 0, 0, 2]) < np.abs(by_power[:, 1, 0, 2])
    by_power = np.where(swap[:, None, None, None], by_power[:, ::-1], by_power)
    (a2, a1, a0), (b2, b1, b0) = ((one[:, 0, 2:], one[:, 1, 1:], one[:, 2]) for one in by_power.swapaxes(0, 1))
    one = a2 * b0 - b2 * a0
    two = a2 * b1 - b2 * a1
    three = _product(a1, b0) - _product(b1, a0)
    quartic = _product(one, one) - _product(two, three)
    lead = quartic[:, :1]
    least = 1e-14 * np.abs(quartic).max(axis=-1, keepdims=True)
    quartic = quartic / np.where(np.abs(lead) <= least, least + 1e-300, lead)
    companion = np.zeros((len(parts), 4, 4))
    companion[:, 0] = -quartic[:, 1:]
    companion[:, [1, 2, 3], [0, 1, 2]] = 1
    t = np.linalg.eigvals(companion).astype(complex)
    powers = np.stack([t * t, t, np.ones_like(t)], axis=1)
    p, q, r, *other = (by_power.reshape(-1, 6, 3) @ powers).swapaxes(0, 1)
    # Of the two roots in z of the first conic, the one that meets the other.
    root = np.sqrt(q * q - 4 * p * r)
    root = np.where((np.conj(q) * root).real < 0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.stack([-(q + root) / (2 * p), -2 * r / (q + root)])
    z = np.where(np.isfinite(z), z, 0)
    off = np.abs((other[0] * z + other[1]) * z + other[2]) / (1 + np.abs(t) ** 2 + np.abs(z) ** 2)
    roots: Complex = np.stack([t, powers[:, 2], np.where(off[0] <= off[1], *z)], axis=-1)
    return roots


def _product(p: Real, q: Real) -> Real:
    """Products (n, ...) of polynomials, highest power first."""
    out = np.zeros((len(p), p.shape[-1] + q.shape[-1] - 1))
    for k in range(p.shape[-1]):
        out[:, k : k + q.shape[-1]] += p[:, k : k + 1] * q
    return out


def _both_ways(parts: Real, which: Whole, x: Real) -> tuple[Whole, Real]:
    """Real starts (k, 3) and, where the conics nearly touch, those on both sides of where they do."""
    rows = 2 * (parts[which] @ x[:, None, :, None])[..., 0]
    # In the plane that touches the sphere there.
    flat = rows - np.vecdot(rows, x[:, None])[..., None] * x[:, None]
    # The product of its singular values, and the sum of their squares.
    area, square = np.abs(np.vecdot(_across(flat[:, 0], flat[:, 1]), x)), np.vecdot(flat, flat).sum(axis=-1)
    near = np.nonzero(area <= TOUCHING * square)[0]
    if not len(near):
        return which, x
    own, x0 = which[near], x[near]
    left, sizes, right = np.linalg.svd(flat[near])
    slow, fast = right[:, 1], right[:, 0]
    value = _values(parts[own], x0[:, None])[:, 0]
    x0 = x0 - fast * (np.sum(left[:, :, 0] * value, axis=-1) / sizes[:, 0])[:, None]
    # Along the slow way w(x0 + s v) is a quadratic in s.
    w = np.einsum("kc,kcij->kij", left[:, :, 1], parts[own])
    a, b, c = (np.einsum("ki,kij,kj->k", u, w, v) for u, v in ((slow, slow), (slow, x0), (x0, x0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        middle, half = -b / a, np.sqrt(np.maximum(b * b - a * c, 0)) / np.abs(a)
        both = np.nan_to_num(np.clip([middle - half, middle + half], -0.5, 0.5))
    sides = [x0 + slow * along[:, None] for along in both]
    return np.concatenate([which, own, own]), np.concatenate([x, *sides])
