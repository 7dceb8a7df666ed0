"""One example of every kind of curve, and the few roads to the truth that several tests take."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path as File

import numpy as np

import geomkin as gk
from geomkin.gear.spur import SpurGear
from geomkin.plane.curve import AbstractCurve, Mirrored, Moved, Offset, Reversed, SubCurve
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.primitives import Arc, Circle, Polyline, Segment, rounded_hull, slot
from geomkin.plane.roulettes import Cycloid, Involute, Trochoid
from geomkin.plane.vec import Pose

RECIPES = File(__file__).parents[2] / "recipes"


@dataclass(frozen=True, eq=False)
class Bezier(AbstractCurve):
    """A cubic by its four control points: no more than the contract asks, and an S where they zigzag."""

    control: tuple[complex, complex, complex, complex]

    def point(self, t):
        a, b, c, d = self.control
        t = np.asarray(t, dtype=float)
        return a * (1 - t) ** 3 + 3 * b * t * (1 - t) ** 2 + 3 * c * t**2 * (1 - t) + d * t**3

    def velocity(self, t):
        a, b, c, d = self.control
        t = np.asarray(t, dtype=float)
        return 3 * ((b - a) * (1 - t) ** 2 + 2 * (c - b) * t * (1 - t) + (d - c) * t**2)

    breaks = np.array([0.0, 1.0])
    closed = False


@dataclass(frozen=True, eq=False)
class Flower(AbstractCurve):
    """r = size (1 + 0.2 cos 5t): closed, without a corner, convex and hollow by turns."""

    size: float
    pieces: int = 10

    def point(self, t):
        t = np.asarray(t, dtype=float)
        return self.size * (1 + 0.2 * np.cos(5 * t)) * np.exp(1j * t)

    def velocity(self, t):
        t = np.asarray(t, dtype=float)
        return self.size * (1j * (1 + 0.2 * np.cos(5 * t)) - np.sin(5 * t)) * np.exp(1j * t)

    @property
    def breaks(self):
        return np.linspace(0, 2 * np.pi, self.pieces + 1)

    closed = True


def examples(s: float = 1.0) -> dict[str, AbstractCurve]:
    """Every class of curve, some millimetres large, all sizes times `s`."""
    bulged = Polyline(s * np.array([0, 4, 5 + 3j, 1 + 4j]), np.array([0.0, 0.6, -0.3, 1.4]))
    hull = s * np.array([0, 4, 2, 5 + 3j, 2 + 2j, 1 + 4j, 3.2 + 1j])
    bend, unwound = Arc(s * (3 + 1j), 3 * s, 2.0), Involute(3 * s, 0.2, 0.9)
    joined = Moved(unwound, Pose(complex(bend.point(1.0) - unwound.point(0.2))))
    turned = Pose(s * (2 - 1j), np.exp(2.1j))
    trochoid = Trochoid(12 * s, 1.2 * s, 0.4 * s, -1.1, 0.3)
    # Joins the end of one third of an outline to the start of the next, a third of a turn on.
    third = Path((Arc(0j, 3 * s + 0j, 1.0), Segment(3 * s * np.exp(1j), 3 * s * np.exp(2j * np.pi / 3))))
    return {
        "segment": Segment(s * (1 + 1j), s * (4 - 1j)),
        "arc": Arc(s * (1 + 1j), s * (3 + 2j), 1.3),
        "arc clockwise over half a turn": Arc(0j, 2 * s + 0j, -4.5),
        "circle": Circle(s * (2 + 1j), 3 * s),
        "polygon": Polyline(s * np.array([0, 4, 4 + 3j, 2 + 1j])),
        "open polyline": Polyline(s * np.array([0, 1 + 2j, 3, 3 + 3j]), None, False),
        "bulged": bulged,
        "bulged open": Polyline(s * np.array([0, 3, 3 + 2j, 5 + 5j]), np.array([0.4, -1.0, 0.0]), False),
        "hull of one": rounded_hull([s * (1 + 1j)], 2 * s),
        "slot": slot(s * (1 - 1j), s * (4 + 1j), 0.7 * s),
        "hull of three": rounded_hull(s * np.array([0, 5, 1 + 3j]), 0.8 * s),
        "hull of many": rounded_hull(hull, 0.5 * s),
        "hull of a row": rounded_hull(s * np.array([0, 2 + 1j, 4 + 2j, 1 + 0.5j]), 0.6 * s),
        "involute from its cusp": Involute(3 * s, 0.0, 1.2),
        "involute": Involute(3 * s, 0.3, 1.5),
        "epicycloid": Cycloid(12 * s, 3 * s, 0.2, 1.2),
        "hypocycloid": Cycloid(12 * s, -2 * s, 0.2, 0.9),
        "trochoid": trochoid,
        "trochoid of a point": Trochoid(12 * s, 1.2 * s, 0.0, -1.1, 0.3),
        "trochoid outside": Trochoid(12 * s, -0.9 * s, 0.4 * s, -0.9, 1.0),
        "trochoid of a point outside": Trochoid(12 * s, -0.9 * s, 0.0, -0.9, 1.0),
        "trochoid at once": Trochoid(12 * s, 1e-9 * s, 0.4 * s, -1.1, 0.3),
        "trochoid at no depth": Trochoid(12 * s, 0.0, 0.4 * s, -1.1, 0.3),
        "ring": PolarArray(third, 3),
        "moved": Moved(bulged, turned),
        "moved trochoid": Moved(trochoid, turned),
        "reversed": Reversed(bulged),
        "reversed trochoid": Reversed(trochoid),
        "reversed ring": Reversed(PolarArray(third, 3)),
        "mirrored": Mirrored(Involute(3 * s, 0.3, 1.5)),
        "mirrored path": Mirrored(Path((Involute(3 * s, 0.3, 1.5),))),
        "offset": Offset(trochoid, -0.3 * s),
        "offset outline": Offset(slot(0j, 4 * s + 0j, s), 0.5 * s),
        "offset past the centre": Offset(Circle(1j * s, 3 * s), -5 * s),
        "offset of a plain contract": Offset(Bezier((0j, s * (2 + 1j), s * (3 - 1j), s * (5 + 1j))), 0.2 * s),
        "stretch": SubCurve(bulged, np.array([1.0, 2.0, 3.0])),
        "bezier": Bezier((0j, s * (3 + 4j), s * (1 - 4j), 4 * s + 0j)),
        "flower": Flower(3 * s),
        "path": Path((Segment(0j, 3 * s), bend, joined)),
    }


def flank() -> AbstractCurve:
    return SpurGear(24, 2).flank


def cam_profile() -> AbstractCurve:
    return gk.load(RECIPES / "roller-cam.toml").cam.profile


def size(curve: AbstractCurve) -> float:
    """Diagonal of the box about a dense sample."""
    z = curve.point(np.linspace(curve.breaks[0], curve.breaks[-1], 2001))
    return abs(complex(np.ptp(z.real), np.ptp(z.imag)))


def inside(curve: AbstractCurve, count: int = 9, margin: float = 0.01) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (pieces, count) off the breaks, and the length of each piece (pieces, 1)."""
    b = curve.breaks
    span = np.diff(b)[:, None]
    return b[:-1, None] + span * np.linspace(margin, 1 - margin, count), span


