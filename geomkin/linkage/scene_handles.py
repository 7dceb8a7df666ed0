"""Sizes of a linkage on the page: handles with the sizes that place them, and how far each size moves the output."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import groupby

import numpy as np

from ..core.errors import DesignError
from ..core.field_visitor import Number, numbers_in, with_number
from ..core.fields import to_digits
from ..core.units import unit_name
from ..model.scene import Plot, SceneHandle, point_handle
from ..model.table import Column, finite
from ..plane.vec import Complex, Real
from .linkage import AbstractLinkage, Linkage
from .motion import ROUNDING, Motion, on_ground
from .sensitivity import field_names

# Change of a size by which the points that it places are recognised, as a share of the linkage's size.
CHANGE = 1e-3
# Distances of handles from the reference point of a direction, a line, an origin and an unused point, as shares of that
# size: no pin is likely to be there.
ARMS = {"direction": 0.6 + 0j, "slide": 0.35 + 0j, "origin": -0.15 - 0.15j, "unused": 0.2 + 0.15j}
# Labels of handles; the handle of a point has the name of the point.
LABELS = {"point": "{}", "slide": "line of {}", "direction": "direction of {}", "origin": "position of {}"}


def linkage_handles(linkage: AbstractLinkage, motion: Motion, key: str = "linkage") -> Iterator[SceneHandle]:
    """Handles of all points, slide lines and directions of a linkage that some of its sizes place.

    A size belongs to the handle of each point whose position in its own body it changes, so a pin has the lengths of
    the bars that meet there. A pivot on the ground has only the sizes of the ground.

    Parameters
    ----------
    linkage : AbstractLinkage
        The linkage as the recipe has it.
    motion : Motion
        Its motion, at the frames of the scene.
    key : str
        Key of the linkage's table in the recipe.

    Returns
    -------
    iterator of SceneHandle
        Their ids are `point:NAME`, `slide:NAME` and `direction:NAME`, of points and sliders; `origin:NAME` and
        `direction:NAME` of the fixed body.
    """
    general = motion.linkage
    step = CHANGE * float(np.max(general.size) or 1.0)
    edits: dict[str, list[str]] = {}
    for field, group in groupby(numbers_in(linkage), lambda number: number.field):
        number = next(group)
        for _, changed in _changed(linkage, number, step):
            placed = list(_differences(general, changed))
            # The x and y of a point are its own; others, such as a corner that is given by distances, go with it.
            for id in filter(None, placed[:1] if number.key != field else placed):
                edits.setdefault(id, []).append(field)
    taken: list[Complex] = []
    for id, fields in edits.items():
        sort, _, name = id.partition(":")
        # A pivot at one length from another one also turns about it.
        if name in general.bodies[general.ground] and len(fields) == 1 and fields[0].endswith("ground"):
            fields.append(f"{fields[0]}_angle_deg")
        label = LABELS[sort].format(name.replace("_", " "))
        keys = tuple(f"{key}.{field}" for field in dict.fromkeys(fields))
        at = handle_position(motion, id)
        if any(np.allclose(at, other, rtol=0, atol=1e-9 * step, equal_nan=True) for other in taken):
            if sort != "point" or name in general.joint_points:
                continue
            # A point that is not used lies on a pin, whose handle it would hide: it is offered beside that.
            body = next(body for body, points in general.bodies.items() if name in points)
            at = body_point(motion, body, complex(general.bodies[body][name]) + ARMS["unused"] * step / CHANGE)
        taken.append(at)
        anchor = _anchor(motion, id)
        yield SceneHandle(id, label, keys, at, anchor=None if np.array_equal(anchor, at, equal_nan=True) else anchor)


def _differences(one: Linkage, other: Linkage) -> Iterator[str]:
    """Ids of the handles that a change places elsewhere; "" for a point that is no handle of the changed size."""
    ground = one.ground
    pivots = one.bodies[ground]
    if one.origin != other.origin:
        yield "origin:" + ground
    if one.ground_angle_deg != other.ground_angle_deg:
        yield "direction:" + ground
    for body, points in one.bodies.items():
        for name, place in points.items():
            if place == other.bodies[body][name]:
                continue
            # A pivot is placed by the ground. A pin at the origin of a body's frame is placed by the other bodies.
            elsewhere = [one.bodies[b][name] for b in one.pins.get(name, ()) if b != body]
            is_hidden = body != ground and (name in pivots or (place == 0 and any(z != 0 for z in elsewhere)))
            yield "" if is_hidden else f"point:{name}"
    for slider, changed in zip(one.slides, other.slides):
        if slider.through != changed.through:
            yield f"slide:{slider.name}"
            if slider.along == ground:
                on_line = (name for name, place in one.bodies[slider.body].items() if place == slider.point)
                yield from (f"point:{name}" for name in on_line)
        if slider.direction_deg != changed.direction_deg:
            yield f"direction:{slider.name}"


def handle_position(motion: Motion, id: str) -> Complex:
    """Positions of the handle of this id at the frames of a motion, mm; nan if the linkage cannot be assembled."""
    sort, _, name = id.partition(":")
    linkage = motion.linkage
    if sort == "point":
        return np.where(motion.assembled, motion.point(name).position, np.nan)
    arm = ARMS[sort] * float(np.max(linkage.size))
    if name in linkage.bodies:
        position = motion.bodies[name].point(arm).position
    else:
        slider = next(s for s in linkage.slides if s.name == name)
        position = motion.bodies[slider.along].point(slider.through + arm * slider.direction).position
    return np.where(motion.assembled, position, np.nan)


def _anchor(motion: Motion, id: str) -> Complex:
    """Positions of what the handle of this id moves: a point, the origin of a body, or a point of a slide's line."""
    sort, _, name = id.partition(":")
    if sort == "point":
        return handle_position(motion, id)
    if name in motion.linkage.bodies:
        return body_point(motion, name, 0j)
    slider = next(s for s in motion.linkage.slides if s.name == name)
    return body_point(motion, slider.along, complex(slider.through))


