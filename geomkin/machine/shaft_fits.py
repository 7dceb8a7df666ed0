"""The shafts of a machine in its layers: diameter, length, bores on it, and the bodies that it passes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from itertools import zip_longest

import numpy as np

from ..core.fields import to_digits
from ..core.records import record
from ..core.units import mm
from ..making.assembly import collar_bill, collar_width
from ..making.motors import MOTORS, face_of
from ..model.check import Check
from ..model.motor import Motor, RotatingBody
from ..model.part import Bought, HoleFit, Part
from ..model.scene import SceneBody
from ..plane.flatten import flatten
from ..plane.region import distances
from ..plane.vec import Complex, without_rounding
from ..recipe.recipe import AbstractRecipe
from .placed import PlacedMechanism
from .shafts import Shaft, ShaftGraph

# Distance between outlines and their chords where shafts pass, mm.
FINE = 0.01
# Distance of the middle of a bore from the axis, as a share of its diameter; a flat or a keyway moves the middle.
OFF_AXIS = 0.3
# Decimals of mm to which positions count as one.
PLACES = 6
# Distance of axes that count as one, as a share of their distance from the origin.
SAME_AXIS = 1e-9


@record(eq=False)
class ShaftFit:
    """A shaft in the layers of the machine.

    Parameters
    ----------
    shaft : Shaft
        The shaft.
    axis : complex
        Its axis in the machine, mm.
    bodies : dict of str to SceneBody
        The joined bodies by their names, the turning one first.
    bores : dict of str to HoleFit or None
        Bore of each joined body on the axis; None without a bore. Rings, which have no middle, are left out.
    joints : dict of str to str
        By mechanism, the joint in its bill whose own shaft this one replaces.
    layers : tuple of int
        Lowest and highest layer of the joined mechanisms' bodies with a bore on the axis.
    is_motor : bool
        Whether a motor's own shaft turns the first body.
    length : float
        Thickness of all these layers and of the known gaps between mechanisms, mm.
    has_all_gaps : bool
        Whether all gaps are known.
    """

    shaft: Shaft
    axis: complex
    bodies: Mapping[str, SceneBody]
    bores: Mapping[str, HoleFit | None]
    joints: Mapping[str, str]
    layers: tuple[int, int]
    is_motor: bool
    length: float
    has_all_gaps: bool

    @property
    def diameter(self) -> float:
        """Diameter of the bore of the body that turns it, or of another one, mm; nan without bores."""
        return next((bore.diameter for bore in self.bores.values() if bore is not None), np.nan)

    @property
    def bought(self) -> tuple[Bought, ...]:
        """The shaft and a collar at each end; none without bores, or if it is that of a motor."""
        if self.is_motor or not self.diameter > 0:
            return ()
        shaft = f"shaft {mm(self.diameter):g}, {self._long}"
        items = ((shaft, 1), *collar_bill(self.diameter, 2))
        return tuple(Bought(name, count, tuple(self.bodies)) for name, count in items)

    @property
    def _long(self) -> str:
        length = self.length + 2 * collar_width(self.diameter)
        return f"at least {mm(to_digits(length, 10)):up6}{'' if self.has_all_gaps else ' and the gaps'} long"

    @property
    def step(self) -> str:
        """The assembly step of the shaft."""
        bodies, joints = " and ".join(self.bodies), " and ".join(f"{joint} of {n}" for n, joint in self.joints.items())
        rings = [name for name in self.bodies if name not in self.bores]
        discs = f"; screw a disc with its bore on {' and '.join(rings)} (not supplied)" if rings else ""
        if self.is_motor:
            shaft = f"the shaft of the motor, {self._long}, goes through {bodies}, fixed to each, instead of {joints}"
        else:
            ends = "fixed to each, with a collar at each end"
            shaft = f"one shaft goes through {bodies}, {ends}, instead of that of {joints}"
        return f"{shaft}{discs}"

    def checks(self, mechanisms: Sequence[PlacedMechanism]) -> Iterator[Check]:
        """Checks that the bores have the shaft's diameter and that it touches no body of the layers it crosses."""
        id = f"{self.shaft.mechanism}_{self.shaft.body}_shaft".replace(" ", "_")
        bores = {name: bore.diameter if bore else np.nan for name, bore in self.bores.items()}
        if not bores:
            return  # A ring that turns a ring.
        words = ", ".join(f"{name} {mm(bore):g}" if bore > 0 else f"{name} none" for name, bore in bores.items())
        if bare := [name for name, bore in bores.items() if not bore > 0]:
            wide = f" of {mm(self.diameter):g}" if self.diameter > 0 else ", and all the same one"
            advice = (
                f"no bore; give {' and '.join(bare)} a bore{wide}: bore of gears and cams, pin_diameter of linkages"
            )
            yield Check(
                f"{id}_bores", f"bodies without a bore on one shaft ({words})", len(bare), "at most", 0, "", advice
            )
        else:
            advice = "give all bodies on this shaft the same bore: bore of gears and cams, pin_diameter of linkages"
            # Bores given in inches agree to their last written digit only.
            spread = float(np.round(np.ptp(list(bores.values())), 6))
            name = f"difference of bores on one shaft ({words})"
            yield Check(f"{id}_bores", name, spread, "at most", 0.0, "mm", advice)
        if not self.diameter > 0:
            return
        room, name = min(self._rooms(mechanisms), default=(np.inf, ""))
        beside = f" and {name}" if name else ""
        advice = "change the order of the mechanisms, let one be upside_down, or change its angle_deg"
        yield Check(
            f"{id}_room",
            f"distance of shaft {self.shaft}{beside}",
            without_rounding(room - self.diameter / 2, self.diameter),
            "at least",
            0.0,
            "mm",
            advice,
        )

    def _rooms(self, mechanisms: Sequence[PlacedMechanism]) -> Iterator[tuple[float, str]]:
        """Least distance of each body in these layers from the axis, mm, and its name; of a bore on it, its radius."""
        low, high = self.layers
        for mechanism in mechanisms:
            for body in mechanism.scene.bodies:
                if not low <= body.layer <= high or body.name in self.bodies:
                    continue
                places = places_on(body, self.axis)
                for part in body.parts:
                    if (bore := bore_at(part, places)) is not None:
                        yield bore[0].diameter / 2, body.name
                    else:
                        loops = [flatten(curve, FINE) for curve in (part.outline, *part.holes)]
                        yield float(distances(loops, places).min()), body.name


