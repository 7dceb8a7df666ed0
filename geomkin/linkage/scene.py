"""A linkage as a scene: its moving plates, pins and slides, traced points, instant centres, vectors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..model.part import Part
from ..model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark, dimension, mm
from ..model.table import Column, Table
from ..plane.vec import Array, Complex
from .instant.centres import instant_centre
from .motion import Motion

if TYPE_CHECKING:
    from .linkage import Linkage


# Length of the longest arrow of a kind, as a share of the linkage's size.
LONGEST_ARROW = 0.5
# Largest number of bodies for which all instant centres are shown; with more, only those with the ground.
ALL_CENTRES = 6
# Distance, in sizes of the linkage, beyond which instant centres are omitted.
FARTHEST_CENTRE = 3.0


@checked
def linkage_scene(
    motion: Motion,
    table: Table,
    parts: Sequence[Part] = (),
    layers: Mapping[str, int] | None = None,
    limits: Mapping[str, Limit] | None = None,
    others: Mapping[str, Scene] | None = None,
    rates: bool = True,
) -> Scene:
    """A moving linkage as a scene, at the frames of its motion.

    Points that are not pins leave trails. Velocities, accelerations, instant centres and dimensions can be switched on.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    table : Table
        `motion_table(motion)`, or another table with its frames, for the plots.
    parts : sequence of Part
        Plates from `link_parts`, each drawn with its body; without them only pins and lines are drawn.
    layers : mapping of str to int, optional
        Layers of the stack, by the plates' names.
    limits : mapping of str to Limit, optional
        Lines across the plots, by the names of their columns.
    others : mapping of str to Scene, optional
        Scenes of the same linkage in other assembly modes.
    rates : bool
        Whether velocities, accelerations, instant centres and dimensions are included.

    Returns
    -------
    Scene

    Raises
    ------
    DesignError
        If the motion has no frames, or is of arrays of linkages.

    Notes
    -----
    Derived here.
    """
    if motion.linkage.is_batch:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time")
    if not len(motion.drive):
        raise DesignError("motion", "it has no frames", "give at least one position of the driver")
    bodies = tuple(placed_bodies(motion, parts, layers or {}))
    marks = (*_lines(motion, {body.name for body in bodies if body.parts}), *_joints(motion), *traced_points(motion))
    if rates:
        marks += (*_vectors(motion), *_centres(motion))
    travel = motion.drive[-1] - motion.drive[0]
    turns = motion.linkage.driven_slider is None and bool(np.isclose(travel % (2 * np.pi), 0, atol=1e-9))
    # If the speed changes the time is unknown: the motion is then shown in two seconds.
    elapsed = np.abs(motion.timing.elapsed(motion.drive))
    time = elapsed if np.isfinite(elapsed).all() else np.linspace(0, 2, len(elapsed))
    return Scene(
        table,
        time,
        motion.assembled,
        bodies,
        tuple(link_dimensions(motion.linkage)) if rates else (),
        marks,
        tuple(_plots(table, limits or {})),
        turns and travel != 0,
        dict(others or {}),
    )


def placed_bodies(motion: Motion, parts: Sequence[Part], layers: Mapping[str, int]) -> Iterator[SceneBody]:
    """Each body with its plates, on their layers."""
    ground = motion.linkage.ground
    for name, body in motion.bodies.items():
        plates = [part for part in parts if part.body == name]
        place, fixed = (body.origin.position, body.direction), name == ground
        # Further plates of a body, such as a bridge of the ground or a counterweight, have their own layers.
        for part in plates[1:]:
            yield SceneBody(part.name, (part,), *place, layers.get(part.name, 0), fixed)
        yield SceneBody(name, tuple(plates[:1]), *place, layers.get(plates[0].name if plates else name, 0), fixed)


def _lines(motion: Motion, with_parts: set[str]) -> Iterator[SceneMark]:
    """Bodies without plates, as lines from each point to the next and back to the first."""
    for name, points in motion.linkage.bodies.items():
        if name in with_parts or name == motion.linkage.ground or len(points) < 2:
            continue
        places = [motion.bodies[name].point(z).position for z in points.values()]
        for start, end in zip(places, [*places[1:], *(places[:1] if len(places) > 2 else ())]):
            yield SceneMark("line", start, "construction", name, vector=end - start)


def _joints(motion: Motion) -> Iterator[SceneMark]:
    linkage = motion.linkage
    for pin, bodies in linkage.pins.items():
        kind = "fixed pin" if linkage.ground in bodies else "pin"
        yield SceneMark(kind, motion.point(pin).position, "construction", pin)  # type: ignore[arg-type]
    for slider in linkage.sliders:
        place = motion.bodies[slider.body].point(slider.point).position
        line = motion.bodies[slider.along].direction * slider.direction
        yield SceneMark("slide", place, "construction", slider.name, direction=line)


def _free_points(motion: Motion) -> Iterator[tuple[str, Complex, Complex, Complex]]:
    """Points that are not pins, nor coincide with one: name, position, velocity, acceleration."""
    for body, points in motion.linkage.bodies.items():
        pins = [z for name, z in points.items() if name in motion.linkage.pins]
        for name, z in points.items():
            if body != motion.linkage.ground and not any(z == pin for pin in pins):
                moved = motion.point(name)
                yield name, moved.position, moved.velocity, moved.acceleration


def traced_points(motion: Motion) -> Iterator[SceneMark]:
    """Points that are not pins, with their trails.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.

    Returns
    -------
    iterator of SceneMark
    """
    for name, place, _, _ in _free_points(motion):
        yield SceneMark("point", place, "traced", name, trail=True)


def _vectors(motion: Motion) -> Iterator[SceneMark]:
    """Velocities and accelerations of moving pins and free points, each at its own scale."""
    tracks = {name: (place, velocity, acceleration) for name, place, velocity, acceleration in _free_points(motion)}
    for pin, bodies in motion.linkage.pins.items():
        if motion.linkage.ground not in bodies:
            point = motion.point(pin)
            tracks[pin] = point.position, point.velocity, point.acceleration
    size = float(np.max(motion.linkage.size))
    for k, (role, unit) in enumerate((("velocity", "mm/s"), ("acceleration", "mm/s2")), 1):
        largest = max((_largest(track[k]) for track in tracks.values()), default=0.0)
        if not largest:
            continue
        # Near a limit rates become very large: the 95th percentile sets the scale, and longer arrows are cut off.
        typical = max(float(np.nanpercentile(np.abs(_finite(track[k])), 95)) for track in tracks.values())
        scale = LONGEST_ARROW * size / (typical or largest)
        for name, track in tracks.items():
            arrow = _finite(track[k]) * scale
            longest = 1.5 * LONGEST_ARROW * size
            arrow = arrow * (longest / np.maximum(np.abs(arrow), longest))
            yield SceneMark("vector", track[0], role, f"{name} {role}, {drawn_at(scale, unit)}", vector=arrow)  # type: ignore[arg-type]


def drawn_at(scale: float, unit: str) -> str:
    """Text that states the scale of arrows, if one of the unit is drawn `scale` mm long."""
    return f"1 mm is {float(f'{1 / scale:.3g}'):g} {unit}"


def _centres(motion: Motion) -> Iterator[SceneMark]:
    size, pins = float(np.max(motion.linkage.size)), motion.linkage.pins.values()
    joints = {frozenset(pair) for bodies in pins for pair in combinations(bodies, 2)}
    only_ground = len(motion.bodies) > ALL_CENTRES
    for pair in combinations(motion.bodies, 2):
        if frozenset(pair) in joints or (only_ground and motion.linkage.ground not in pair):
            continue
        position = instant_centre(motion, *pair).position
        place = np.where(np.abs(position) < FARTHEST_CENTRE * size, position, np.nan)
        if np.isfinite(place).any():
            yield SceneMark("point", place, "centre", f"instant centre of {' and '.join(pair)}")


def _plots(table: Table, limits: Mapping[str, Limit]) -> Iterator[Plot]:
    """Plots of columns that belong together, by the ends of their names; the most important first."""
    named = {column.header: column for column in table.columns[1:] if column.name != "time"}

    def of(title: str, *ends: str, without: str = "") -> Iterator[Plot]:
        columns = {h: c.name for h, c in named.items() if c.name.endswith(ends) and c.name != without}
        columns = {h: name for h, name in columns.items() if np.isfinite(table[h]).any()}
        if columns:
            yield Plot(title, tuple(columns), tuple(limits[name] for name in columns.values() if name in limits))

    points = [c.name[:-2] for c in named.values() if c.name.endswith("_x") and not _is_rate(c)]
    for point in points:
        yield from of(f"{point.replace('_', ' ')}, place", f"{point}_x", f"{point}_y")
    yield from of("angles", "_angle", without="transmission_angle")
    yield from of("transmission angle", "transmission_angle")
    yield from of("angular velocities", "_omega")
    yield from of("angular accelerations", "_alpha")
    yield from of("sliding, place", "_displacement")
    yield from of("sliding, velocity", "_velocity")
    yield from of("sliding, acceleration", "_acceleration")
    yield from of("Coriolis acceleration", "_coriolis_x", "_coriolis_y")
    for point in points:
        yield from of(f"{point.replace('_', ' ')}, velocity", f"{point}_velocity_x", f"{point}_velocity_y")
        yield from of(f"{point.replace('_', ' ')}, acceleration", f"{point}_acceleration_x", f"{point}_acceleration_y")
    # Mechanical advantages of different units have different scales.
    for unit in dict.fromkeys(c.unit for c in named.values() if c.name.endswith("_mechanical_advantage")):
        names = tuple(c.name for c in named.values() if c.name.endswith("_mechanical_advantage") and c.unit == unit)
        yield from of(f"mechanical advantage{f' in {unit}' * bool(unit)}", *names)
    for order in ("first", "second"):
        yield from of(f"{order} kinematic coefficients of angles", f"_angle_{order}_coefficient")
        yield from of(f"{order} kinematic coefficient of sliding", f"_displacement_{order}_coefficient")
        for point in points:
            names = (f"{point}_{order}_coefficient_x", f"{point}_{order}_coefficient_y")
            yield from of(f"{point.replace('_', ' ')}, {order} kinematic coefficient", *names)


def _is_rate(column: Column) -> bool:
    return column.name.endswith(("_velocity_x", "_acceleration_x", "_coriolis_x", "_coefficient_x"))


def _finite(values: Complex) -> Complex:
    return np.where(np.isfinite(values), values, np.nan)


def _largest(values: Complex) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


# Share of a linkage's size below which a length counts as rounding.
NOTHING = 1e-9


def link_dimensions(linkage: Linkage) -> Iterator[SceneCurve]:
    """Dimensions of every link between its joints, and of every slide's offset from the first joint of its guide."""
    least = NOTHING * float(np.max(linkage.size))
    joints = {name: _joint_positions(linkage, name) for name in linkage.bodies}
    for body, places in joints.items():
        # With more than three joints only the distances to the next are shown.
        pairs = combinations(places.items(), 2) if len(places) <= 3 else pairwise(places.items())
        for (one, start), (other, end) in pairs:
            if abs(end - start) > least:
                words = f"{mm(abs(end - start))}, {one} to {other}".replace("_", " ")
                yield dimension(start, end, words, body)
    for slider in linkage.sliders:
        line = complex(np.asarray(slider.direction))
        for name, place in list(joints[slider.along].items())[:1]:
            away = 1j * line * float(np.imag(np.conj(line) * (complex(slider.through) - place)))
            if abs(away) > least:
                words = f"offset {mm(abs(away))}, of {slider.name} from {name}".replace("_", " ")
                yield dimension(place, place + away, words, slider.along)


def _joint_positions(linkage: Linkage, body: str) -> dict[str, complex]:
    """Pins of a body, and points on which it slides, mm."""
    places: dict[str, complex | Array] = {n: z for n, z in linkage.bodies[body].items() if n in linkage.pins}
    places |= {slider.name: slider.point for slider in linkage.sliders if slider.body == body}
    return {name: complex(np.asarray(place)) for name, place in places.items()}
