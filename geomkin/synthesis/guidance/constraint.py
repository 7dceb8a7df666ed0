"""What a dyad asks of the poses, linear in eight coefficients, and the dyads that such coefficients are.

A pin at m on the body keeps its distance from f on the ground at the pose (z, u) when

    w |z|^2 + Re(a conj(z) u) + Re(conj(b) z) + Re(c u) + d = 0,   a = 2 w m,  b = -2 w f,  c = conj(b) m,

so that 2 w c = a conj(b): two quadrics. With w = 0 and a = 0 the pin runs along a line square to b, as f is at
infinity; with w = 0 and b = 0 a line of the body, whose normal is a, runs through f. So pins and slides, on the ground
and on the body, are one thing. Bottema and Roth, Theoretical Kinematics, 1979, chapter VIII; these forms are derived
here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...brief import one_line
from ...plane.vec import Complex, Mask, Real, Whole, unit
from .conics import common_points

# Distance of a pivot, in sizes of the poses, from which it is told as a slide. The arc differs there from its line by
# 1e-9 of the size. Larger, and slides come out as far pivots of rounding; smaller, and true far pivots are lost.
FAR = 1e9
# Least singular value over the largest from which a row says something new. Smaller, and poses that nearly say the
# same are told apart by rounding; larger, and poses close together are taken for one.
RANK = 1e-11
# Share of w and a in relations that are those of slides, and of parallel slides among those. Larger, and slides that
# nearly serve are told; smaller, and rounding hides that any direction has one.
PARALLEL_SLIDES = 1e-9


@dataclass(frozen=True, eq=False)
class Pairs:
    """Dyads of any shape in homogeneous form, each a place on the ground and one on the body.

    fixed, moving: mm, or where `fixed_far` or `moving_far` the slide's direction, unit complex, on the ground or on
    the body.
    """

    fixed: Complex
    moving: Complex
    fixed_far: Mask
    moving_far: Mask

    __repr__ = one_line

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


@dataclass(frozen=True, eq=False)
class Relations:
    """What poses (..., n) ask of the eight coefficients, in unit sizes: singular values, greatest first, and vectors.

    The origins' middle and size are (..., 1), mm.
    """

    middle: Complex
    size: Real
    values: Real
    vectors: Real

    __repr__ = one_line

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
