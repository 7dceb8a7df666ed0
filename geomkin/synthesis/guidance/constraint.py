"""Constraint equations of dyads through poses, solved by the real common points of two conics, many pairs at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real, Whole, unit

# Newton steps: two or three suffice from a simple root of the quartic; a double root halves its error per step.
STEPS = 12
# Newton steps of complex points before the real ones are selected. With fewer a real one is missed; more cost time.
FIRST_STEPS = 2
# Imaginary share of a complex point up to which its real part is tried: two real points that nearly meet appear in
# the quartic as such a pair. A smaller value misses them; a larger one costs time.
NEARLY_REAL = 0.02
# Largest value of both conics, with coefficients of about 1, at a common point. A smaller value loses true points to
# rounding; a larger one takes close complex pairs for a double real point.
ZERO_RESIDUAL = 1e-13
# Distance on the unit sphere below which two points are the same. Two close points are known only to the root of
# rounding. A larger value merges them; a smaller one lists a point twice.
SAME_POINT = 3e-8
# Determinant of conics below which each may be two lines, and their largest value along a shared line. Larger values
# lose true points close together; with smaller ones four points of a shared line replace the true ones.
TWO_LINES, SHARED_LINE = 1e-9, 1e-11
# Ratio of the least to the greatest rate of both conics below which they nearly touch. A smaller value misses one of
# two close points; a larger one costs time.
TOUCHING = 1e-2


def common_points(pair: Real) -> tuple[Real, Mask]:
    """Common points (n, 4, 3) of pairs of conics, unit vectors up to sign, and which of them exist, (n, 4).

    `pair` holds (n, 2, 3, 3) symmetric matrices. By Bezout's theorem there are at most four, unless the conics share a
    line: then two points of it and the common point off it are given. The quartic of one unknown is solved by the
    eigenvalues of its companion matrix and improved by Newton steps: first complex points, then their real parts, on
    both sides if the conics nearly touch. Derived here.
    """
    size = np.abs(pair).max(axis=(1, 2, 3), keepdims=True)
    # An equivalent pair of conics, orthogonal and of unit size.
    flat = pair.reshape(len(pair), 2, 9) / np.where(size == 0, 1, size)[..., 0]
    parts = np.linalg.svd(flat, full_matrices=False)[2].reshape(-1, 2, 3, 3)
    starts, _ = _polished(parts, _roots(parts), FIRST_STEPS)
    # The phase at which the imaginary part of a complex point is least.
    starts = starts * np.exp(-0.5j * np.angle(np.vecdot(np.conj(starts), starts)))[..., None]
    near = _size(starts.imag)[..., 0] < NEARLY_REAL
    which: Whole = np.nonzero(near)[0]
    tried = starts.real[near]
    which, tried = _both_sides(parts, which, tried / _size(tried))
    found, off = (each[:, 0] for each in _polished(parts[which], tried[:, None], STEPS))
    points, there = _best_distinct(len(pair), which, found, off)
    for k in np.nonzero((np.abs(np.linalg.det(parts)) <= TWO_LINES).all(axis=1))[0]:
        if (line := _shared_line(parts[k])) is not None:
            points[k], there[k] = _on_and_off(parts[k], line)
    return points, there


def _best_distinct(count: int, which: Whole, found: Real, off: Real) -> tuple[Real, Mask]:
    """At most four distinct points of each pair, those with the least residuals."""
    good = np.nonzero(off <= ZERO_RESIDUAL)[0]
    good = good[np.lexsort((off[good], which[good]))]
    row = which[good]
    # Points of each pair in a row, the best first.
    place = np.arange(len(row)) - np.searchsorted(row, row)
    many = max(4, int(place.max(initial=-1)) + 1)
    points, there = np.zeros((count, many, 3)), np.zeros((count, many), dtype=bool)
    points[row, place], there[row, place] = found[good], True
    apart = [np.abs(points[:, :, None] + sign * points[:, None]).max(axis=-1) for sign in (-1, 1)]
    # Compared only with earlier ones.
    same = np.tril((np.minimum(*apart) < SAME_POINT) & there[:, None], -1)
    if many > 4 or same.any():
        for k in range(1, many):
            there[:, k] &= ~(same[:, k] & there).any(axis=-1)
        order = np.argsort(~there, axis=-1, kind="stable")[:, :4]
        points, there = (np.take_along_axis(each, at, 1) for each, at in ((points, order[..., None]), (there, order)))
        points = np.where(there[..., None], points, 0)
    return points, there


def _shared_line(pair: Real) -> Real | None:
    """A line, as a unit vector, that is part of both conics, or None."""
    sizes, vectors = np.linalg.eigh(pair[0])
    order = np.argsort(-np.abs(sizes))
    (large, small), (one, other) = sizes[order[:2]], vectors.T[order[:2]]
    # The first conic as two lines, which are real if the signs differ, or a double line.
    tilt = np.sqrt(max(-small / large, 0.0))
    for line in (one + tilt * other, one - tilt * other):
        along = np.linalg.svd(line[None])[2][1:]
        if np.abs(along @ pair @ along.T).max() <= SHARED_LINE:
            return np.asarray(line / np.linalg.norm(line))
    return None


def _on_and_off(pair: Real, line: Real) -> tuple[Real, list[bool]]:
    """Two points (4, 3) of the shared line and the common point off it, and which of them exist."""
    points = np.zeros((4, 3))
    points[:2] = np.linalg.svd(line[None])[2][1:]
    # Each conic is a pair of lines: line x other + other x line, linear in the other.
    each = np.einsum("i,jk->ijk", line, np.eye(3))
    factors = (each + each.transpose(1, 0, 2)).reshape(9, 3)
    others = np.linalg.lstsq(factors, pair.reshape(2, 9).T)[0].T
    point = _across(others[0], others[1])
    size = float(np.linalg.norm(point))
    off = size > SAME_POINT and bool(abs(point @ line) > SAME_POINT * size)
    points[2] = point / size if off else 0.0
    return points, [True, True, off, False]


def _values(parts: Real, x: Array) -> Array:
    """Both conics (n, k, 2) at vectors (n, k, 3)."""
    value: Array = np.einsum("nki,ncij,nkj->nkc", x, parts, x)
    return value


def _polished(parts: Real, x: Array, steps: int) -> tuple[Array, Real]:
    """Unit vectors (n, k, 3) after Newton steps on the sphere, the best of all iterates, and the residuals (n, k)."""
    # Both conics in one matrix, whose product takes half the time of einsum.
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
        # If the conics touch, the last steps are dominated by rounding and diverge.
        better = off < least
        if not better.any() and (done > 2 or bool((least <= ZERO_RESIDUAL).all())):
            break
        best, least = np.where(better[..., None], x, best), np.where(better, off, least)
    return best, least


def _slopes(forms: Real, x: Array) -> Array:
    """Half the gradients (n, k, 2, 3) of both conics at vectors (n, k, 3)."""
    return (x @ forms).reshape(*x.shape[:2], 2, 3)


def _at(slopes: Array, x: Array) -> Array:
    """Both conics (n, k, 2) at these vectors, from their slopes."""
    value: Array = np.matmul(slopes, x[..., None])[..., 0]
    return value


def _size(x: Array) -> Real:
    """Lengths (..., 1) of vectors (..., 3), three times as fast as NumPy's for small arrays."""
    size: Real = np.sqrt(np.vecdot(x, x).real)[..., None]
    return size


