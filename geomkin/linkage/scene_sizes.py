"""How far each size of a linkage moves its traced point, or turns its output, for the page."""

from __future__ import annotations

import numpy as np

from ..core.fields import to_digits
from ..model.scene import Plot
from ..model.table import Column, finite
from ..plane.vec import Real
from .linkage import Linkage
from .motion import ROUNDING, Motion, on_ground
from .sensitivity import field_names


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
        words = f"change of the {name.replace('_', ' ')} for 1 mm of {size}"
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
    return (Plot("effect of 1 mm of each size", tuple(column.id for column in columns), bars=True),) if columns else ()


def _largest(values: Real) -> float:
    return float(np.nanmax(values, initial=0.0))
