"""Effective components: velocities and accelerations of pins along and across the links that they belong to."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

import numpy as np

from ...core.arguments import checked
from ...core.records import record
from ...model.check import Check
from ...model.scene import Plot
from ...model.table import Column, finite
from ...plane.vec import Complex, Real, dot, unit
from ..body_motion import PointMotion
from ..linkage import Linkage
from ..motion import Motion, is_rounding

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
