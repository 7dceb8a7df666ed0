"""Velocity and acceleration polygons: one position of a linkage as vectors from a pole, to scale."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex
from ..joints.slide import AbstractSlide
from ..motion import Motion


@record
class PolygonVector:
    """One vector of a polygon.

    Parameters
    ----------
    kind : str
        "absolute" (pole to a point), "difference" (point to point of one body), "normal" and "tangential" (its parts in
        an acceleration polygon), "sliding" (of a slider on its guide) or "coriolis".
    body : str
        The body of both points; for sliding and Coriolis vectors the slider's body.
    start, end : str
        Names of the points; for a part, those of the whole.
    tail, tip : complex
        mm on the drawing.
    value : complex
        mm/s or mm/s2.
    """

    kind: str
    body: str
    start: str
    end: str
    tail: complex
    tip: complex
    value: complex


@record
class VectorPolygon:
    """Velocities or accelerations of all named points, drawn from the pole at 0.

    Parameters
    ----------
    scale : float
        mm on the drawing per mm/s or mm/s2.
    points : mapping of str to complex
        End of each named point's vector from the pole, mm; fixed points, and `POLE`, are at the pole.
    vectors : tuple of PolygonVector
        Absolute ones first.
    images : mapping of str to tuple of str
        For each moving body with two or more points, its points in order. They span its image, a figure similar to the
        body: turned by 90 deg and omega times as large for velocities, |i alpha - omega^2| times for accelerations
        (Mehmke's theorem).
    """

    scale: float
    points: Mapping[str, complex]
    vectors: tuple[PolygonVector, ...]
    images: Mapping[str, tuple[str, ...]]


# Name of the pole, the image of all points at rest.
POLE = "pole"
# Share of the largest vector below which one counts as zero and is omitted.
ROUNDING = 1e-12


@checked
def velocity_polygon(motion: Motion, frame: int = 0, size: float = 100.0, scale: float | None = None) -> VectorPolygon:
    """Velocity polygon of one frame.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    frame : int
        Index of the frame; may be negative, from the end.
    size : float
        Largest side of the polygon, mm.
    scale : float, optional
        mm per mm/s; by default the largest of 1, 2, 5, 10, ... that keeps the polygon within `size`.

    Returns
    -------
    VectorPolygon
        If a slider's guide moves, the guide's point under the slider is named "slide on guide" after both; the sliding
        velocity leads from there to the slider's point.

    Raises
    ------
    DesignError
        If the linkage is open at the frame, its velocities are not finite, or nothing moves and no scale is given.

    Notes
    -----
    Derived here.
    """
    return _polygon(motion, frame, 1, size, scale)


@checked
def acceleration_polygon(
    motion: Motion, frame: int = 0, size: float = 100.0, scale: float | None = None
) -> VectorPolygon:
    """Acceleration polygon of one frame.

    Parameters
    ----------
    motion, frame, size
        As for `velocity_polygon`.
    scale : float, optional
        mm per mm/s2.

    Returns
    -------
    VectorPolygon
        The acceleration of one point of a body relative to another consists of its normal part, -omega^2 r, and its
        tangential part, i alpha r. From a moving guide's point lead the Coriolis part, 2 i omega v, and the sliding
        part.

    Raises
    ------
    DesignError
        As for `velocity_polygon`.

    Notes
    -----
    Derived here.
    """
    return _polygon(motion, frame, 2, size, scale)


def _polygon(motion: Motion, frame: int, order: Literal[1, 2], size: float, scale: float | None) -> VectorPolygon:
    for field, given in (("size", size), ("scale", scale)):
        if given is not None and not 0 < given < np.inf:
            raise DesignError(field, f"found {given}", "give a number above 0", "out-of-range")
    frames = len(motion.drive)
    if not -frames <= frame < frames:
        raise DesignError(
            "frame", f"found {frame}", f"give 0 to {frames - 1}: the motion has {frames} frames", "out-of-range"
        )
    parts, value, members = polygon_parts(motion, order, frame)
    if not np.isfinite(np.array(list(value.values()))).all():
        raise DesignError(
            "frame",
            f"frame {frame} is open or at a dead centre",
            "give a frame at which the linkage is assembled and moves",
            "does-not-assemble",
        )
    reached = np.array([0j, *(part.tip for part in parts)])
    least = ROUNDING * float(np.abs(reached).max())
    if scale is None:
        scale = round_scale(float(max(np.ptp(reached.real), np.ptp(reached.imag))), size)
    ground = motion.linkage.ground
    return VectorPolygon(
        scale,
        {name: scale * complex(z) for name, z in value.items()},
        tuple(
            PolygonVector(
                p.kind, p.body, p.start, p.end, scale * complex(p.tail), scale * complex(p.tip), complex(p.tip - p.tail)
            )
            for p in parts
            if np.abs(p.tip - p.tail) > least
        ),
        {body: points for body, points in members.items() if body != ground and len(points) > 1},
    )


class PolygonPart(NamedTuple):
    """A vector of a polygon like `PolygonVector`, with its ends in mm/s or mm/s2, for one frame or many."""

    kind: str
    body: str
    start: str
    end: str
    tail: Complex
    tip: Complex


def polygon_parts(
    motion: Motion, order: Literal[1, 2], frame: int | slice
) -> tuple[list[PolygonPart], dict[str, Complex], dict[str, tuple[str, ...]]]:
    """Vectors of the velocity (order 1) or acceleration polygon (order 2) at a frame, or over a slice of frames.

    Also returns the end of each point's vector from the pole, and the points of each body. Vectors of length 0 are
    included. nan where the linkage is open. Derived here.
    """
    linkage, ground = motion.linkage, motion.linkage.ground
    members: dict[str, dict[str, Complex | complex]] = {b: dict(points) for b, points in linkage.bodies.items()}
    sliding: list[tuple[AbstractSlide, str, str]] = []
    for slider in linkage.slides:
        point = next(
            (n for n, z in members[slider.body].items() if z == slider.point), f"{slider.name} on {slider.body}"
        )
        members[slider.body][point] = slider.point
        under = POLE
        if slider.along != ground:
            under, guide = f"{slider.name} on {slider.along}", motion.bodies[slider.along]
            on_slider = motion.bodies[slider.body].point(slider.point).position[frame]
            local = (on_slider - guide.origin.position[frame]) * np.conj(guide.direction[frame])
            members[slider.along][under] = local
        sliding.append((slider, under, point))

    still = 0 * motion.bodies[ground].origin.velocity[frame]
    value, owner = {POLE: still}, {POLE: ground}
    for body, points in members.items():
        for name in [n for n in points if n not in owner]:
            at = motion.bodies[body].point(points[name])
            value[name], owner[name] = (at.velocity if order == 1 else at.acceleration)[frame], body
    parts = [
        PolygonPart("absolute", body, POLE, name, still, value[name]) for name, body in owner.items() if body != ground
    ]
    for body, points in members.items():
        if body == ground:
            continue
        names = list(points)
        for one, two in zip(names, names[1:] + names[:1] if len(names) > 2 else names[1:]):
            parts.append(PolygonPart("difference", body, one, two, value[one], value[two]))
            if order == 2:
                pose = motion.bodies[body]
                arm = pose.direction[frame] * (points[two] - points[one])
                knee = value[one] - pose.omega[frame] ** 2 * arm
                parts.append(PolygonPart("normal", body, one, two, value[one], knee))
                parts.append(PolygonPart("tangential", body, one, two, knee, value[two]))
    for slider, under, point in sliding:
        knee = value[under]
        if order == 2 and slider.along != ground:
            knee = knee + motion.slide(slider.name).coriolis[frame]
            parts.append(PolygonPart("coriolis", slider.body, under, point, value[under], knee))
        parts.append(PolygonPart("sliding", slider.body, under, point, knee, value[point]))
    return parts, value, {body: tuple(points) for body, points in members.items()}


def round_scale(extent: float, size: float) -> float:
    """The largest of 1, 2 or 5 times a power of 10 that scales an extent to within a size."""
    if extent == 0:
        raise DesignError("motion", "found every point at rest", "give the driver a speed, or a scale", "out-of-range")
    largest = size / extent
    ten = 10.0 ** np.floor(np.log10(largest))
    return float(next(step * ten for step in (5, 2, 1) if step * ten <= largest * (1 + 1e-12)))
