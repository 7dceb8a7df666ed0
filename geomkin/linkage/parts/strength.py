"""Whether pins and plates of a linkage hold under its joint forces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import field, replace
from itertools import permutations

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.records import record
from ...making.fasteners import MINOR_DEPTH
from ...model.check import Check
from ...model.part import Part
from ...plane.flatten import flatten
from ...plane.vec import Array, Complex, Real, cross, dot
from ..checks import in_driver_unit
from ..drive_limits import largest_between, moved_to
from ..dynamics.inverse import ForceAnalysis
from ..dynamics.wrenches import Wrenches
from ..motion import Motion
from .plates import pins_on_axes
from .stack import Stack, link_parts, stack_links
from .stock import LinkStock

# Largest mean shear stress of pins, N/mm2: half of the yield strength of 240 N/mm2 (screws of property class 4.6, ISO
# 898-1; bright bars of S235), by the criterion of Tresca, over a safety of 2 chosen here.
MOST_PIN_SHEAR = 60.0
# Least ratio of the strength that a material carries to the nominal stress of a plate; chosen here. Next to a hole the
# stress is 2 to 3 times the nominal one.
LEAST_PLATE_SAFETY = 4.0
# Sections between two holes, beginning with that through the first.
SECTIONS = 8
# Ratio to the limit from which a unit is probably wrong by 1,000.
WRONG_UNIT = 500.0
# Tolerance of outlines as a share of the bar's width.
FINE = 1e-4


@record(eq=False)
class PlateLoads(Wrenches):
    """Forces on each body one by one, as needed for sections of its plate.

    Parameters
    ----------
    acting : dict of str to list
        Body to pairs of a place, mm in the body's frame, and a force there, N on the ground; one value or one for each
        frame.
    couples : dict of str to list
        Body to pairs of a place and a couple, N mm.
    """

    acting: dict[str, list[tuple[Array, Array]]] = field(init=False, default_factory=dict)
    couples: dict[str, list[tuple[Array, Array]]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        Wrenches.__post_init__(self)
        for body in self.motion.linkage.bodies:
            self.acting[body], self.couples[body] = [], []

    def add_force(self, body: str, place: complex | Complex, force: Array | complex) -> None:
        self.acting[body].append((np.asarray(place), np.asarray(force)))

    def add_moment(self, body: str, moment: Array | float, reaction_on: str = "") -> None:
        for one, sign in ((body, 1), (reaction_on, -1)):
            if one:
                place = next(iter(self.motion.linkage.bodies[one].values()), 0j)
                self.couples[one].append((np.asarray(place), sign * np.asarray(moment)))


def plate_loads(analysis: ForceAnalysis) -> PlateLoads:
    """All forces on each body: loads, weights and inertia, joints and driver. Dry friction's couples are left out."""
    motion, loads = analysis.motion, PlateLoads(analysis.motion)
    linkage = motion.linkage
    analysis.loads.apply_to(loads)
    acting = [force for joint in linkage.joints for force in joint.forces(analysis, loads)]
    for body, place, force, couple in acting:
        loads.add_force(body, place, force)
        if np.any(couple):
            loads.couples[body].append((np.asarray(place), couple))
    if linkage.driver_pivot:
        place = linkage.bodies[linkage.driver][linkage.driver_pivot]
        loads.couples[linkage.driver].append((np.asarray(place), analysis.driver))
    return loads


@record
class PlateSection:
    """A section of a plate through `place`, mm, across the unit `direction`.

    area: mm2. centre: mm. modulus: of bending, mm3. hair: length, mm, that counts as none.
    """

    place: complex
    direction: complex
    area: float
    centre: complex
    modulus: float
    hair: float


def plate_sections(part: Part, places: Complex, tolerance: float) -> list[PlateSection]:
    """Sections of a plate through the centres of its holes and between each two, across the line that joins them.

    tolerance: of its outline, mm.
    """
    loops = [flatten(curve, tolerance) for curve in (part.outline, *part.holes)]
    shares = np.arange(SECTIONS) / SECTIONS
    sections = [
        _section(loops, part.thickness, one + share * (other - one), other - one)
        for one, other in permutations(places.tolist(), 2)
        for share in shares.tolist()
    ]
    return [section for section in sections if section]


