"""Velocities and accelerations as vectors: polygons of one position, and components along and across links."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...model.check import Check
from ...model.scene import Plot
from ...model.table import Column, finite
from ...plane.vec import Complex, Real, dot, unit
from ..joints.slide import AbstractSlide
from ..linkage import Linkage
from ..motion import Motion, is_rounding
from ..solve.solution import PointMotion

# Largest difference of two components that are equal in a rigid link, as a share of the fastest pin. Rounding is 1e-15,
# and more by the error amplification near a dead centre of the driver.
MOST_DIFFERENCE = 1e-9
Rate = Literal["velocity", "acceleration"]
RATES: Mapping[Rate, str] = {"velocity": "mm/s", "acceleration": "mm/s2"}


@record(eq=False)
class EffectiveComponents:
    """Components along and across a line: that of two pins of a link, or that of a slide whose guide moves.

    Complex numbers have the component along the line as real part, and the component to the left of it as imaginary
    part. All arrays are (frames,), nan where the linkage is open.

    Parameters
    ----------
    direction : array of complex
        Direction of the line on the ground, unit complex: from the first to the second pin.
    position : mapping of str to array of complex
        The two points on the ground, mm, by name.
    velocity, acceleration : mapping of str to array of complex
        Components of both points, mm/s and mm/s2. A pin moves with the next body that it joins, so that two equal
        components of velocity show that the link between them is rigid.
    equal : {"along", "across"}
        Which components of velocity are equal: along a rigid link, across a slide.
    """

    direction: Complex
    position: Mapping[str, Complex]
    velocity: Mapping[str, Complex]
    acceleration: Mapping[str, Complex]
    equal: Literal["along", "across"]

    @property
    def difference(self) -> Real:
        """Difference of the two components of velocity that are equal, mm/s: 0 except for rounding."""
        first, second = self.velocity.values()
        apart = second - first
        return apart.real if self.equal == "along" else apart.imag


@checked
def effective_components(motion: Motion) -> Mapping[str, EffectiveComponents]:
    """Components of the velocity and the acceleration of each pin along and across its link.

    Parameters
    ----------
    motion : Motion
        Motion of one or many linkages.

    Returns
    -------
    mapping of str to EffectiveComponents
        By link: the name of the body; of a body with more than two pins `body_first_second` for each of its sides; of a
        slide on a moving guide the name of the slide, with the guide's point under it first.

    Notes
    -----
    The textbooks' method of effective components: a rigid link has one velocity along its line, so that the component
    of one pin is that of the other. The acceleration of the second pin is that of the first, less the square of the
    link's angular velocity times its length along it, and plus its angular acceleration times its length across it.

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), [1.0], speed=10.0)
    >>> coupler = gk.linkage.effective_components(motion)["coupler"]
    >>> coupler.velocity["crank_pin"].round(3), coupler.velocity["rocker_pin"].round(3)
    (array([-139.167+265.768j]), array([-139.167+65.145j]))
    """
    return {name: _components(direction, ends, equal) for name, direction, ends, equal in _lines(motion)}


Line = tuple[str, Complex, dict[str, PointMotion], Literal["along", "across"]]


def _lines(motion: Motion) -> Iterator[Line]:
    linkage = motion.linkage
    for body, (one, two), name in links(linkage):
        points = linkage.bodies[body]
        direction = motion.bodies[body].direction * unit(points[two] - points[one])
        yield name, direction, {pin: _on_next_body(motion, body, pin) for pin in (one, two)}, "along"
    for slider in linkage.slides:
        if slider.along == linkage.ground:
            continue
        points, guide = linkage.bodies[slider.body], motion.bodies[slider.along]
        pin = next((name for name, z in points.items() if name in linkage.pins and np.all(z == slider.point)), None)
        block = motion.bodies[slider.body].point(slider.point)
        under = guide.point(np.conj(guide.direction) * (block.position - guide.origin.position))
        ends = {f"{slider.name}_on_{slider.along}": under}
        ends[pin or f"{slider.name}_on_{slider.body}"] = _on_next_body(motion, slider.body, pin) if pin else block
        yield slider.name, slider.line(motion), ends, "across"


def links(linkage: Linkage) -> Iterator[tuple[str, tuple[str, str], str]]:
    """Each moving body with two of its pins, and the name of this line: that of the body if it has no other."""
    for body, points in linkage.bodies.items():
        pins = [name for name in points if name in linkage.pins]
        if body == linkage.ground or len(pins) < 2:
            continue
        for one, two in zip(pins, pins[1:] + pins[:1] if len(pins) > 2 else pins[1:]):
            if np.all(points[one] != points[two]):
                yield body, (one, two), body if len(pins) == 2 else f"{body}_{one}_{two}"


def _on_next_body(motion: Motion, body: str, pin: str) -> PointMotion:
    other = next(name for name in motion.linkage.pins[pin] if name != body)
    return motion.bodies[other].point(motion.linkage.bodies[other][pin])


def _components(
    direction: Complex, ends: Mapping[str, PointMotion], equal: Literal["along", "across"]
) -> EffectiveComponents:
    return EffectiveComponents(
        direction,
        {name: end.position for name, end in ends.items()},
        {name: np.conj(direction) * finite(end.velocity) for name, end in ends.items()},
        {name: np.conj(direction) * finite(end.acceleration) for name, end in ends.items()},
        equal,
    )


def number_of_components(linkage: Linkage) -> int:
    """Upper limit of the columns of components."""
    return 8 * (sum(1 for _ in links(linkage)) + len(linkage.slides))


class ComponentVector(NamedTuple):
    """A component of a point's velocity or acceleration along or across a link, (frames,).

    position: of the point, mm; vector: the component on the ground; size: the same, positive along the link and to its
    left; scale: size of the whole velocity or acceleration.
    """

    point: str
    side: Literal["along", "across"]
    link: str
    position: Complex
    vector: Complex
    size: Real
    scale: Real

    def id(self, rate: Rate) -> str:
        """Id of its column."""
        return f"{self.point}_{rate}_{self.side}_{self.link}"


SIDES: tuple[tuple[Literal["along", "across"], complex], ...] = ("along", 1), ("across", 1j)


def component_vectors(motion: Motion, rate: Rate) -> Iterator[ComponentVector]:
    """The components that are more than rounding."""
    for link, line in effective_components(motion).items():
        for point, value in (line.velocity if rate == "velocity" else line.acceleration).items():
            scale = np.abs(value)
            for side, axis in SIDES:
                size = dot(axis, value)
                size = np.where(is_rounding(size, scale), 0.0, size)
                if np.nan_to_num(size).any():
                    vector = size * axis * line.direction
                    yield ComponentVector(point, side, link, line.position[point], vector, size, scale)


def component_columns(motion: Motion) -> Iterator[Column]:
    """Columns of the components of all points that move."""
    for rate, unit_of in RATES.items():
        for part in component_vectors(motion, rate):
            words = f"{rate} of {part.point} {part.side} {part.link}"
            yield Column(part.id(rate), unit_of, words, part.size, finite(part.scale))


def component_plots(motion: Motion) -> Iterator[Plot]:
    """A plot of velocities and one of accelerations for each link."""
    for rate in RATES:
        ids = defaultdict[str, list[str]](list)
        for part in component_vectors(motion, rate):
            ids[part.link].append(part.id(rate))
        for link, columns in ids.items():
            yield Plot(f"{rate} along and across {link.replace('_', ' ')}", tuple(columns))


def components_check(motion: Motion) -> Check:
    """Check that the components of velocity along each rigid link, and across each slide, are equal."""
    lines = effective_components(motion).values()
    speeds = [np.abs(value) for line in lines for value in line.velocity.values()]
    fastest = np.fmax.reduce([np.zeros(motion.assembled.shape), *speeds])
    largest = 0.0
    for line in lines:
        apart = np.where(is_rounding(line.difference, fastest), 0.0, np.abs(line.difference))
        with np.errstate(invalid="ignore", divide="ignore"):
            largest = max(largest, float(np.nan_to_num(apart / fastest).max(initial=0.0)))
    name = "difference of equal effective components, relative to the fastest pin"
    advice = "near a dead centre of the driver digits are lost: give another range of the driver"
    return Check("effective_components", name, largest, "at most", MOST_DIFFERENCE, "", advice)


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
        remedy = "give a frame at which the linkage is assembled and moves"
        raise DesignError("frame", f"frame {frame} is open or at a dead centre", remedy, "does-not-assemble")
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
