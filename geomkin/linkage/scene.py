"""A linkage as a scene: its moving plates, pins and slides, traced points, instant centres, vectors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import to_digits
from ..core.units import mm
from ..model.part import Part
from ..model.scene import Limit, Plot, Role, Scene, SceneBody, SceneCurve, SceneMark, dimension, drawn_at, plottable
from ..model.table import Table
from ..plane.vec import Array, Complex
from .instant.centres import instant_centre
from .instant.polygons import RATES, component_vectors
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
    plots: Sequence[Plot] | None = None,
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
    plots : sequence of Plot, optional
        Plots of the table's columns; `motion_plots` by default. Columns of nan are left out.
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
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    if not len(motion.drive):
        raise DesignError("motion", "it has no frames", "give at least one position of the driver", "out-of-range")
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
        motion_plots(motion, table) if plots is None else plottable(plots, table),
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
    for joint in motion.linkage.joints:
        yield from joint.marks(motion)


def _free_points(linkage: Linkage) -> Iterator[str]:
    """Names of points of moving bodies that are not pins, nor coincide with one."""
    for body, points in linkage.bodies.items():
        pins = [z for name, z in points.items() if name in linkage.joint_points]
        if body != linkage.ground:
            yield from (name for name, z in points.items() if not any(z == pin for pin in pins))


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
    for name in _free_points(motion.linkage):
        yield SceneMark("point", motion.point(name).position, "traced", name, trail=True)


def with_components(scene: Scene, motion: Motion) -> Scene:
    """The scene of a motion whose velocities and accelerations also have their components along and across each link.

    Parameters
    ----------
    scene : Scene
        Of `linkage_scene`.
    motion : Motion
        Its motion.

    Returns
    -------
    Scene
    """
    # Arrows of a role have one scale, so those of the whole vectors are drawn again.
    others = (mark for mark in scene.marks if mark.role not in RATES)
    return replace(scene, marks=(*others, *_vectors(motion, has_components=True)))


def _vectors(motion: Motion, has_components: bool = False) -> Iterator[SceneMark]:
    """Velocities and accelerations of moving pins and free points, each at its own scale; also their components."""
    joints = motion.linkage.joint_points.items()
    names = [*_free_points(motion.linkage), *(pin for pin, bodies in joints if motion.linkage.ground not in bodies)]
    points = {name: motion.point(name) for name in names}
    tracks = {name: (point.position, point.velocity, point.acceleration) for name, point in points.items()}
    for k, (rate, unit) in enumerate(RATES.items(), 1):
        arrows = {name: (track[0], track[k]) for name, track in tracks.items()}
        for part in component_vectors(motion, rate) if has_components else ():
            arrows[f"{part.point} {part.side} {part.link}"] = part.position, part.vector
        yield from vector_marks(motion, arrows, rate, unit)


def vector_marks(
    motion: Motion, arrows: Mapping[str, tuple[Complex, Complex]], role: Role, unit: str
) -> Iterator[SceneMark]:
    """Arrows of one role at one scale. arrows: name to positions, mm, and vectors in the unit."""
    size = float(np.max(motion.linkage.size))
    largest = max((_largest(vector) for _, vector in arrows.values()), default=0.0)
    if not largest:
        return
    # Near a limit rates become very large: the 95th percentile sets the scale, and longer arrows are cut off.
    sizes = [np.abs(vector[np.isfinite(vector)]) for _, vector in arrows.values()]
    typical = max(float(np.percentile(known, 95)) for known in sizes if known.size)
    scale, longest = LONGEST_ARROW * size / (typical or largest), 1.5 * LONGEST_ARROW * size
    for name, (place, vector) in arrows.items():
        arrow = _finite(vector) * scale
        arrow = arrow * (longest / np.maximum(np.abs(arrow), longest))
        yield SceneMark("vector", place, role, f"{name} {role}, {drawn_at(scale, unit)}", vector=arrow)


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


# Values of a mechanical advantage so many times as large as the median are not drawn.
PEAK = 10.0


def motion_plots(motion: Motion, table: Table, limits: Iterable[Limit] = ()) -> tuple[Plot, ...]:
    """Plots of the columns of `motion_table(motion)`, and of those of another mode, `other_...`; the clearest first."""
    linkage, limits = motion.linkage, tuple(limits)
    bodies, slides = list(motion.bodies), [slide.name for slide in linkage.slides]
    modes = ("", "other_")
    named = [f"{mode}{point}" for mode in modes for point in _free_points(linkage)]

    def of(title: str, *ids: str) -> Plot:
        return Plot(title, tuple(f"{mode}{id}" for mode in modes for id in ids))

    def ending(title: str, names: Iterable[str], *ends: str) -> Plot:
        return of(title, *(f"{name}{end}" for name in names for end in ends))

    units = {column.id: column.unit for column in table.columns}
    advantages: dict[str, list[str]] = {}
    for id in (f"{mode}{body}_mechanical_advantage" for mode in modes for body in linkage.bodies):
        if id in units:
            advantages.setdefault(units[id], []).append(id)
    turning = [
        ending("angles", bodies, "_angle"),
        of("transmission angle", "transmission_angle"),
        ending("angular velocities", bodies, "_omega"),
        ending("angular accelerations", bodies, "_alpha"),
    ]
    sliding = [
        ending("sliding, place", slides, "_displacement"),
        ending("sliding, velocity", slides, "_velocity"),
        ending("sliding, acceleration", slides, "_acceleration"),
    ]
    # A slide on the ground that does not drive is an output.
    outputs = [s for s in linkage.slides if s.along == linkage.ground and s is not linkage.driven_slider]
    plots = [
        *(place_plot(point) for point in named),
        *(sliding + turning if outputs else turning + sliding),
        ending("Coriolis acceleration", slides, "_coriolis_x", "_coriolis_y"),
    ]
    for point in named:
        plots += [place_plot(point, "velocity"), place_plot(point, "acceleration")]
    # Ratios and forces for a torque are not of one scale.
    for unit, ids in advantages.items():
        plots.append(Plot(f"mechanical advantage{f' in {unit}' * bool(unit)}", tuple(ids)))
        limits += tuple(_ends(ids, table))
    for order in ("first", "second"):
        plots.append(ending(f"{order} kinematic coefficients of angles", bodies, f"_angle_{order}_coefficient"))
        plots.append(ending(f"{order} kinematic coefficient of sliding", slides, f"_displacement_{order}_coefficient"))
        for point in named:
            xy = tuple(f"{point}_{order}_coefficient_{axis}" for axis in "xy")
            plots.append(Plot(f"{point.replace('_', ' ')}, {order} kinematic coefficient", xy))
    return plottable([plot.with_limits(limits) for plot in plots], table)


def _ends(ids: Sequence[str], table: Table) -> Iterator[Limit]:
    """Lines beyond which columns are not drawn, if near dead centres they are much larger than elsewhere."""
    values = np.concatenate([table[id] for id in ids])
    values = values[np.isfinite(values)]
    most = to_digits(PEAK * float(np.median(np.abs(values))), 1) if len(values) else 0.0
    for end in (most, -most):
        if most and (values * np.sign(end)).max() > most:
            yield Limit(ids[0], end, "larger values are not drawn", is_end=True)


def place_plot(point: str, rate: str = "") -> Plot:
    """Plot of a point's x and y, or of those of its velocity or acceleration."""
    id = f"{point}_{rate}" if rate else point
    return Plot(f"{point.replace('_', ' ')}, {rate or 'place'}", (f"{id}_x", f"{id}_y"))