def _section(loops: Sequence[Complex], thickness: float, place: complex, along: complex) -> PlateSection | None:
    """The section at right angles to a line; None if it misses the plate.

    The line of the section crosses outline and holes in pairs of points, between which there is material.
    """
    direction, crossings = along / abs(along), []
    for loop in loops:
        start = (loop - place) * np.conj(direction)
        is_beyond = start.real >= 0
        meets = np.flatnonzero(is_beyond != np.append(is_beyond[1:], is_beyond[0]))
        start, end = start[meets], start[(meets + 1) % len(start)]
        crossings.append(start.imag - start.real * (end.imag - start.imag) / (end.real - start.real))
    low, high = np.sort(np.concatenate(crossings)).reshape(-1, 2).T
    if not low.size:
        return None
    length = float((high - low).sum())
    centre = float((high**2 - low**2).sum() / 2 / length)
    inertia = float(((high - centre) ** 3 - (low - centre) ** 3).sum() / 3)
    modulus = inertia * thickness / float(max(high.max() - centre, centre - low.min()))
    middle = place + 1j * direction * centre
    return PlateSection(place, direction, length * thickness, middle, modulus, 1e-9 * abs(along))


def plate_stress(loads: PlateLoads, body: str, sections: Sequence[PlateSection]) -> Real:
    """Largest nominal stress of a body's plate over its sections, N/mm2 at each frame.

    Tension or pressure, plus bending; nan where a force is unknown. Shear is not in it.
    """
    turned = np.conj(loads.motion.bodies[body].direction)
    forces = [(place, force * turned) for place, force in loads.acting[body]]
    worst = np.zeros(loads.motion.assembled.shape)
    for section in sections:
        normal, moment = np.zeros(worst.shape), np.zeros(worst.shape)
        for at, force in forces:
            beyond, along = dot(section.direction, at - section.place), dot(section.direction, force)
            # A pin presses on the side of its hole towards which its force points.
            counts = (beyond > section.hair) | ((np.abs(beyond) <= section.hair) & (along > 0))
            normal += np.where(counts, along, 0.0)
            moment += np.where(counts, cross(at - section.centre, force), 0.0)
        for at, couple in loads.couples[body]:
            moment += np.where(dot(section.direction, at - section.place) > section.hair, couple, 0.0)
        worst = np.maximum(worst, np.abs(normal) / section.area + np.abs(moment) / section.modulus)
    return worst


def _screw_forces(analysis: ForceAnalysis) -> dict[tuple[str, str], Complex]:
    """Force of each screw on each body, N, by axis and body: the sum of all joints on that axis."""
    forces: dict[tuple[str, str], Complex] = {}
    for axis, pins in pins_on_axes(analysis.motion.linkage).items():
        for pin in pins:
            for body, _, force, _ in pin.forces(analysis, analysis.wrenches):
                forces[axis, body] = forces.get((axis, body), 0) + force
    return forces


def pin_shears(analysis: ForceAnalysis, stack: Stack) -> Iterator[tuple[str, Real]]:
    """The largest shear force in each pin, N at each frame: between two layers, all forces on the pin below add up.

    So a pin that joins two plates is in single shear, and one between two plates of a body in double shear. A shaft of
    a motor and guide pins in slots are left out.
    """
    forces = _screw_forces(analysis)
    for pin in stack.pins:
        bodies = [stack.plates[name].body for name in pin.holes]
        if pin.motor or pin.slots or pin.name not in analysis.motion.linkage.joint_points:
            continue
        below, largest = np.zeros(analysis.motion.assembled.shape, dtype=complex), np.zeros(1)
        for name in sorted(pin.holes, key=stack.layers.__getitem__):
            body = stack.plates[name].body
            below = below - forces[pin.name, body] / bodies.count(body)
            largest = np.maximum(largest, np.abs(below))
        yield pin.name, largest


def pin_pressures(analysis: ForceAnalysis, stack: Stack, stock: LinkStock) -> Iterator[tuple[str, Real]]:
    """The pressure of each pin in each hole, force over diameter and thickness, N/mm2 at each frame."""
    forces = _screw_forces(analysis)
    for pin in stack.pins:
        bodies = [stack.plates[name].body for name in pin.holes]
        if pin.name not in analysis.motion.linkage.joint_points:
            continue
        diameter = stock.shaft.bore if pin.motor and stock.shaft else stock.pin_diameter
        for name, body in zip(pin.holes, bodies):
            force = np.abs(forces[pin.name, body]) / bodies.count(body)
            yield f"{pin.name} in the {name}", force / (diameter * stock.thickness)


