"""Four-bars through nine points of a path, by random starts and continuation along curves between solutions."""

from __future__ import annotations

import numpy as np

from ...core.progress import Watch
from ...plane.vec import Complex, Mask, Real, Whole

# Random starts per round, and rounds in a row without a new linkage after which the search ends. Fewer find fewer of
# the real linkages, depending on the seed; more take longer.
STARTS, IDLE = 250, 6
# Batch size of curves: larger batches do not fit the processor's cache, smaller ones cost Python overhead.
AT_ONCE = 1_000
# Steps from a nearby point of a curve to a solution.
STEPS = 40
# Most steps along a curve, first and longest step relative to the position, shortest step, and the distance at which a
# curve is abandoned. More steps and a larger distance find hardly more.
FOLLOWED, FIRST, LONGEST, SHORTEST, FARTHEST = 300, 0.02, 0.15, 1e-6, 60.0
# Largest squared residual of a solution, and least length of a link, in units of the points.
MET, NONE = 1e-26, 1e-4


def through_nine(points: Complex, rng: np.random.Generator, watch: Watch) -> Real:
    """Rows (s, 8): x, y of crank pin, crank pivot, rocker pin and rocker pivot with the coupler point at the first
    point.

    One of each three cognates; some may be missing. `points` are nine with a mean square of about 1. There are eight
    equations in as many unknowns: |point + arm of the pin - pivot| is equal at all points, with the coupler's rotations
    eliminated (Wampler, Morgan and Sommese, Complete solution of the nine-point path synthesis problem for four-bar
    linkages, Journal of Mechanical Design 114, 1992, who count 4326 solutions in triples of cognates). From a random
    start a curve along which all residuals shrink in proportion leads to solutions (Newton homotopy). Without one of
    the equations a solution lies on a curve too, and other intersections with that equation are further solutions:
    derived here. The search ends when several rounds of new starts find nothing new, or at its time limit.
    """
    problem = _Nine(points)
    found: Real = np.zeros((0, 8))
    fresh: Real = np.zeros((0, 8))
    keys: Complex = np.zeros((0, 3), dtype=complex)
    idle, share = 0, 0.0
    while idle < IDLE and not watch.over():
        share = max(share, idle / IDLE)
        watch.report(share)
        size = np.exp(rng.normal(0, 0.7, (STARTS, 4)))
        starts = (size * (rng.normal(size=(STARTS, 4)) + 1j * rng.normal(size=(STARTS, 4)))).view(float)
        x = np.concatenate([np.repeat(fresh, 8, axis=0), starts])
        ways = np.concatenate([np.tile(np.eye(8), (len(fresh), 1)), problem(starts)[0]])
        fresh, keys = problem.new(problem.reached(x, ways, watch), keys)
        found = np.concatenate([found, fresh])
        idle = 0 if len(fresh) else idle + 1
    placed: Real = found + np.tile([points[0].real, points[0].imag], 4)
    return placed