def motor_room(graph: ShaftGraph, mechanisms: Sequence[PlacedMechanism]) -> Iterator[Check]:
    """Check that no body moves where a motor hangs from its plate; nothing without a motor.

    The motor counts as a cylinder, as wide as its face, through all layers on its side of the plate.
    """
    driver = next(mechanism for mechanism in mechanisms if mechanism.name == graph.driver)
    stock, _, key = motor_key(driver.recipe).partition(".")
    if not key:
        return
    face = face_of(getattr(getattr(driver.recipe, stock), key))
    axis = complex(driver.placement.pose.place(next(iter(graph.bodies[driver.name].values())).axis))
    plates = (
        body
        for body in driver.scene.bodies
        for part in body.parts
        if (bore := bore_at(part, places_on(body, axis))) and bore[0].diameter == face.boss_diameter
    )
    if (plate := next(plates, None)) is None:
        return
    middle, side = axis + face.face_offset * complex(plate.direction[0]), 1 if driver.is_reversed else -1
    rooms = (
        (float(distances([flatten(part.outline, FINE)], places_on(body, middle)).min()), body.name)
        for mechanism in mechanisms
        if mechanism is not driver
        for body in mechanism.scene.bodies
        if (body.layer - plate.layer) * side > 0
        for part in body.parts
    )
    if (nearest := min(rooms, default=None)) is None:
        return
    room, name = nearest
    advice = (
        "put these mechanisms on the other side of the plate, or change their angle_deg or the train's directions_deg"
    )
    value = without_rounding(room - face.face_width / 2, face.face_width)
    yield Check("motor_room", f"distance of the motor and {name}", value, "at least", 0.0, "mm", advice)