@checked
def linkage_strength_checks(
    analysis: ForceAnalysis, stock: LinkStock = LinkStock(), stack: Stack | None = None
) -> tuple[Check, ...]:
    """Check that pins and moving plates hold at the worst frame.

    Parameters
    ----------
    analysis : ForceAnalysis
        Joint forces of one linkage.
    stock : LinkStock
        Sheet and pins; its material sets the limits of pressure and stress.
    stack : Stack, optional
        `stack_links(motion, stock)` over the whole range, by default that of the analysed motion.

    Returns
    -------
    tuple of Check
        The mean shear stress of the pins, the pressure of the pins in their holes, and the nominal stress of the plates
        that move, N/mm2, each where it is largest; nan where dry friction locks the linkage; without those whose
        limit or value is unknown otherwise.

    Raises
    ------
    DesignError
        If the motion is of many linkages at once.

    Notes
    -----
    Forces on a body act at points, its weight and inertia at the centre of mass; the bending by distributed inertia of
    a slender bar is overestimated by up to two times. The pin's bending and the friction's couples are left out. The
    limits are constants of this module and values of the material, each with its source.

    Examples
    --------
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 91), speed=1.0)
    >>> result = gk.forces(motion, gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -20j)]))
    >>> stock = gk.linkage.LinkStock(material=gk.making.material("birch-plywood"))
    >>> [check.id for check in gk.linkage.linkage_strength_checks(result, stock)]
    ['pin_shear', 'pin_pressure', 'plate_stress']
    """
    motion = analysis.motion
    if motion.linkage.is_batch:
        raise DesignError("analysis", "found many linkages at once", "give one", "wrong-type")
    stack, material = stack or stack_links(motion, stock), stock.material
    fastener, core = stock.fastener_used, stock.pin_diameter
    if fastener.form == "screw" and fastener.size:
        core -= MINOR_DEPTH * fastener.size.pitch
    area = np.pi / 4 * core**2

    def shears(analysis: ForceAnalysis) -> Iterator[tuple[str, Real]]:
        return ((name, force / area) for name, force in pin_shears(analysis, stack))

    def pressures(analysis: ForceAnalysis) -> Iterator[tuple[str, Real]]:
        return pin_pressures(analysis, stack, stock)

    # The limits are those of round steel pins.
    has_steel_pins, checks = fastener.form != "snap", []
    if has_steel_pins:
        checks.append(_check("pin_shear", "shear stress of pin", shears, MOST_PIN_SHEAR, analysis, "give thicker pins"))
    if has_steel_pins and material and material.bearing_pressure:
        advice = "give thicker pins, a thicker sheet or another material"
        most = material.bearing_pressure
        checks.append(_check("pin_pressure", "pressure of pin", pressures, most, analysis, advice))
    if material and material.carried_stress:
        tolerance = FINE * stock.bar_width
        plates = [
            (part.name, part.body, plate_sections(part, plate.section_points, tolerance))
            for part in link_parts(motion, stock, stack)
            if (plate := stack.plates.get(part.name)) and plate.body != motion.linkage.ground
        ]

        def stresses(analysis: ForceAnalysis) -> Iterator[tuple[str, Real]]:
            loads = plate_loads(analysis)
            return ((name, plate_stress(loads, body, sections)) for name, body, sections in plates)

        most = material.carried_stress / LEAST_PLATE_SAFETY
        advice = "give wider bars, a thicker sheet or another material"
        checks.append(_check("plate_stress", "stress of the", stresses, most, analysis, advice))
    return tuple(check for check in checks if check)


def _check(
    id: str,
    what: str,
    values: Callable[[ForceAnalysis], Iterator[tuple[str, Real]]],
    most: float,
    analysis: ForceAnalysis,
    advice: str,
) -> Check | None:
    """Check of the largest of some named values, also between frames; None if none is known."""
    motion, names = analysis.motion, [name for name, _ in values(analysis)]
    if not names:
        return None

    def sizes(moved: Motion) -> Real:
        named = values(replace(analysis, motion=moved))
        return np.array([np.broadcast_to(value, moved.drive.shape) for _, value in named])

    limit = to_digits(most, 6)
    if analysis.jammed.any():
        first = in_driver_unit(motion, float(motion.drive[np.argmax(analysis.jammed)]))
        locked = "no force is known where dry friction locks the linkage: give less friction or other lengths"
        return Check(id, f"{what} {names[0]}", np.nan, "at most", limit, "N/mm2", locked, at=first)
    largest, drive = largest_between(motion, lambda moved: np.fmax.reduce(sizes(moved)))
    if np.isnan(largest):
        return None
    at_worst = moved_to(motion, [drive])
    worst = int(np.nanargmax(sizes(at_worst)[:, -1]))
    if largest > WRONG_UNIT * most:
        advice = "a unit is probably wrong: forces are in N, lengths in mm, masses in kg"
    # A value that is the same at all frames has no worst one.
    at = in_driver_unit(motion, float(drive)) if np.ptp(sizes(motion)[worst]) else None
    return Check(id, f"{what} {names[worst]}", float(largest), "at most", limit, "N/mm2", advice, at=at)