def _finite(values: Complex) -> Complex:
    return np.where(np.isfinite(values), values, np.nan)


def _largest(values: Complex) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


# Share of a linkage's size below which a length counts as rounding.
NOTHING = 1e-9


def link_distances(linkage: Linkage) -> Iterator[tuple[str, str, str, complex, complex]]:
    """Body, names and places of the joints between which every link is dimensioned, mm in its frame."""
    least = NOTHING * float(np.max(linkage.size))
    joints = {name: _joint_positions(linkage, name) for name in linkage.bodies}
    for body, places in joints.items():
        # With more than three joints only the distances to the next are shown.
        pairs = combinations(places.items(), 2) if len(places) <= 3 else pairwise(places.items())
        for (one, start), (other, end) in pairs:
            if abs(end - start) > least:
                yield body, one, other, start, end


def link_dimensions(linkage: Linkage) -> Iterator[SceneCurve]:
    """Dimensions of every link between its joints, and of every slide's offset from the first joint of its guide."""
    for body, one, other, start, end in link_distances(linkage):
        words = f"{mm(abs(end - start)):.5g}, {one} to {other}".replace("_", " ")
        yield dimension(start, end, words, body)
    least = NOTHING * float(np.max(linkage.size))
    joints = {name: _joint_positions(linkage, name) for name in linkage.bodies}
    for slider in linkage.slides:
        line = complex(np.asarray(slider.direction))
        for name, place in list(joints[slider.along].items())[:1]:
            away = 1j * line * float(np.imag(np.conj(line) * (complex(slider.through) - place)))
            if abs(away) > least:
                words = f"offset {mm(abs(away)):.5g}, of {slider.name} from {name}".replace("_", " ")
                yield dimension(place, place + away, words, slider.along)


def _joint_positions(linkage: Linkage, body: str) -> dict[str, complex]:
    """Pins of a body, and points on which it slides, mm."""
    places: dict[str, complex | Array] = {
        n: z for n, z in linkage.bodies[body].items() if body in linkage.joint_points.get(n, ())
    }
    places |= {s.name: s.point for s in linkage.slides if s.body == body and not s.points}
    return {name: complex(np.asarray(place)) for name, place in places.items()}
