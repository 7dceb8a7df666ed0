"""Shafts of a machine: which mechanism turns which, speeds and period; diameters, lengths and bores; bill and steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, fields, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise, zip_longest
from math import gcd, lcm

import numpy as np

from ..core.errors import DesignError, shown
from ..core.fields import to_digits
from ..core.records import record
from ..core.units import marked, mm
from ..making.assembly import collar_bill, collar_width
from ..making.motors import MOTORS, face_of
from ..model.check import Check
from ..model.motor import Motor, RotatingBody
from ..model.part import Bought, HoleFit, Part
from ..model.scene import SceneBody
from ..plane.flatten import flatten
from ..plane.region import distances
from ..plane.vec import Complex, Real, without_rounding
from ..recipe.recipe import AbstractRecipe
from ..recipe.search import did_you_mean
from .mechanisms import Mechanism, PlacedMechanism

# Rows over the period: the fewest, the most, and those of a turn of the fastest crank or cam. A page shows no more rows
# than the most; with fewer for a turn a crank jumps.
FEWEST_FRAMES, MOST_FRAMES, FRAMES_PER_TURN = 240, 1000, 72
# Most turns of a crank or cam in a period; with more there are fewer than 25 rows for each.
MOST_TURNS = 40
# Most turns of the fastest gear in a period of gears alone; with more there are fewer than 4 rows for each.
MOST_GEAR_TURNS = 250
# Most turns of any gear in a period; with more, its angle loses digits that a drawing shows.
MOST_EXACT_TURNS = 1_000_000

Bodies = Mapping[str, RotatingBody]


@record
class Shaft:
    """A shaft that joins a body of one mechanism, which turns it, to the drivers of others.

    Parameters
    ----------
    mechanism, body : str
        The mechanism that turns the shaft, and its body on it.
    turned : tuple of str
        Names of the mechanisms whose drivers are on the shaft.
    """

    mechanism: str
    body: str
    turned: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.mechanism}/{self.body}"


@record(eq=False)
class ShaftGraph:
    """Which mechanism turns which.

    Parameters
    ----------
    bodies : dict of str to dict of str to RotatingBody
        Rotating bodies of each mechanism, the driver first.
    turned_by : dict of str to str or None
        For each mechanism the body that turns it, as `mechanism.body`; None for the driven mechanism.
    """

    bodies: Mapping[str, Bodies]
    turned_by: Mapping[str, str | None]
    # Shaft by the mechanism that it turns.
    sources: Mapping[str, tuple[str, str]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "sources", {n: self._source(n, by) for n, by in self.turned_by.items() if by})
        drivers = [name for name in self.turned_by if name not in self.sources]
        for name in self.turned_by:
            if (chain := self._chain(name))[-1] in chain[:-1]:
                circle = " by ".join(chain[chain.index(chain[-1]) :])
                remedy = "omit turned_by of the one that a motor or a hand drives"
                raise DesignError(_key(chain[-1]), f"the mechanisms turn each other: {circle}", remedy, "conflict")
        if len(drivers) > 1:
            problem = f"is missing, and {drivers[0]} is the mechanism that a motor or a hand drives"
            others = next(iter(self.bodies[drivers[0]]))
            raise DesignError(_key(drivers[1]), problem, f'give a body, such as "{drivers[0]}.{others}"', "missing-key")

    def _source(self, name: str, by: str) -> tuple[str, str]:
        """The mechanism and the body that turn a mechanism."""
        mechanism, _, body = by.partition(".")
        found, key = f"found {shown(by)}", _key(name)
        if mechanism not in self.bodies:
            others = " or ".join(n for n in self.bodies if n != name)
            remedy = f"{did_you_mean(mechanism, self.bodies)}give a body of {others}"
            raise DesignError(key, f"{found}, but no mechanism has this name", remedy, "unknown-key")
        bodies = self.bodies[mechanism]
        if body not in bodies:
            offered = " or ".join(f'"{mechanism}.{other}"' for other in bodies)
            problem = f"{found}, but no body of {mechanism} has this name and turns evenly about a fixed axis"
            raise DesignError(key, problem, f"{did_you_mean(body, bodies)}give {offered}", "unknown-key")
        return mechanism, body

    def _chain(self, name: str) -> list[str]:
        """A mechanism, the one that turns it and so on, until the driven one or until one repeats."""
        chain = [name]
        while (source := self.sources.get(chain[-1])) is not None:
            chain.append(source[0])
            if chain[-1] in chain[:-1]:
                break
        return chain

    @property
    def driver(self) -> str:
        """The mechanism that a motor or a hand drives."""
        return next(name for name in self.turned_by if name not in self.sources)

    @cached_property
    def order(self) -> tuple[str, ...]:
        """All mechanisms, each after the one that turns it."""
        return tuple(sorted(self.turned_by, key=lambda name: len(self._chain(name))))

    @cached_property
    def shafts(self) -> tuple[Shaft, ...]:
        """The shafts that join mechanisms."""
        turned: dict[tuple[str, str], list[str]] = {}
        for name, source in self.sources.items():
            turned.setdefault(source, []).append(name)
        return tuple(Shaft(*source, tuple(names)) for source, names in turned.items())

    @cached_property
    def speeds(self) -> Mapping[str, Fraction]:
        """Rotations of the driver of each mechanism for one of the machine's driver, exact."""
        speeds: dict[str, Fraction] = {}
        for name in self.order:
            if name in self.sources:
                mechanism, body = self.sources[name]
                shaft = speeds[mechanism] * self.bodies[mechanism][body].speed
                speeds[name] = shaft / next(iter(self.bodies[name].values())).speed
            else:
                speeds[name] = Fraction(1)
        return speeds

    def _body_speeds(self, wheels: bool) -> list[Fraction]:
        return [
            abs(self.speeds[name] * body.speed)
            for name, bodies in self.bodies.items()
            for body in bodies.values()
            if body.is_wheel == wheels
        ]

    @cached_property
    def period(self) -> Fraction:
        """Rotations of the machine's driver after which all cranks and cams are where they began.

        In a machine of gears alone, those after which all gears are, or as many as a scene may have.

        Raises
        ------
        DesignError
            If a crank, cam or gear turns too often in it; names the numbers.
        """
        speeds, wheels = self._body_speeds(wheels=False), self._body_speeds(wheels=True)
        if not speeds:
            return min(common_period(wheels), MOST_GEAR_TURNS / max(wheels))
        period = common_period(speeds)
        for what, each, most in (("crank or cam", speeds, MOST_TURNS), ("gear", wheels, MOST_EXACT_TURNS)):
            if (turns := period * max(each, default=Fraction(0))) > most:
                problem = f"a {what} turns {float(turns):,.6g} times until all cranks and cams are where they began"
                remedy = f"choose numbers of teeth with simpler ratios, so that it turns at most {most:,} times"
                raise DesignError("mechanisms", problem, remedy, "too-much-work")
        return period

    @property
    def is_cyclic(self) -> bool:
        """Whether all cranks and cams, or in their absence all gears, are where they began after the period."""
        speeds = self._body_speeds(wheels=False) or self._body_speeds(wheels=True)
        return all((self.period * speed).denominator == 1 for speed in speeds)

    @cached_property
    def turns(self) -> Real:
        """Rotations of the machine's driver at the frames, (frames,), from 0 to the period."""
        fastest = max(self._body_speeds(wheels=False), default=Fraction(0)) * self.period
        frames = min(MOST_FRAMES, max(FEWEST_FRAMES, int(FRAMES_PER_TURN * fastest)))
        return float(self.period) * np.arange(frames + 1) / frames