def places_on(body: SceneBody, axis: complex) -> Complex:
    """The positions of a fixed axis in the frame of a body, mm, each once."""
    places = (axis - body.origin) * np.conj(body.direction)
    return np.unique(np.round(places[np.isfinite(places)], PLACES))


def bore_at(part: Part, places: Complex) -> tuple[HoleFit, str] | None:
    """The fit of the hole of a part that has its middle at these places, mm, and the letter next to it."""
    for hole, fit, letter in zip_longest(part.holes, part.fits, part.hole_names[: len(part.holes)]):
        points = hole.point(np.linspace(hole.breaks[0], hole.breaks[-1], 65))
        middle = complex(np.ptp(points.real) / 2 + points.real.min(), np.ptp(points.imag) / 2 + points.imag.min())
        if fit is not None and np.abs(places - middle).max() <= OFF_AXIS * fit.diameter:
            return fit, letter or ""
    return None


def shaft_fits(graph: ShaftGraph, mechanisms: Sequence[PlacedMechanism]) -> Iterator[ShaftFit]:
    """The shafts of a machine in its layers."""
    heights = {layer: height for mechanism in mechanisms for layer, height in mechanism.heights.items()}
    by_name = {mechanism.name: mechanism for mechanism in mechanisms}
    for shaft in graph.shafts:
        joined = {shaft.mechanism: shaft.body} | {name: next(iter(graph.bodies[name])) for name in shaft.turned}
        axis = complex(by_name[shaft.mechanism].placement.pose.place(graph.bodies[shaft.mechanism][shaft.body].axis))
        bodies, bores, joints, layers = {}, {}, {}, []
        for name, joined_body in joined.items():
            full, scene = f"{name}/{joined_body}", by_name[name].scene
            # Rods between their cranks turn the copies of a linkage, which are units of their own.
            first = {body.name for body in next(iter(scene.units.values()))}
            for body in scene.bodies:
                if body.name not in first:
                    continue
                found = [(part, bore) for part in body.parts if (bore := bore_at(part, places_on(body, axis)))]
                if found or body.name == full:
                    layers.append(body.layer)
                if body.name == full:
                    bodies[full] = body
                    if not graph.bodies[name][joined_body].is_ring:
                        bores[full] = found[0][1][0] if found else None
                    if found and turns_with_shaft(graph.bodies[name], joined_body):
                        joints[name] = found[0][1][1] or found[0][0].name.removeprefix(f"{name}_")
        low, high = min(layers), max(layers)
        length = sum(heights[k] for k in range(low, high + 1))
        crossed = [mechanism.gap for mechanism in mechanisms if low < mechanism.first_layer <= high]
        is_driver = shaft.body == next(iter(graph.bodies[shaft.mechanism]))
        is_motor = is_driver and bool(motor_key(by_name[shaft.mechanism].recipe))
        if is_motor:
            joints.pop(shaft.mechanism, None)
        length += sum(crossed)
        yield ShaftFit(shaft, axis, bodies, bores, joints, (low, high), is_motor, length, all(crossed))


def turns_with_shaft(bodies: Mapping[str, RotatingBody], name: str) -> bool:
    """Whether the shaft on the axis of a body turns with it: with the first body there, and with all of its speed."""
    body, size = bodies[name], max(abs(other.axis) for other in bodies.values())
    first = next(other for other in bodies.values() if abs(other.axis - body.axis) <= SAME_AXIS * size)
    return first.speed == body.speed


def motor_key(recipe: AbstractRecipe) -> str:
    """The key of the motor on the driver of a recipe; empty without one."""
    keys = (field.name for field in fields(recipe) if field.name.endswith("stock"))
    return next((f"{key}.motor" for key in keys if getattr(getattr(recipe, key), "motor", None) is not None), "")


def mounted_motor(recipe: AbstractRecipe) -> Motor | None:
    """The motor on the driver of a recipe, for which a plate has holes."""
    stock, _, name = motor_key(recipe).partition(".")
    return MOTORS.get(str(getattr(getattr(recipe, stock), name))) if name else None