def stroke_handles(motion: Motion, start: float, end: float) -> Iterator[SceneHandle]:
    """Handles of both ends of a stroke: where the driven slide's point is at these displacements, mm."""
    slider = motion.linkage.driven_slider
    if slider is not None:
        for name, displacement in (("start", start), ("end", end)):
            place = complex(slider.through + displacement * slider.direction)
            at = body_point(motion, slider.along, place)
            yield point_handle(f"stroke.{name}", at=at, label=f"{name} of the stroke")


def preview_data(linkage: AbstractLinkage, factor: Callable[[Number], float] | None) -> dict[str, object]:
    """A linkage as an editor moves it until the exact answer comes: its joints, and how its sizes place them.

    `numbers` has x, y, deg of the ground, then x and y of all `points`, each with its body and name, then the
    directions of slides, deg. A pin has the points that meet in it; a slide or slot a point, and one on its line.
    `by` has the changes of numbers for a change of 1 of each key, as pairs of index and change.
    factor: from a number as the recipe's text states it to that of the linkage; None to leave out `by`.
    """
    general, bodies = linkage.linkage, list(linkage.linkage.bodies)
    points = [(body, name) for body, places in general.bodies.items() for name in places]
    for slide in general.slides:
        points += [(slide.body, ""), (slide.along, "")]
    first = len(points) - 2 * len(general.slides)
    slides = [
        {
            "points": [first + 2 * k, first + 2 * k + 1],
            "direction": 3 + 2 * len(points) + k,
            "name": slide.name,
            "aligned": slide.is_aligned,
            "driven": slide is general.driven_slider,
        }
        for k, slide in enumerate(general.slides)
    ]
    base = _placing_numbers(general)
    return {
        "bodies": bodies,
        "driver": None if general.driven_slider else bodies.index(general.driver),
        "points": [[bodies.index(body), name] for body, name in points],
        "pins": [[points.index((body, name)) for body in on] for name, on in general.pins.items()],
        "slides": slides,
        "numbers": [to_digits(number, 12) for number in base],
        "by": {} if factor is None else _rates(linkage, base, factor),
    }