def common_period(speeds: Iterable[Fraction]) -> Fraction:
    """The least number of turns of a driver after which bodies of these speeds have made whole turns."""
    speeds = list(speeds)
    return Fraction(lcm(*(v.denominator for v in speeds)), gcd(*(v.numerator for v in speeds)))


def _key(name: str) -> str:
    return f"mechanisms.{name}.turned_by"


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
        return f"{shaft}{discs}; where a step below puts one of these in, leave the hole open for the shaft"

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


@record(eq=False)
class MachineAssembly:
    """Items to buy and assembly steps. mechanisms, recipes: by name, the lowest first. shafts: that join them."""

    mechanisms: Mapping[str, Mechanism]
    recipes: Mapping[str, AbstractRecipe]
    shafts: tuple[ShaftFit, ...]

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Items of all mechanisms, equal ones in one line, and the shafts that join them instead of their own."""
        lines: dict[str, Bought] = {}
        joined = {joint for shaft in self.shafts for joint in shaft.joints.items()}
        for name, recipe in self.recipes.items():
            replaced = [item for item in recipe.shaft_items if {(name, j) for j in item.joints} & joined]
            for item in recipe.bought:
                own = [other for other in replaced if other.name == item.name]
                joints = set(item.joints).difference(*(other.joints for other in own))
                kept = tuple(f"{name} {joint}" for joint in item.joints if joint in joints)
                _add(lines, replace(item, count=item.count - sum(other.count for other in own), joints=kept))
        for shaft in self.shafts:
            for item in shaft.bought:
                _add(lines, item)
        return tuple(lines.values())

    @property
    def snap_checks(self) -> tuple[Check, ...]:
        """None: its pins are bought."""
        return ()

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        """None: a machine is no mechanism of another."""
        return ()

    @property
    def steps(self) -> tuple[str, ...]:
        """The shafts that join the mechanisms, then the steps of each mechanism."""
        own = (f"{name}: {marked(step)}" for name, recipe in self.recipes.items() for step in recipe.steps)
        phases = (
            f"turn the driver of {name} by {mechanism.phase_deg:g} deg before it is fixed to its shaft"
            for name, mechanism in self.mechanisms.items()
            if mechanism.phase_deg
        )
        gaps = {name: mechanism.gap for name, mechanism in self.mechanisms.items()}
        neighbours = (
            f"set {upper} above {lower} on tubes "
            + (f"{mm(gaps[upper]):g} high" if gaps[upper] else "as high as the nuts and collars between them")
            for lower, upper in pairwise(self.mechanisms)
        )
        words = {
            (True, False): "turn {} over, left for right",
            (False, True): "turn {} upside down, its ground on top",
            (True, True): "lay each plate of {} with its other face up, in the same order",
        }
        turned = (
            words[mechanism.mirrored, mechanism.upside_down].format(name)
            for name, mechanism in self.mechanisms.items()
            if mechanism.mirrored or mechanism.upside_down
        )
        return (*(shaft.step for shaft in self.shafts), *own, *turned, *neighbours, *phases)


def _add(lines: dict[str, Bought], item: Bought) -> None:
    """Add an item to the lines of a bill."""
    if item.count:
        before = lines.get(item.name, Bought(item.name, 0, ()))
        lines[item.name] = Bought(item.name, before.count + item.count, (*before.joints, *item.joints))