def _step(slopes: Array, value: Array, x: Array) -> Array:
    """Newton steps (n, k, 3) orthogonal to x; 0 if undetermined, so that a point of contact stays.

    s with 2 a s = p, 2 b s = q and c s = 0, with c the conjugate of x, is c x (q a - p b) over twice a x b along c.
    """
    a, b = slopes[..., 0, :], slopes[..., 1, :]
    volume = np.vecdot(x, _across(a, b))[..., None]
    product = _across(np.conj(x), value[..., 1:] * a - value[..., :1] * b)
    with np.errstate(divide="ignore", invalid="ignore"):
        step: Array = 0.5 * product / volume
    step = np.where(np.isfinite(step), step, 0.0)
    # A larger step would leave the neighbourhood of the root.
    step = step / np.maximum(1.0, 10 * _size(step))
    return step


# Cyclic successors and predecessors of the three indices.
NEXT, PREVIOUS = np.array([1, 2, 0]), np.array([2, 0, 1])


def _across(a: Array, b: Array) -> Array:
    """Vector products, five times as fast as NumPy's for small arrays."""
    product: Array = a.take(NEXT, -1) * b.take(PREVIOUS, -1) - a.take(PREVIOUS, -1) * b.take(NEXT, -1)
    return product


# Indices in the flattened matrix and multiplicities of the coefficients of a conic's powers; see `_roots`.
PLACES, TIMES = np.array([[8, 8, 8], [8, 2, 5], [0, 1, 4]]), np.array([[0, 0, 1], [0, 2, 2], [1, 2, 1]])