class _Nine:
    """The eight equations."""

    def __init__(self, points: Complex):
        self.steps = (points - points[0])[1:]

    def __call__(self, x: Real) -> tuple[Real, Real]:
        """Residuals (s, 8), from -1 to 1, and their derivatives (s, 8, 8).

        With z, w a pin and its pivot from the first point, e the coupler's rotation and k a step, the pin keeps its
        distance if Re(p e) + q = 0 with p = conj(k - w) z. The two pins determine e, whose square must be 1.
        """
        places, steps = x.view(complex), self.steps
        rows = []
        for pin in (0, 2):
            z, w = places[:, pin, None], places[:, pin + 1, None]
            p = np.conj(steps - w) * z
            q = np.abs(steps) ** 2 / 2 - (np.conj(steps) * w).real + (np.conj(w) * z).real
            way, ones = np.conj(steps - w), np.ones_like(q)
            p_by = np.stack([way, 1j * way, -z * ones, 1j * z * ones], axis=-1)
            q_by = np.stack([w.real * ones, w.imag * ones, z.real - steps.real, z.imag - steps.imag], axis=-1)
            rows.append((p, q, p_by, q_by))
        (p, q, p_by, q_by), (u, v, u_by, v_by) = rows
        top, cross = q * u - v * p, (p * np.conj(u)).imag
        top_by = np.concatenate(
            [q_by * u[..., None] - v[..., None] * p_by, q[..., None] * u_by - v_by * p[..., None]], axis=-1
        )
        cross_by = np.concatenate([(p_by * np.conj(u)[..., None]).imag, (p[..., None] * np.conj(u_by)).imag], axis=-1)
        one, two = np.abs(top) ** 2, cross**2
        one_by, two_by = 2 * (np.conj(top)[..., None] * top_by).real, 2 * cross[..., None] * cross_by
        # Divided by the sum, since both would vanish for coinciding pins, which are no linkage.
        total = one + two
        return (one - two) / total, 2 * (two[..., None] * one_by - one[..., None] * two_by) / total[..., None] ** 2

    def solved(self, x: Real, steps: int, watch: Watch) -> Real:
        """The starts that converge to a solution."""
        done = [np.zeros((0, 8))]
        with np.errstate(all="ignore"):
            residuals, by = self(x)
            sums = np.sum(residuals**2, axis=1)
            damping = np.full(len(x), 1e-2)
            for _ in range(steps):
                square = np.swapaxes(by, 1, 2) @ by
                scale = np.einsum("sii->si", square)
                scale = scale + 1e-9 * scale.max(axis=1, keepdims=True) + 1e-300
                square += (damping[:, None] * scale)[:, :, None] * np.eye(8)
                new = x - _solved(square, np.einsum("sij,si->sj", by, residuals))
                new_residuals, new_by = self(new)
                new_sums = np.sum(new_residuals**2, axis=1)
                better = new_sums < sums
                damping *= np.where(better, np.where(new_sums < 0.5 * sums, 0.1, 0.5), 4.0)
                damping = np.maximum(damping, 1e-14)
                x, residuals = (np.where(better[:, None], a, b) for a, b in ((new, x), (new_residuals, residuals)))
                by, sums = np.where(better[:, None, None], new_by, by), np.where(better, new_sums, sums)
                done.append(x[sums < MET])
                kept = ~(sums < MET) & (damping < 1e8) & np.isfinite(sums)
                x, residuals, by, sums, damping = (row[kept] for row in (x, residuals, by, sums, damping))
                if not len(x) or watch.over():
                    break
        return np.concatenate(done)

    def reached(self, x: Real, ways: Real, watch: Watch) -> Real:
        """Solutions (k, 8) on curves through x (s, 8), along which residuals change by multiples of `ways` (s, 8)."""
        done: list[Real] = [np.zeros((0, 8))]
        for first in range(0, len(x), AT_ONCE):
            if watch.over():
                break
            some = slice(first, first + AT_ONCE)
            done.append(self.solved(self.followed(x[some], ways[some], watch), STEPS, watch))
        return np.concatenate(done)

    def followed(self, x: Real, ways: Real, watch: Watch) -> Real:
        """Points (k, 8) near solutions on these curves, at which the multiple changes its sign."""
        ways = np.repeat(ways / np.linalg.norm(ways, axis=1, keepdims=True), 2, axis=0)
        x = np.repeat(x, 2, axis=0)

        def parted(x: Real, ahead: Real | float = 0.0) -> tuple[Real, Real, Real]:
            """The residuals without their share of the way, their slopes with `ahead` in place of that, the share."""
            residuals, by = self(x)
            share = np.einsum("si,si->s", ways, residuals)
            slope = np.einsum("si,sij->sj", ways, by)
            return residuals - share[:, None] * ways, by + ways[:, :, None] * (ahead - slope)[:, None, :], share

        with np.errstate(all="ignore"):
            _, by, before = parted(x)
            # The solution from which the curve starts does not count again.
            before = np.where(np.abs(before) < 1e-9, 0.0, before)
            x, ways, by, before = (v[np.isfinite(by).all(axis=(1, 2))] for v in (x, ways, by, before))
            # Both directions along each curve.
            ahead = np.linalg.svd(by)[2][:, -1] * np.tile([1.0, -1.0], len(x) // 2)[:, None]
            length = np.full(len(x), FIRST)
            met = [np.zeros((0, 8))]
            for _ in range(FOLLOWED):
                size = length * (1 + np.linalg.norm(x, axis=1))
                guess = x + size[:, None] * ahead
                new = guess
                for _ in range(3):
                    residuals, by, _ = parted(new, ahead)
                    new = new - _solved(by, residuals)
                residuals, by, here = parted(new, ahead)
                onward = _solved(by, ways)
                onward /= np.linalg.norm(onward, axis=1, keepdims=True)
                good = (np.abs(residuals).max(axis=1) < 1e-9) & (np.linalg.norm(new - guess, axis=1) < 0.3 * size)
                good &= np.einsum("si,si->s", onward, ahead) > 0.9
                met.append(((x + new) / 2)[good & (here * before < 0)])
                x, ahead = (np.where(good[:, None], a, b) for a, b in ((new, x), (onward, ahead)))
                before = np.where(good, here, before)
                length = np.where(good, np.minimum(1.6 * length, LONGEST), 0.4 * length)
                going = (length > SHORTEST) & (np.linalg.norm(x, axis=1) < FARTHEST) & self.real(x)
                x, ahead, ways, before, length = (v[going] for v in (x, ahead, ways, before, length))
                if not len(x) or watch.over():
                    break
        return np.concatenate(met)

    @staticmethod
    def real(x: Real) -> Mask:
        """Whether each row is a linkage without links or arms of zero length."""
        pin, pivot, other, other_pivot = x.copy().view(complex).T
        lengths = np.abs([pin, other, pin - other, pin - pivot, other - other_pivot, pivot - other_pivot])
        real: Mask = (lengths.min(axis=0) > NONE) & (lengths.max(axis=0) < 1e3)
        return real

    def new(self, x: Real, keys: Complex) -> tuple[Real, Complex]:
        """Linkages that are not cognates of each other or of those in `keys`, compared by their three common pivots."""
        x = x[self.real(x)]
        pin, pivot, other, other_pivot = x.copy().view(complex).T
        third = pivot - pin / (other - pin) * (other_pivot - pivot)
        kept: list[int] = []
        for k, three in enumerate(np.stack([pivot, other_pivot, third], axis=1)):
            # Symmetric functions, since the three pivots have no order.
            key = np.array([three.sum(), (three**2).sum(), (three**3).sum()])
            size = 1 + float(np.abs(three).max())
            off: Real = np.abs(keys - key) / size ** np.arange(1, 4)
            if np.isfinite(key).all() and not np.any(off.max(axis=1, initial=0.0) < 1e-4):
                keys = np.concatenate([keys, key[None]])
                kept.append(k)
        return x[kept], keys


def _solved(system: Real, right: Real) -> Real:
    """Solutions (s, 8) of systems (s, 8, 8) with scaled rows; nan for singular ones."""
    scale = np.linalg.norm(system, axis=2)
    scaled = np.where(np.isfinite(system).all(axis=(1, 2), keepdims=True), system / scale[:, :, None], np.eye(8))
    try:
        return np.linalg.solve(scaled, (right / scale)[..., None])[..., 0]
    except np.linalg.LinAlgError:
        singular = np.linalg.det(scaled) == 0
        solutions = np.linalg.solve(np.where(singular[:, None, None], np.eye(8), scaled), (right / scale)[..., None])
        return np.where(singular[:, None], np.nan, solutions[..., 0])


def reached(sizes: Real, wanted: Complex) -> tuple[Real, Whole]:
    """Crank angles (n,) from the ground line and branches (n,) at which a four-bar's coupler point is at each point.

    `sizes` are (9,) in the order of `coupler_paths.NAMES`. Of the two angles that reach a point the one consistent with
    the rocker's length is taken.
    """
    ground, crank, coupler, rocker, x, y, origin_x, origin_y, turn = sizes[:9]
    point = (wanted - complex(origin_x, origin_y)) * np.exp(-1j * turn)
    arm = complex(x, y)
    along = (np.abs(point) ** 2 + crank**2 - abs(arm) ** 2) / (2 * np.abs(point))
    across = np.sqrt(np.maximum(crank**2 - along**2, 0.0))
    pins = point / np.abs(point) * (along + 1j * across * np.array([[1.0], [-1.0]]))
    direction = (point - pins) / arm
    ends = pins + coupler * direction / np.abs(direction)
    off = np.abs(np.abs(ends - ground) - rocker)
    best = np.argmin(off, axis=0)
    pin, end = (np.take_along_axis(v, best[None], axis=0)[0] for v in (pins, ends))
    side = np.where((np.conj(ground - pin) * (end - pin)).imag >= 0, 1, -1)
    return np.angle(pin), side


def with_cognates(places: Real, point: complex) -> list[Real]:
    """A linkage by its pins and pivots (8,) and its cognates as rows (10,), as in `linkage.cognates`."""
    pin, pivot, other, other_pivot = (complex(z) for z in places.view(complex))
    crank, coupler, rocker, ground = pin - pivot, other - pin, other - other_pivot, other_pivot - pivot
    share = (point - pin) / coupler
    third = pivot + share * ground
    rest = 1 - share
    links = (
        (pivot, ground, crank, coupler, rocker),
        (pivot, share * ground, share * coupler, share * crank, share * rocker),
        (third, rest * ground, rest * crank, -rest * rocker, -rest * coupler),
    )
    rows = []
    for origin, d, a, b, c in links:
        arm = (point - origin - a) * np.conj(b) / abs(b)
        lengths = [abs(d), abs(a), abs(b), abs(c)]
        rows.append(np.array([*lengths, arm.real, arm.imag, origin.real, origin.imag, np.angle(d), 0.0]))
    return rows
