"""The motion of a linkage as a table."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .measures import mechanical_advantage
from .motion import Motion
from ..plane.vec import Array
from ..table import Column, Table, finite, xy_columns


def motion_table(motion: Motion) -> Table:
    """Driver, time, every body that turns, every slide, transmission angle, and the points that are no pins."""
    linkage, speed = motion.linkage, motion.timing.speed
    time = (motion.drive - motion.drive[0]) / speed
    ground, driver = linkage.ground, linkage.driver
    if linkage.driven_slider:
        drive = Column(f"{driver}_place", "mm", f"place of the {driver} along its line", motion.drive)
    else:
        drive = Column(
            f"{driver}_angle", "deg", f"angle of the {driver} from the ground line", np.degrees(motion.drive)
        )
    columns = [
        drive,
        Column("time", "s", "time at the recipe's speed", time),
        *_bodies(motion),
        *_slides(motion),
        Column("transmission_angle", "deg", "least over the dyads", np.degrees(motion.transmission_angle)),
        *_outputs(motion),
        *(Column(f"{joint}_branch", "", f"branch of {joint}, 0 for none", b) for joint, b in motion.branches.items()),
    ]
    for body, points in linkage.bodies.items():
        for point in points:
            if body != ground and point not in linkage.pins:
                columns += _point(motion, point)
    return Table(tuple(columns))


# Share of the linkage's motion below which a turning is rounding: far above the last bits that processors differ by, so
# that all give the same columns, and far below what any drawing tells.
ROUNDING = 1e-12


def _bodies(motion: Motion) -> Iterator[Column]:
    places = [abs(z) for points in motion.linkage.bodies.values() for z in points.values()]
    reach = max(places, default=0.0) or 1.0
    sizes = {name: (_largest(body.first) * reach, _largest(body.origin.first)) for name, body in motion.bodies.items()}
    least = ROUNDING * max(max(turn, way) for turn, way in sizes.values())
    omega = max(_largest(body.omega) for body in motion.bodies.values())
    for name, body in motion.bodies.items():
        if name in (motion.linkage.ground, motion.linkage.driver) or sizes[name][0] <= least:
            continue
        yield Column(f"{name}_angle", "deg", f"direction of the {name} from +x", unwrapped_deg(body.direction), 1.0)
        yield Column(f"{name}_omega", "rad/s", f"angular velocity of the {name}", finite(body.omega), omega)
        alpha = finite(body.alpha)
        yield Column(f"{name}_alpha", "rad/s2", f"angular acceleration of the {name}", alpha, omega**2)


def _slides(motion: Motion) -> Iterator[Column]:
    for slider in motion.linkage.sliders:
        slide, name = motion.slide(slider.name), slider.name
        velocity, acceleration = finite(slide.velocity), finite(slide.acceleration)
        # Along its own guide the driver slides as it is told to, and what else is found is rounding.
        speed = _largest(motion.bodies[slider.body].origin.velocity)
        pull = _largest(motion.bodies[slider.body].origin.acceleration)
        yield Column(f"{name}_displacement", "mm", f"place on the line of {name}", slide.displacement)
        yield Column(f"{name}_velocity", "mm/s", f"sliding velocity of {name}", velocity, speed)
        yield Column(f"{name}_acceleration", "mm/s2", f"sliding acceleration of {name}", acceleration, pull)
        if _largest(slide.coriolis) > ROUNDING * max(pull, _largest(acceleration)):
            yield from xy_columns(
                f"{name}_coriolis", "mm/s2", f"Coriolis acceleration of {name}", finite(slide.coriolis)
            )


def _largest(values: Array) -> float:
    """Largest finite magnitude; 0 where there is none."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def _outputs(motion: Motion) -> Iterator[Column]:
    """Mechanical advantage of every body that the ground holds: what may drive something else."""
    linkage = motion.linkage
    held = {b for bodies in linkage.pins.values() if linkage.ground in bodies for b in bodies}
    held |= {b for s in linkage.sliders if linkage.ground in (s.body, s.along) for b in (s.body, s.along)}
    for name in linkage.bodies:
        if name in held - {linkage.ground, linkage.driver}:
            words = f"torque or force that the {name} gives for 1 of the driver's"
            torque = linkage.driven_slider and np.nan_to_num(motion.bodies[name].first).any()
            advantage = finite(mechanical_advantage(motion, name))
            yield Column(f"{name}_mechanical_advantage", "mm" if torque else "", words, advantage)


def _point(motion: Motion, point: str) -> Iterator[Column]:
    track, words = motion.point(point), point.replace("_", " ")
    yield from xy_columns(point, "mm", words, track.position)
    yield from xy_columns(f"{point}_velocity", "mm/s", f"velocity of the {words}", finite(track.velocity))
    yield from xy_columns(f"{point}_acceleration", "mm/s2", f"acceleration of the {words}", finite(track.acceleration))


def unwrapped_deg(direction: Array) -> Array:
    """Angles without jumps by a turn, nan kept."""
    angle, known = np.angle(direction), np.isfinite(direction)
    angle[known] = np.unwrap(angle[known])
    return np.degrees(angle)