def _roots(parts: Real) -> Complex:
    """Complex vectors (n, 4, 3) near all common points, by elimination of the last unknown."""
    # Coefficients of z^2, z, 1, each a polynomial in t with (t, 1, z), highest power first, (n, 2, 3, 3).
    by_power = parts.reshape(-1, 2, 9)[..., PLACES] * TIMES
    # The conic with the larger leading coefficient comes first.
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
    # The root in z of the first conic that also satisfies the second.
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


def _both_sides(parts: Real, which: Whole, x: Real) -> tuple[Whole, Real]:
    """Real starts (k, 3); two starts, one on each side, if the conics nearly touch."""
    rows = 2 * (parts[which] @ x[:, None, :, None])[..., 0]
    # In the tangent plane of the sphere.
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
    # Along the slow direction w(x0 + s v) is a quadratic in s.
    w = np.einsum("kc,kcij->kij", left[:, :, 1], parts[own])
    a, b, c = (np.einsum("ki,kij,kj->k", u, w, v) for u, v in ((slow, slow), (slow, x0), (x0, x0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        middle, half = -b / a, np.sqrt(np.maximum(b * b - a * c, 0)) / np.abs(a)
        both = np.nan_to_num(np.clip([middle - half, middle + half], -0.5, 0.5))
    sides = [x0 + slow * along[:, None] for along in both]
    return np.concatenate([which, own, own]), np.concatenate([x, *sides])


# Distance of a pivot, in sizes of the poses, beyond which it is reported as a slide. The arc then differs from a line
# by 1e-9 of the size. A larger value gives slides as far pivots made of rounding; a smaller one loses true far pivots.
FAR = 1e9
# Ratio of singular values above which a condition is independent. A smaller value lets rounding separate nearly equal
# poses; a larger one merges poses close together.
RANK = 1e-11
# Largest share of w and a in the relations of slides, and of parallel slides among these. A larger value accepts
# approximate slides; a smaller one lets rounding hide that every direction has one.
PARALLEL_SLIDES = 1e-9


@record(eq=False)
class Pairs:
    """Dyads of any shape, each a pivot on the ground and a pin on the body.

    `fixed` and `moving` are in mm, or, if `fixed_far` or `moving_far`, the direction of the slide, unit complex.
    """

    fixed: Complex
    moving: Complex
    fixed_far: Mask
    moving_far: Mask

    def at(self, kept: Mask | Whole) -> Pairs:
        """A selection of the dyads."""
        return Pairs(self.fixed[kept], self.moving[kept], self.fixed_far[kept], self.moving_far[kept])

    @property
    def swapped(self) -> Pairs:
        """The same dyads for the poses of the ground as seen from the body."""
        return Pairs(self.moving, self.fixed, self.moving_far, self.fixed_far)

    def enlarged(self, middle: complex | Complex, size: float | Real) -> Pairs:
        """The dyads for poses scaled by `size` and moved to `middle`, mm; directions do not change."""
        fixed = np.where(self.fixed_far, self.fixed, middle + size * self.fixed)
        return Pairs(fixed, np.where(self.moving_far, self.moving, size * self.moving), self.fixed_far, self.moving_far)


def joined(several: Sequence[Pairs]) -> Pairs:
    """Several sets of dyads in one."""
    parts = [(p.fixed.ravel(), p.moving.ravel(), p.fixed_far.ravel(), p.moving_far.ravel()) for p in several]
    fixed, moving, fixed_far, moving_far = (np.concatenate(part) for part in zip(*parts))
    return Pairs(fixed, moving, fixed_far, moving_far)


def rows(z: Complex, u: Complex) -> Real:
    """Conditions of each pose, (..., n, 8), on the coefficients w, a, b, c, d, real parts first."""
    turned = np.conj(z) * u
    parts = [abs(z) ** 2, turned.real, -turned.imag, z.real, z.imag, u.real, -u.imag, np.ones_like(z.real)]
    return np.stack(parts, axis=-1)


def _side_conditions() -> Real:
    """2 w c - a conj(b) as two symmetric matrices (2, 8, 8)."""
    g = np.zeros((2, 8, 8))
    for k, i, j, value in (
        *((0, 0, 5, 2.0), (0, 1, 3, -1.0), (0, 2, 4, -1.0)),
        *((1, 0, 6, 2.0), (1, 2, 3, -1.0), (1, 1, 4, 1.0)),
    ):
        g[k, i, j] += value / 2
        g[k, j, i] += value / 2
    return g


SIDE = _side_conditions()


def normalised(z: Complex) -> tuple[Complex, Complex, Real]:
    """Origins (..., n) relative to their middle and size, the middle (..., 1), mm, and the size (..., 1), mm."""
    middle = z.mean(axis=-1, keepdims=True)
    size: Real = np.abs(z - middle).max(axis=-1, keepdims=True)
    size = np.where(size == 0, 1.0, size)
    return (z - middle) / size, middle, size


@record(eq=False)
class Relations:
    """Singular values, greatest first, and vectors of the conditions of poses (..., n), in unit sizes.

    The origins' middle and size are (..., 1), mm.
    """

    middle: Complex
    size: Real
    values: Real
    vectors: Real

    @property
    def freedom(self) -> int:
        """Number of free relations of one set of poses; 3 if they determine finitely many dyads."""
        return 8 - int(np.sum(self.values > RANK * self.values[..., 0]))


def relations(z: Complex, u: Complex) -> Relations:
    """Relations of poses (..., n)."""
    scaled, middle, size = normalised(z)
    _, values, vectors = np.linalg.svd(rows(scaled, u))
    return Relations(middle, size, values, vectors)


def pairs_of_least(poses: Relations) -> tuple[Pairs, Mask]:
    """Dyads (..., 4) of poses (..., n) from the three least singular vectors, and which of them exist.

    For five poses these are all dyads. For more they include all exact ones.
    """
    open_ = poses.vectors[..., -3:, :]
    conics = open_[..., None, :, :] @ SIDE @ open_[..., None, :, :].swapaxes(-1, -2)
    points, there = common_points(conics.reshape(-1, 2, 3, 3))
    shape = open_.shape[:-2]
    points, there = points.reshape(*shape, 4, 3), there.reshape(*shape, 4)
    found, good = pairs_of(points @ open_)
    return found.enlarged(poses.middle, poses.size), there & good


def square_slides(z: Complex, u: Complex, poses: Relations) -> Pairs | None:
    """Two slides on the ground at right angles, for poses (n,) with a slide in every direction; else None.

    The first has the greatest travel by squares, so that a driving slider is farthest from its dead centres. Derived
    here.
    """
    open_ = poses.vectors[8 - poses.freedom :]
    left, sizes, _ = np.linalg.svd(open_[:, :3])
    # Combinations of the relations without w and a.
    slides = left.T[np.append(sizes, np.zeros(len(left) - len(sizes))) <= PARALLEL_SLIDES] @ open_
    if len(slides) != 2 or np.linalg.cond(slides[:, 3:5]) > 1 / PARALLEL_SLIDES:
        return None
    # Slides with b = 1 and b = i, of which all others are combinations, and the travel along them.
    b, c = np.array([1, 1j]), np.linalg.solve(slides[:, 3:5], slides[:, 5:7]) @ [1, 1j]
    travelled = (np.conj(b)[:, None] * (z - poses.middle) / poses.size + c[:, None] * u).imag
    farthest = np.linalg.svd(travelled - travelled.mean(axis=1, keepdims=True))[0][:, 0]
    share = np.array([farthest, [-farthest[1], farthest[0]]])
    b, c = share @ b, share @ c
    slide_directions = 1j * b * np.where(b.imag > 0, -1, 1)
    return Pairs(slide_directions, poses.size * c / np.conj(b), np.full(2, True), np.full(2, False))


def pairs_of(coefficients: Real) -> tuple[Pairs, Mask]:
    """Dyads from coefficients (..., 8), and which exist: coefficients with c and d only fix the angle of the body."""
    w, d = coefficients[..., 0], np.abs(coefficients[..., 7])
    a, b, c = (coefficients[..., k] + 1j * coefficients[..., k + 1] for k in (1, 3, 5))
    on_ground, on_body = np.hypot(2 * w, abs(a)), np.hypot(2 * w, abs(b))
    fixed_far = on_ground * FAR <= np.hypot(abs(b), abs(c))
    moving_far = on_body * FAR <= np.hypot(abs(a), abs(c))
    good = ~(fixed_far & moving_far) & (np.hypot(on_ground, on_body) * FAR > d)
    # Both relations are used, so that neither a small w nor a small b costs digits.
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(fixed_far, 1j * unit(b), -(2 * w * b + a * np.conj(c)) / on_ground**2)
        moving = np.where(moving_far, 1j * unit(a), (2 * w * a + b * c) / on_body**2)
    return Pairs(fixed, moving, fixed_far, moving_far), good


def missed(z: Complex, u: Complex, pairs: Pairs) -> Real:
    """Largest error, mm, of dyads (..., k) at the poses (..., n), (..., k)."""
    z, u = z[..., None, :], u[..., None, :]
    fixed, moving = pairs.fixed[..., None], pairs.moving[..., None]
    body_far, ground_far = pairs.moving_far[..., None], pairs.fixed_far[..., None]
    with np.errstate(invalid="ignore", over="ignore"):
        # Position of the pin on the ground, or of the pivot on the body, at right angles to the slide.
        on_ground = z + u * np.where(body_far, 0, moving)
        on_body = np.conj(u) * (np.where(ground_far, 0, fixed) - z)
        across = np.where(ground_far, (np.conj(fixed) * on_ground).imag, (np.conj(moving) * on_body).imag)
        # A difference of distances in a form that keeps its digits for far pivots.
        arm = on_ground - fixed
        length = np.abs(arm)
        step = on_ground - on_ground[..., :1]
        change = (np.conj(step) * (arm + arm[..., :1])).real
        total = length + length[..., :1]
        turning = np.divide(change, total, out=np.zeros_like(change), where=total > 0)
        away = np.where(ground_far | body_far, across, turning)
        low, high = away.min(axis=-1), away.max(axis=-1)
    worst: Real = 0.5 * (high - low)
    return worst


def sharpened(z: Complex, u: Complex, pairs: Pairs) -> Pairs:
    """Dyads (k,) of five poses (5,) after two Newton steps on the distances, if these improve them.

    The coefficients are accurate to rounding, which poses close together amplify.
    """
    off = missed(z, u, pairs)
    for _ in range(2):
        with np.errstate(over="ignore"):
            if (off <= 1e-15 * (np.abs(pairs.moving) + np.abs(pairs.fixed) + np.abs(z).max())).all():
                break
        m, f = pairs.moving[:, None], pairs.fixed[:, None]
        near = ~(pairs.fixed_far | pairs.moving_far)
        with np.errstate(invalid="ignore"):
            pin = z + u * np.where(near[:, None], m, 0)
            step, total = pin[:, 1:] - pin[:, :1], pin[:, 1:] + pin[:, :1] - 2 * np.where(near[:, None], f, 0)
        value = (np.conj(step) * total).real
        by_m = np.conj(total) * (u[1:] - u[0]) + np.conj(step) * (u[1:] + u[0])
        slopes = np.stack([by_m.real, -by_m.imag, -2 * step.real, -2 * step.imag], axis=-1)
        left, sizes, right = np.linalg.svd(slopes)
        good = near & (sizes[:, 3] > 1e-14 * sizes[:, 0])
        along = (value[:, None] @ left) / np.where(good[:, None], sizes, 1.0)[:, None]
        change = (along @ right)[:, 0]
        tried = Pairs(
            np.where(good, pairs.fixed - change[:, 2] - 1j * change[:, 3], pairs.fixed),
            np.where(good, pairs.moving - change[:, 0] - 1j * change[:, 1], pairs.moving),
            pairs.fixed_far,
            pairs.moving_far,
        )
        left = missed(z, u, tried)
        better = left < off
        pairs = Pairs(
            np.where(better, tried.fixed, pairs.fixed),
            np.where(better, tried.moving, pairs.moving),
            pairs.fixed_far,
            pairs.moving_far,
        )
        off = np.minimum(off, left)
    return pairs
