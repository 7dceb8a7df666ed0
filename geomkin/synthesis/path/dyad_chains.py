"""Chains of dyads driven by one crank, or by two geared ones, many at once: four- to eight-bars with all derivatives.

Body 0 is the ground, body 1 the crank, and body -1 the second crank of geared chains. Dyad j joins a point P of one
body and a point Q of another by two links that meet at R, and so adds the bodies 2 + 2 j, from P to R, and 3 + 2 j,
from Q to R. The traced point belongs to the first link of the last dyad. A point of a body is o + c e, with c a
constant, e = 1 for the ground, exp(i crank) for the crank, exp(i ratio crank) for the geared one, R - P or R - Q for a
link. Signs are fixed, so that a chain that closes everywhere has no branch or circuit defect.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from itertools import product

import numpy as np

from ...core.records import record
from ...linkage.joints.gear_mesh import GearMesh
from ...linkage.linkage import Linkage
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Mask, Real, Whole, cross, dot

# Unknowns of each dyad: x, y of P and of Q in their bodies, logarithms of both links.
PER_DYAD = 6
# Angles of random chains, and tries of each dyad's links.
ANGLES, TRIES = 64, 8
# Limits of transmission angles, deg, and of the ratio of lengths of random chains.
RANDOM_DEG, RANDOM_RATIO = 22.0, 14.0
GROUND, CRANK, GEARED = 0, 1, -1
# Ratios of geared cranks.
RATIOS = np.array([-1.0, 1.0, -2.0, 2.0, -3.0, 3.0])
# Least and largest number of teeth of the smallest gear, and the module, mm, for which it is chosen between them.
SMALLEST_GEAR, TEETH_MODULE = (18, 60), 3.0


@record(eq=False)
class Chains:
    """s chains of n dyads.

    Parameters
    ----------
    bodies : array of int, shape (s, n, 2)
        Bodies of P and Q of each dyad.
    signs : array, shape (s, n)
        +1 if R is to the left of the line from P to Q.
    x : array, shape (s, 4 + 2 g + 6 n)
        Crank pivot, that of the geared crank, the unknowns of each dyad, and the traced point in its body, real and
        imaginary parts.
    ratios : array, shape (s, g)
        Ratio of the geared crank; g is 1 with gears and 0 without.
    """

    bodies: Whole
    signs: Real
    x: Real
    ratios: Real

    def __len__(self) -> int:
        return len(self.x)

    def __getitem__(self, rows: Whole | slice) -> Chains:
        return Chains(self.bodies[rows], self.signs[rows], self.x[rows], self.ratios[rows])

    @property
    def dyads(self) -> int:
        """Number of dyads of each."""
        return int(self.bodies.shape[1])

    @property
    def bars(self) -> int:
        """Number of bars of each, with the ground."""
        return 2 + 2 * self.dyads + self.is_geared

    @property
    def is_geared(self) -> bool:
        """Whether they have a geared crank."""
        return bool(self.ratios.shape[1])

    @property
    def head(self) -> int:
        """Number of unknowns before those of the dyads."""
        return 2 + 2 * self.is_geared

    @property
    def pins(self) -> Complex:
        """P and Q of each dyad in their bodies, (s, n, 2)."""
        places: Complex = self._parts[..., :4].reshape(len(self), self.dyads, 2, 2) @ np.array([1, 1j])
        return places

    @property
    def logs(self) -> Real:
        """Logarithms of both links of each dyad, (s, n, 2)."""
        return self._parts[..., 4:]

    @property
    def _parts(self) -> Real:
        return self.x[:, self.head : -2].reshape(len(self), self.dyads, PER_DYAD)

    def placed(self, factor: Complex, shift: Complex, mirrored: np.ndarray) -> Chains:
        """The chains mirrored about the x axis where asked, then rotated and scaled by `factor` and shifted."""
        x, signs = self.x.copy(), np.where(mirrored[:, None], -self.signs, self.signs)
        flip, head = np.where(mirrored, -1.0, 1.0), self.head
        # All imaginary parts.
        x[:, [*range(1, head, 2), -1]] *= flip[:, None]
        parts = x[:, head:-2].reshape(len(x), self.dyads, PER_DYAD)
        parts[..., [1, 3]] *= flip[:, None, None]
        parts[..., 4:] += np.log(np.abs(factor))[:, None, None]
        pins = parts[..., :4].reshape(len(x), self.dyads, 2, 2) @ np.array([1, 1j])
        scaled = pins * factor[:, None, None]
        pins = np.where(
            self.bodies == GROUND, scaled + shift[:, None, None], np.where(self.bodies <= CRANK, scaled, pins)
        )
        parts[..., 0:4:2], parts[..., 1:4:2] = pins.real, pins.imag
        pivots = (x[:, 0:head:2] + 1j * x[:, 1:head:2]) * factor[:, None] + shift[:, None]
        x[:, 0:head:2], x[:, 1:head:2] = pivots.real, pivots.imag
        x[:, head:-2] = parts.reshape(len(x), self.dyads * PER_DYAD)
        return replace(self, signs=signs, x=x)


def joined(several: list[Chains]) -> Chains:
    """All of several batches with one number of dyads."""
    return Chains(*(np.concatenate([getattr(one, f.name) for one in several]) for f in fields(Chains)))


@record(eq=False)
class ChainMotion:
    """s chains at T crank angles.

    origin, ahead (2 + 2 n + g, s, T): each body's o and e; point (s, T): traced points; by (s, 1 + p, T): their
    derivatives by the crank angle and by the unknowns; folding (s, n, T): cosines of transmission angles; folding_by
    (s, n, 1 + p, T). nan if a chain does not close.
    """

    origin: Complex
    ahead: Complex
    point: Complex
    by: Complex
    folding: Real
    folding_by: Real


def traced(chains: Chains, cranks: Real, derivatives: bool = True) -> ChainMotion:
    """Positions of the chains at crank angles (s, T), and the derivatives if these are asked for. Derived here."""
    s, n, p = len(chains), chains.dyads, chains.x.shape[1]
    row, samples = np.arange(s), cranks.shape[1]
    pins, logs, bodies = chains.pins, chains.logs, chains.bodies
    count, head = 2 + 2 * n + chains.is_geared, chains.head
    origin, ahead = np.zeros((count, s, samples), dtype=complex), np.ones((count, s, samples), dtype=complex)
    origin[CRANK], ahead[CRANK] = (chains.x[:, 0] + 1j * chains.x[:, 1])[:, None], np.exp(1j * cranks)
    width = 1 + p if derivatives else 0
    origin_by, ahead_by = (np.zeros((count, s, width, samples), dtype=complex) for _ in range(2))
    folding, folding_by = np.zeros((s, n, samples)), np.zeros((s, n, width, samples))
    if derivatives:
        origin_by[CRANK, :, 1], origin_by[CRANK, :, 2], ahead_by[CRANK, :, 0] = 1, 1j, 1j * ahead[CRANK]
    if chains.is_geared:
        origin[GEARED], ahead[GEARED] = (chains.x[:, 2:3] + 1j * chains.x[:, 3:4]), np.exp(1j * chains.ratios * cranks)
        if derivatives:
            origin_by[GEARED, :, 3], origin_by[GEARED, :, 4] = 1, 1j
            ahead_by[GEARED, :, 0] = 1j * chains.ratios * ahead[GEARED]
    for j in range(n):
        first, second = bodies[:, j, 0], bodies[:, j, 1]
        to_p, to_q = ahead[first, row], ahead[second, row]
        at_p, at_q = (pins[:, j, k, None] for k in (0, 1))
        one_end, other_end = origin[first, row] + at_p * to_p, origin[second, row] + at_q * to_q
        across = other_end - one_end
        square = across.real**2 + across.imag**2
        one, two = (np.exp(2 * logs[:, j, k])[:, None] for k in (0, 1))
        along = 0.5 + (one - two) / (2 * square)
        with np.errstate(invalid="ignore"):
            height = chains.signs[:, j, None] * np.sqrt(one / square - along**2)
        u = across * (along + 1j * height)
        v = u - across
        origin[2 + 2 * j], origin[3 + 2 * j], ahead[2 + 2 * j], ahead[3 + 2 * j] = one_end, other_end, u, v
        both = np.sqrt(one * two)
        folding[:, j] = dot(u, v) / both
        if not derivatives:
            continue
        known, new = 1 + head + PER_DYAD * j, 1 + head + PER_DYAD * (j + 1)
        p_by, q_by = np.zeros((2, s, new, samples), dtype=complex)
        for by, of, at, to, k in ((p_by, first, at_p, to_p, known), (q_by, second, at_q, to_q, known + 2)):
            by[:, :known] = origin_by[of, row, :known] + at[:, None] * ahead_by[of, row, :known]
            by[:, k], by[:, k + 1] = to, 1j * to
        # u' and v' have u.u' = u.(R' - P') = one (ln l1)' and alike for v; R' = (b i u - a i v) / u x v.
        a, b = dot(u[:, None], p_by), dot(v[:, None], q_by)
        a[:, known + 4] = one
        b[:, known + 5] = two
        with np.errstate(invalid="ignore", divide="ignore"):
            turned = 1j / cross(u, v)
        r_by = b * (u * turned)[:, None] - a * (v * turned)[:, None]
        u_by, v_by = r_by - p_by, r_by - q_by
        for body, by, ahead_of in ((2 + 2 * j, p_by, u_by), (3 + 2 * j, q_by, v_by)):
            origin_by[body, :, :new], ahead_by[body, :, :new] = by, ahead_of
        folding_by[:, j, :new] = (dot(u_by, v[:, None]) + dot(u[:, None], v_by)) / both[:, None]
        folding_by[:, j, known + 4 : known + 6] -= folding[:, j, None]
    arm = (chains.x[:, -2] + 1j * chains.x[:, -1])[:, None]
    point, by = origin[2 * n] + arm * ahead[2 * n], origin_by[2 * n] + arm[:, None] * ahead_by[2 * n]
    if derivatives:
        by[:, -2], by[:, -1] = ahead[2 * n], 1j * ahead[2 * n]
    return ChainMotion(origin, ahead, point, by, folding, folding_by)


@cache
def kinds_of(bars: int) -> Whole:
    """Bodies (k, dyads, 2) of P and Q of all chains of so many bars that are searched.

    Six-bars: Watt I, Watt II, Stephenson I and III. Eight-bars: each of these with a third dyad on one of its last
    links, and two four-bars on one crank that a third dyad joins. Five- and seven-bars have two geared cranks.
    """
    first = (CRANK, GEARED) if bars % 2 else (CRANK, GROUND)
    if bars < 6:
        return np.array([[first]])
    if bars == 7:
        return np.array([(first, (p, q)) for p, q in product(range(-1, 4), repeat=2) if p != q and p and max(p, q) > 1])
    if bars == 6:
        pairs = ((2, 3), (3, 2), (1, 2), (2, 1), (3, 0), (1, 3), (3, 1), (2, 0))
        return np.array([(first, pair) for pair in pairs])
    last = [(p, q) for p, q in product(range(6), repeat=2) if p != q and p and (p > 3 or q > 3)]
    kinds = [(first, pair, end) for pair in ((2, 3), (1, 2), (3, 0), (1, 3), (2, 0)) for end in last]
    two_four_bars = [pair for p, q in product((2, 3), (4, 5)) for pair in ((p, q), (q, p))]
    return np.array([*kinds, *((first, first, end) for end in two_four_bars)])


def stacks(bodies: Whole) -> Mask:
    """Whether flat plates of chains (s, n, 2) mostly pass each other, (s,), as stacks of many chains showed.

    Each crank carries one link, or its links would turn fully past pins of each other, and the first two dyads have an
    end on a fixed shaft.
    """
    links = [np.count_nonzero(bodies == crank, axis=(1, 2)) for crank in (CRANK, GEARED)]
    outer = np.all(np.any(bodies[:, :2] <= CRANK, axis=2), axis=1)
    return np.asarray(outer & (links[0] == 1) & (links[1] <= 1))


def random_chains(bars: int, rng: np.random.Generator, count: int) -> Chains:
    """At most `count` random chains whose cranks, of length 1, turn fully."""
    kinds, none = kinds_of(bars), np.zeros((count, 0))
    bodies = kinds[rng.integers(0, len(kinds), count)]
    chains = Chains(bodies[:, :0], none, np.zeros((count, 4)), none)
    if bars % 2:
        pivot = np.exp(rng.uniform(np.log(0.25), np.log(7), count) + 2j * np.pi * rng.random(count))
        x = np.zeros((count, 6))
        x[:, 2], x[:, 3] = pivot.real, pivot.imag
        chains = replace(chains, x=x, ratios=rng.choice(RATIOS, (count, 1)))
    for j in range(bodies.shape[1]):
        chains, kept = extended(chains, bodies[:, j], rng)
        bodies = bodies[kept]
    chains.x[:, -2:] = [0.5, 0.0] + 0.8 * rng.normal(size=(len(chains), 2))
    return chains


def extended(
    chains: Chains, pair: Whole, rng: np.random.Generator, at_p: Complex | None = None
) -> tuple[Chains, Whole]:
    """The chains with another random dyad on the bodies `pair` (s, 2), and their rows; some cannot have one.

    With `at_p` (s,) the points P are given. The new traced point is P.
    """
    s, n = len(chains), chains.dyads
    cranks = np.broadcast_to(2 * np.pi * np.arange(ANGLES) / ANGLES, (s, ANGLES))
    crank_length = np.abs(chains.pins[:, 0, 0]) if n else np.ones(s)
    at = (0.5 + 0.8 * (rng.normal(size=(s, 2)) + 1j * rng.normal(size=(s, 2)))).astype(complex)
    spin = np.exp(1j * rng.uniform(0, 2 * np.pi, (s, 2)))
    radius = np.exp(rng.uniform(np.log(0.35), np.log(3), (s, 2))) if n or chains.is_geared else np.ones((s, 2))
    radius[:, 0] = radius[:, 0] if n else 1.0
    at = np.where(abs(pair) == CRANK, radius * spin * crank_length[:, None], at)
    if at_p is not None:
        at[:, 0] = at_p
    moved, row = traced(chains, cranks, derivatives=False), np.arange(s)
    one_end = moved.origin[pair[:, 0], row] + at[:, 0, None] * moved.ahead[pair[:, 0], row]
    middle = one_end.mean(axis=1)
    size = np.sqrt(np.mean(np.abs(one_end - middle[:, None]) ** 2, axis=1))
    low, high = (0.25, 7.0) if n == 0 else (0.7, 5.0)
    away = middle + size * np.exp(rng.uniform(np.log(low), np.log(high), s)) * spin[:, 1]
    at[:, 1] = np.where(pair[:, 1] == GROUND, away, at[:, 1])
    other_end = moved.origin[pair[:, 1], row] + at[:, 1, None] * moved.ahead[pair[:, 1], row]
    distance = np.abs(other_end - one_end)
    near, far = distance.min(axis=1), distance.max(axis=1)
    logs = np.log(far)[:, None, None] + rng.uniform(-1.3, 0.7, (s, TRIES, 2))
    one, two = np.exp(logs[..., 0]), np.exp(logs[..., 1])
    ends = [(one**2 + two**2 - d[:, None] ** 2) / (2 * one * two) for d in (near, far)]
    good = np.maximum(*np.abs(ends)) <= np.cos(np.radians(RANDOM_DEG))
    good &= np.maximum(one, two) / np.minimum(one, two) <= RANDOM_RATIO
    good &= np.maximum(one, two) <= RANDOM_RATIO * crank_length[:, None]
    kept = np.flatnonzero(good.any(axis=1))
    logs = logs[kept, np.argmax(good[kept], axis=1)]
    dyad = np.stack([at.real, at.imag], axis=-1).reshape(s, 4)[kept]
    zero = np.zeros((len(kept), 2))
    x = np.concatenate([chains.x[kept, :-2], dyad, logs, zero], axis=1)
    sign = rng.choice([-1.0, 1.0], (s, 1))[kept]
    bodies = np.concatenate([chains.bodies[kept], pair[kept, None]], axis=1)
    return Chains(bodies, np.concatenate([chains.signs[kept], sign], axis=1), x, chains.ratios[kept]), kept


def linkage_of(chain: Chains, row: int, scale: float, middle: complex) -> tuple[FourBar | Linkage, int]:
    """One of the chains as a linkage with the traced point "coupler_point", mm, and its branch.

    The two bodies of a dyad are in the order in which its branch is +1.
    """
    pins, lengths = chain.pins[row] * scale, np.exp(chain.logs[row]) * scale
    pivot, arm = complex(chain.x[row, 0], chain.x[row, 1]) * scale, complex(chain.x[row, -2], chain.x[row, -1])
    origin, forwards = pivot + middle, complex(np.exp(-1j * np.angle(pins[0, 0])))
    if chain.bars == 4:
        ground = complex(pins[0, 1]) - pivot
        sizes = (abs(ground), abs(complex(pins[0, 0])), float(lengths[0, 0]), float(lengths[0, 1]))
        angle = float(np.degrees(np.angle(ground)))
        return FourBar(*sizes, arm * sizes[2], origin=origin, ground_angle_deg=angle), int(chain.signs[row, 0])
    rocker, pivot_name = ("link", "geared_pin") if chain.is_geared else ("rocker", "rocker_pivot")
    further = (f"link_{k}" for k in range(5, 3 + 2 * chain.dyads))
    names = ["ground", "crank", "coupler", rocker, *further, "geared_crank"]
    points: list[dict[str, complex]] = [{"crank_pivot": 0j} for _ in range(2)] + [{} for _ in names[2:]]
    meshes = _geared(chain, row, scale, points)
    second = complex(np.exp(-1j * np.angle(pins[0, 1]))) if chain.is_geared else 1.0
    for j, pair in enumerate(chain.bodies[row].tolist()):
        links = (2 + 2 * j, 3 + 2 * j)
        joint = f"{rocker}_pin" if j == 0 else f"pin_{links[0] + 1}_{links[1] + 1}"
        for k, body in enumerate(pair):
            place = complex(pins[j, k])
            if body == GROUND:
                place -= pivot
            elif body <= CRANK:
                place *= forwards if body == CRANK else second
            else:
                place *= lengths[(body - 2) // 2, (body - 2) % 2] / scale
            further_pin = f"{'pivot' if body == GROUND else 'pin'}_{links[k] + 1}"
            pin = further_pin if j else ("crank_pin", pivot_name)[k]
            points[body][pin] = complex(place)
            points[links[k]] = {pin: 0j, joint: complex(lengths[j, k])}
    points[2 * chain.dyads]["coupler_point"] = arm * lengths[-1, 0]
    order = [GROUND, CRANK, *([GEARED] if chain.is_geared else [])]
    for j, sign in enumerate(chain.signs[row].tolist()):
        order += [2 + 2 * j, 3 + 2 * j][:: 1 if sign > 0 else -1]
    bodies = {names[b]: points[b] for b in order} | ({"idler": {"idler_pivot": 0j}} if len(meshes) > 1 else {})
    return Linkage(bodies, "crank", origin=origin, meshes=meshes), 1


def _geared(chain: Chains, row: int, scale: float, points: list[dict[str, complex]]) -> tuple[GearMesh, ...]:
    """The meshes of both cranks, with an idler if these turn in one sense; pivots are added to the points."""
    if not chain.is_geared:
        return ()
    ratio, pins = float(chain.ratios[row, 0]), chain.pins[row, 0]
    at = complex(chain.x[row, 2] - chain.x[row, 0], chain.x[row, 3] - chain.x[row, 1]) * scale
    units = abs(ratio) + 1 + 2 * (ratio > 0)
    smallest = int(np.clip(2 * abs(at) / (TEETH_MODULE * units), *SMALLEST_GEAR))
    teeth = (smallest * round(abs(ratio)), smallest)
    points[GROUND]["geared_pivot"], points[GEARED]["geared_pivot"] = at, 0j
    # Both cranks have their first pins on +x of their frames.
    angle = float(np.degrees(np.angle(pins[1] * np.exp(-1j * ratio * np.angle(pins[0])))))
    if ratio < 0:
        return (GearMesh("gears", "crank", "geared_crank", teeth, angle),)
    points[GROUND]["idler_pivot"] = at * (abs(ratio) + 1) / units
    ends = (teeth[0], smallest), (smallest, smallest)
    return GearMesh("gears", "crank", "idler", ends[0]), GearMesh(
        "idler_gears", "idler", "geared_crank", ends[1], angle
    )