def _rates(linkage: AbstractLinkage, base: Real, factor: Callable[[Number], float]) -> dict[str, list[list[float]]]:
    """Changes of the numbers that place the joints, by key of the size."""
    rates = {}
    for number in numbers_in(linkage):
        step = CHANGE * (float(np.max(linkage.linkage.size) or 1.0) if number.unit == "mm" else 1.0)
        for change, changed in _changed(linkage, number, step):
            rate = (_placing_numbers(changed) - base) / change * factor(number)
            rates[f"linkage.{number.key}"] = [[int(k), to_digits(rate[k])] for k in np.flatnonzero(rate)]
    return rates


def _changed(linkage: AbstractLinkage, number: Number, step: float) -> Iterator[tuple[float, Linkage]]:
    """The linkage with a number changed by a step, or else by its opposite, if either is allowed."""
    for change in (step, -step):
        with suppress(DesignError):
            changed = with_number(linkage, number.key, number.value + change).linkage
            return iter([(change, changed)])
    return iter(())


def _placing_numbers(general: Linkage) -> Real:
    places = [complex(place) for points in general.bodies.values() for place in points.values()]
    for slide in general.slides:
        places += [complex(slide.point), complex(slide.through)]
    pairs = np.array([complex(general.origin), *places]).view(float)
    directions = [float(slide.direction_deg) for slide in general.slides]
    return np.array([*pairs[:2], general.ground_angle_deg, *pairs[2:], *directions])


def body_point(motion: Motion, body: str, place: complex) -> Complex:
    """Positions of a point of a body at the frames, mm; nan if the linkage cannot be assembled."""
    return np.where(motion.assembled, motion.bodies[body].point(place).position, np.nan)


def size_columns(motion: Motion) -> tuple[Column, ...]:
    """Displacement of the first traced point or of the output per mm of each length, or rotation of the output.

    The most influential size over all frames comes first. Empty for a general linkage, which has no named sizes.
    """
    linkage = motion.linkage
    ground, moving = linkage.ground, list(linkage.bodies)[1:]
    traced = [point for body in moving for point in _traced(linkage, body)]
    outputs = [body for body in moving if body in on_ground(linkage) - {linkage.driver}]
    if not (traced or outputs):
        return ()
    slides = [s.name for s in linkage.sliders if not traced and {s.body, s.along} == {outputs[-1], ground}]
    name = traced[0] if traced else f"{slides[0]}_displacement" if slides else f"{outputs[-1]}_angle"
    unit, scale = ("mm/mm", 1.0) if traced or slides else ("deg/mm", 180 / np.pi)
    columns = []
    for size in field_names(motion.given):
        if size.endswith("_deg") or "origin." in size:
            continue
        values = finite(scale * np.abs(motion.sensitivity(name, by=size)))
        words = f"change of the {name.replace('_', ' ')} for 1 {unit_name()} of {size}"
        columns.append(Column(f"{name}_by_{size.replace('.', '_')}", unit, words, values))
    # To six digits, so that rounding does not decide the order.
    columns.sort(key=lambda column: -to_digits(_largest(column.values), 6))
    # The rest is rounding: sizes that do not matter.
    usual = 1.0 if unit == "mm/mm" else scale / float(linkage.size)
    return tuple(column for column in columns if _largest(column.values) > ROUNDING * usual)


def _traced(linkage: Linkage, body: str) -> list[str]:
    """Points of a body that lie elsewhere than its pins."""
    points = linkage.bodies[body]
    pins = [place for point, place in points.items() if point in linkage.joint_points]
    return [point for point, place in points.items() if point not in linkage.joint_points and place not in pins]


def size_plot(columns: tuple[Column, ...]) -> tuple[Plot, ...]:
    """The plot of `size_columns`; empty if there are none."""
    return (
        (Plot(f"effect of 1 {unit_name()} of each size", tuple(column.id for column in columns), bars=True),)
        if columns
        else ()
    )


def _largest(values: Real) -> float:
    return float(np.nanmax(values, initial=0.0))
