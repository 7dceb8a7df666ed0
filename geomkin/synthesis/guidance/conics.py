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
# Determinant of three points in common, over what it could be, from which they are in one line, which is then a part
# of both conics. Larger, and true points close together are lost; smaller, and any three of a shared line are told.
IN_LINE = 1e-9
# How much more slowly both conics change one way than the other where they nearly touch. Smaller, and one of the two
# points that lie close together is missed; larger costs time.
TOUCHING = 1e-2


def common_points(first: Real, second: Real) -> tuple[Real, Mask]:
    """Points (n, 4, 3) of the projective plane, unit vectors up to sign, and which of them there are, (n, 4).

    first, second: (n, 3, 3) symmetric matrices of the conics. Bezout: four at most, unless they share a line:
    then two of its points, and the one that they have besides. The
    quartic of one unknown is solved as the eigenvalues of its companion, then all is polished by Newton's steps:
    complex points as such, then their real parts, both ways where the conics nearly touch. Derived here.
    """
    pair = np.stack([first, second], axis=1)
    size = np.abs(pair).max(axis=(1, 2, 3), keepdims=True)
    # A pair as good as the given one, whose members are of one size and least alike.
    flat = pair.reshape(len(pair), 2, 9) / np.where(size == 0, 1, size)[..., 0]
    parts = np.linalg.svd(flat, full_matrices=False)[2].reshape(-1, 2, 3, 3)
    starts = _polished(parts, _roots(parts), FIRST_STEPS)
    # Of a complex point, the phase at which its largest part is real.
    at = np.argmax(np.abs(starts), axis=-1)[..., None]
    lead = np.take_along_axis(starts, at, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        starts = starts * (np.conj(lead) / np.abs(lead))
    unreal = np.linalg.norm(starts.imag, axis=-1)
    which: Whole = np.nonzero(unreal < NEARLY_REAL)[0]
    tried = starts.real[unreal < NEARLY_REAL]
    tried /= np.linalg.norm(tried, axis=-1, keepdims=True)
    which, tried = _both_ways(parts, which, tried)
    found = _polished(parts[which], tried[:, None].astype(float), STEPS)[:, 0]
    off = np.abs(_values(parts[which], found[:, None])).max(axis=(-1, -2))
    points, there = _gathered(len(pair), which, found, off)
    for k in np.nonzero(there.sum(axis=-1) > 2)[0]:
        if (other := _off_the_line(parts[k], points[k, :3])) is not None:
            points[k, 2], there[k] = other, [True, True, True, False]
    return points, there


def _gathered(count: int, which: Whole, found: Real, off: Real) -> tuple[Real, Mask]:
    """At most four different points of each pair, those that are met best."""
    points, there = np.zeros((count, 4, 3)), np.zeros((count, 4), dtype=bool)
    held = np.zeros(count, dtype=int)
    good = np.nonzero(off <= MET)[0]
    for k in good[np.argsort(off[good], kind="stable")]:
        row = which[k]
        known = points[row, : held[row]]
        apart = np.minimum(np.abs(known - found[k]).max(axis=-1), np.abs(known + found[k]).max(axis=-1))
        if held[row] < 4 and not (apart < ONE).any():
            points[row, held[row]], there[row, held[row]] = found[k], True
            held[row] += 1
    return points, there


def _off_the_line(pair: Real, three: Real) -> Real | None:
    """Where the conics meet besides on a line that they share; None where they share none."""
    if abs(np.linalg.det(three)) > IN_LINE * np.prod(np.linalg.svd(three, compute_uv=False)[:2]):
        return None
    line = np.linalg.svd(three)[2][2]
    # Each conic is a pair of lines: line x other + other x line, linear in the other.
    each = np.einsum("i,jk->ijk", line, np.eye(3))
    factors = (each + each.transpose(1, 0, 2)).reshape(9, 3)
    others = np.linalg.lstsq(factors, pair.reshape(2, 9).T)[0].T
    point = _across(others[0], others[1])
    size = float(np.linalg.norm(point))
    met = size > 0 and bool(np.abs(_values(pair[None], point[None, None] / size)).max() <= np.sqrt(MET))
    return point / size if met else None


def _values(parts: Real, x: Array) -> Array:
    """Both conics (n, k, 2) at vectors (n, k, 3)."""
    value: Array = np.einsum("nki,ncij,nkj->nkc", x, parts, x)
    return value


def _polished(parts: Real, x: Array, steps: int) -> Array:
    """Vectors (n, k, 3) after Newton's steps on the unit sphere: of all that they come by, the best."""
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    value = _values(parts, x)
    best, least = x, np.abs(value).max(axis=-1)
    for done in range(steps if x.size else 0):
        slopes = 2 * np.einsum("ncij,nkj->nkci", parts, x)
        rows = np.concatenate([slopes, np.conj(x)[..., None, :]], axis=-2)
        step = _solved(rows, np.concatenate([value, np.zeros((*x.shape[:2], 1))], axis=-1))
        x = x - step
        x = x / np.linalg.norm(x, axis=-1, keepdims=True)
        value = _values(parts, x)
        off = np.abs(value).max(axis=-1)
        # Where the conics touch the last steps are rounding over nearly nothing, and lead away.
        better = off < least
        best, least = np.where(better[..., None], x, best), np.where(better, off, least)
        if done > 2 and not better.any():
            break
    return best


def _solved(rows: Array, value: Array) -> Array:
    """Solutions of 3 x 3 systems by cross products, 0 where singular: a point where the conics touch stays."""
    a, b, c = rows[..., 0, :], rows[..., 1, :], rows[..., 2, :]
    bc, ca, ab = _across(b, c), _across(c, a), _across(a, b)
    volume = np.sum(a * bc, axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = (value[..., :1] * bc + value[..., 1:2] * ca + value[..., 2:] * ab) / volume
    # A step of more than this leaps away from where the quartic saw a root.
    x = np.where(np.isfinite(x), x, 0.0)
    step: Array = x / np.maximum(1.0, 10 * np.linalg.norm(x, axis=-1, keepdims=True))
    return step


def _across(a: Array, b: Array) -> Array:
    """Vector products; NumPy's own takes five times as long for a few."""
    ahead, behind = [1, 2, 0], [2, 0, 1]
    product: Array = a[..., ahead] * b[..., behind] - a[..., behind] * b[..., ahead]
    return product


def _roots(parts: Real) -> Complex:
    """Complex vectors (n, 4, 3) near all common points: the last unknown eliminated, then told from the others."""
    (a, b) = parts[:, 0], parts[:, 1]

    def by_power(m: Real) -> tuple[Real, Real, Real]:
        # Coefficients of z^2, z, 1, each a polynomial in t with (t, 1, z), highest power first.
        return (
            m[:, 2, 2:],
            2 * np.stack([m[:, 0, 2], m[:, 1, 2]], axis=-1),
            np.stack([m[:, 0, 0], 2 * m[:, 0, 1], m[:, 1, 1]], axis=-1),
        )

    (a2, a1, a0), (b2, b1, b0) = by_power(a), by_power(b)
    one = a2 * b0 - b2 * a0
    two = a2 * b1 - b2 * a1
    three = _product(a1, b0) - _product(b1, a0)
    quartic = _product(one, one) - _product(two, three)
    lead = quartic[:, :1]
    tiny = np.abs(lead) < 1e-14 * np.abs(quartic).max(axis=-1, keepdims=True)
    quartic = quartic / np.where(tiny, 1e-14 * np.abs(quartic).max(axis=-1, keepdims=True) + 1e-300, lead)
    companion = np.zeros((len(a), 4, 4))
    companion[:, 0] = -quartic[:, 1:]
    companion[:, [1, 2, 3], [0, 1, 2]] = 1
    t = np.linalg.eigvals(companion).astype(complex)

    def at(poly: Real) -> Complex:
        value = np.zeros_like(t)
        for k in range(poly.shape[-1]):
            value = value * t + poly[:, k : k + 1]
        return value

    # Of the two roots in z of the conic that has the larger leading coefficient, the one that meets the other.
    swap = np.abs(a2) < np.abs(b2)
    p, q, r = (np.where(swap, at(v), at(u)) for u, v in ((a2, b2), (a1, b1), (a0, b0)))
    root = np.sqrt(q * q - 4 * p * r)
    root = np.where((np.conj(q) * root).real < 0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.stack([-(q + root) / (2 * p), -2 * r / (q + root)])
    z = np.where(np.isfinite(z), z, 0)
    other = [np.where(swap, at(u), at(v)) for u, v in ((a2, b2), (a1, b1), (a0, b0))]
    scale = 1 + np.abs(t) ** 2 + np.abs(z) ** 2
    off = np.abs((other[0] * z + other[1]) * z + other[2]) / scale
    z = np.where(off[0] <= off[1], z[0], z[1])
    x = np.stack([t, np.ones_like(t), z], axis=-1)
    roots: Complex = x / np.linalg.norm(x, axis=-1, keepdims=True)
    return roots


def _product(p: Real, q: Real) -> Real:
    """Products (n, ...) of polynomials, highest power first."""
    out = np.zeros((len(p), p.shape[-1] + q.shape[-1] - 1))
    for k in range(p.shape[-1]):
        out[:, k : k + q.shape[-1]] += p[:, k : k + 1] * q
    return out


def _both_ways(parts: Real, which: Whole, x: Real) -> tuple[Whole, Real]:
    """Real starts (k, 3) and, where the conics nearly touch, those on both sides of where they do."""
    rows = 2 * np.einsum("kcij,kj->kci", parts[which], x)
    # In the plane that touches the sphere there.
    flat = rows - np.sum(rows * x[:, None], axis=-1, keepdims=True) * x[:, None]
    left, sizes, right = np.linalg.svd(flat)
    near = np.nonzero(sizes[:, 1] <= TOUCHING * sizes[:, 0])[0]
    if not len(near):
        return which, x
    own, x0 = which[near], x[near]
    slow, fast = right[near, 1], right[near, 0]
    value = _values(parts[own], x0[:, None])[:, 0]
    x0 = x0 - fast * (np.sum(left[near, :, 0] * value, axis=-1) / sizes[near, 0])[:, None]
    # Along the slow way w(x0 + s v) is a quadratic in s.
    w = np.einsum("kc,kcij->kij", left[near, :, 1], parts[own])
    a, b, c = (np.einsum("ki,kij,kj->k", u, w, v) for u, v in ((slow, slow), (slow, x0), (x0, x0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        middle, half = -b / a, np.sqrt(np.maximum(b * b - a * c, 0)) / np.abs(a)
    sides = [x0 + slow * np.nan_to_num(np.clip(middle + way * half, -0.5, 0.5))[:, None] for way in (-1, 1)]
    return np.concatenate([which, own, own]), np.concatenate([x, *sides])