def derivative(f, t, h):
    """Central difference of order six."""
    return sum(k * (f(t + j * h) - f(t - j * h)) for j, k in ((1, 45), (2, -9), (3, 1))) / (60 * h)


def off_chord(a, b, p):
    """Distance of points from the segments a-b."""
    share = np.clip(np.real(np.conj(b - a) * (p - a)) / np.maximum(np.abs(b - a) ** 2, 1e-300), 0, 1)
    return np.abs(p - a - share * (b - a))


def edges(line: Polyline) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, end and bulge of each edge."""
    z = np.asarray(line.vertices, dtype=complex)
    bulges = np.zeros(len(z) - (not line.closed)) if line.bulges is None else np.asarray(line.bulges, dtype=float)
    return z[: len(bulges)], np.roll(z, -1)[: len(bulges)], bulges


def off_arcs(a, b, bulge, p):
    """Distance of points from arcs by school geometry: from the rim inside the sector, from an end outside it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = (a + b) / 2 + 1j * (b - a) * (1 - bulge**2) / (4 * bulge)
        turned = np.angle((p - centre) / (a - centre)) * np.sign(bulge) % (2 * np.pi)
        rim = np.where(turned <= 4 * np.arctan(np.abs(bulge)), np.abs(np.abs(p - centre) - np.abs(a - centre)), np.inf)
    ends = np.minimum(np.abs(p - a), np.abs(p - b))
    # Where the rise is below rounding the arc is its chord.
    return np.where(np.abs(bulge) < 1e-7, off_chord(a, b, p), np.fmin(rim, ends))
