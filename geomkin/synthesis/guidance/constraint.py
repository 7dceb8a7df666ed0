"""The real points that two conics have in common, many pairs of conics at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real, Whole, unit

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


# Distance of a pivot, in sizes of the poses, from which it is told as a slide. The arc differs there from its line by
# 1e-9 of the size. Larger, and slides come out as far pivots of rounding; smaller, and true far pivots are lost.
FAR = 1e9
# Least singular value over the largest from which a row says something new. Smaller, and poses that nearly say the
# same are told apart by rounding; larger, and poses close together are taken for one.
RANK = 1e-11
# Share of w and a in relations that are those of slides, and of parallel slides among those. Larger, and slides that
# nearly serve are told; smaller, and rounding hides that any direction has one.
PARALLEL_SLIDES = 1e-9


@record(eq=False)
class Pairs:
    """Dyads of any shape in homogeneous form, each a place on the ground and one on the body.

    fixed, moving: mm, or where `fixed_far` or `moving_far` the slide's direction, unit complex, on the ground or on
    the body.
    """

    fixed: Complex
    moving: Complex
    fixed_far: Mask
    moving_far: Mask

    def at(self, kept: Mask | Whole) -> Pairs:
        """Those that are kept, in one row."""
        return Pairs(self.fixed[kept], self.moving[kept], self.fixed_far[kept], self.moving_far[kept])

    @property
    def swapped(self) -> Pairs:
        """The same for the poses that the body sees."""
        return Pairs(self.moving, self.fixed, self.moving_far, self.fixed_far)

    def enlarged(self, middle: complex | Complex, size: float | Real) -> Pairs:
        """Those of poses `size` times as far apart about `middle`, mm; what is a direction stays so."""
        fixed = np.where(self.fixed_far, self.fixed, middle + size * self.fixed)
        return Pairs(fixed, np.where(self.moving_far, self.moving, size * self.moving), self.fixed_far, self.moving_far)


def joined(several: Sequence[Pairs]) -> Pairs:
    """Several in one row."""
    parts = [(p.fixed.ravel(), p.moving.ravel(), p.fixed_far.ravel(), p.moving_far.ravel()) for p in several]
    fixed, moving, fixed_far, moving_far = (np.concatenate(part) for part in zip(*parts))
    return Pairs(fixed, moving, fixed_far, moving_far)


def rows(z: Complex, u: Complex) -> Real:
    """What is asked at each pose, (..., n, 8), for the coefficients w, a, b, c, d with their real parts first."""
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
    """Origins (..., n) about their middle and in their size, the middle (..., 1), mm, and the size (..., 1), mm."""
    middle = z.mean(axis=-1, keepdims=True)
    size: Real = np.abs(z - middle).max(axis=-1, keepdims=True)
    size = np.where(size == 0, 1.0, size)
    return (z - middle) / size, middle, size


@record(eq=False)
class Relations:
    """What poses (..., n) ask of the eight coefficients, in unit sizes: singular values, greatest first, and vectors.

    The origins' middle and size are (..., 1), mm.
    """

    middle: Complex
    size: Real
    values: Real
    vectors: Real

    @property
    def freedom(self) -> int:
        """How many relations the poses, of one set, leave open: 3 where they fix finitely many dyads."""
        return 8 - int(np.sum(self.values > RANK * self.values[..., 0]))


def relations(z: Complex, u: Complex) -> Relations:
    """Of poses (..., n)."""
    scaled, middle, size = normalised(z)
    _, values, vectors = np.linalg.svd(rows(scaled, u))
    return Relations(middle, size, values, vectors)


def pairs_of_least(poses: Relations) -> tuple[Pairs, Mask]:
    """The dyads (..., 4), and which there are, of poses (..., n): real members of the three least coefficients' rows.

    Of five poses these are all dyads there are. Of more, those that are met exactly are among them.
    """
    open_ = poses.vectors[..., -3:, :]
    conics = open_[..., None, :, :] @ SIDE @ open_[..., None, :, :].swapaxes(-1, -2)
    points, there = common_points(conics.reshape(-1, 2, 3, 3))
    shape = open_.shape[:-2]
    points, there = points.reshape(*shape, 4, 3), there.reshape(*shape, 4)
    found, good = pairs_of(points @ open_)
    return found.enlarged(poses.middle, poses.size), there & good


def square_slides(z: Complex, u: Complex, poses: Relations) -> Pairs | None:
    """Two slides on the ground, square to each other, of poses (n,) that have one along every direction; else None.

    The first is the one that is travelled farthest, in the sense of squares: a driving slide is then farthest from its
    dead centres. Derived here.
    """
    open_ = poses.vectors[8 - poses.freedom :]
    left, sizes, _ = np.linalg.svd(open_[:, :3])
    # What is left of them without w and a.
    slides = left.T[np.append(sizes, np.zeros(len(left) - len(sizes))) <= PARALLEL_SLIDES] @ open_
    if len(slides) != 2 or np.linalg.cond(slides[:, 3:5]) > 1 / PARALLEL_SLIDES:
        return None
    # Those with b = 1 and b = i, of which all others are sums, and what is travelled along them.
    b, c = np.array([1, 1j]), np.linalg.solve(slides[:, 3:5], slides[:, 5:7]) @ [1, 1j]
    travelled = (np.conj(b)[:, None] * (z - poses.middle) / poses.size + c[:, None] * u).imag
    farthest = np.linalg.svd(travelled - travelled.mean(axis=1, keepdims=True))[0][:, 0]
    share = np.array([farthest, [-farthest[1], farthest[0]]])
    b, c = share @ b, share @ c
    way = 1j * b * np.where(b.imag > 0, -1, 1)
    return Pairs(way, poses.size * c / np.conj(b), np.full(2, True), np.full(2, False))


def pairs_of(told: Real) -> tuple[Pairs, Mask]:
    """Coefficients (..., 8) as dyads, and which of them are: those of nothing but c and d only forbid turning."""
    w, d = told[..., 0], np.abs(told[..., 7])
    a, b, c = (told[..., k] + 1j * told[..., k + 1] for k in (1, 3, 5))
    on_ground, on_body = np.hypot(2 * w, abs(a)), np.hypot(2 * w, abs(b))
    fixed_far = on_ground * FAR <= np.hypot(abs(b), abs(c))
    moving_far = on_body * FAR <= np.hypot(abs(a), abs(c))
    good = ~(fixed_far & moving_far) & (np.hypot(on_ground, on_body) * FAR > d)
    # Each from both relations that tell it, so that neither a small w nor a small b costs digits.
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(fixed_far, 1j * unit(b), -(2 * w * b + a * np.conj(c)) / on_ground**2)
        moving = np.where(moving_far, 1j * unit(a), (2 * w * a + b * c) / on_body**2)
    return Pairs(fixed, moving, fixed_far, moving_far), good


def missed(z: Complex, u: Complex, pairs: Pairs) -> Real:
    """Largest distance, mm, by which dyads (..., k) miss the poses (..., n) that they are to go through, (..., k)."""
    z, u = z[..., None, :], u[..., None, :]
    fixed, moving = pairs.fixed[..., None], pairs.moving[..., None]
    body_far, ground_far = pairs.moving_far[..., None], pairs.fixed_far[..., None]
    with np.errstate(invalid="ignore", over="ignore"):
        # The pin on the ground, or seen from the body the pivot, in its way across the slide.
        on_ground = z + u * np.where(body_far, 0, moving)
        on_body = np.conj(u) * (np.where(ground_far, 0, fixed) - z)
        across = np.where(ground_far, (np.conj(fixed) * on_ground).imag, (np.conj(moving) * on_body).imag)
        # A difference of distances without the digits that a far pivot would cost.
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
    """Dyads (k,) of five poses (5,) after two Newton's steps on the distances themselves, where these gain by them.

    The coefficients are known to rounding, and poses close together make much of that.
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
