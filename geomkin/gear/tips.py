"""The way of one gear's tips through the spaces of the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..plane.vec import Array

if TYPE_CHECKING:
    from .pair import GearPair

# Points on each curve of a side, and places of a tip on its way. Fewer would see less than a hundred-thousandth of
# a module; the time stays at a millisecond.
POINTS, PLACES = 400, 4001


def side_angles(gear) -> tuple[Array, Array]:
    """Radii, rising, mm, and angles of the tooth's side from its middle, rad: root curve, flank and tip edge."""
    curves = [gear.root_curve, gear.flank, *([gear.tip_edge] if getattr(gear, "tip_edge", None) else [])]
    z = np.concatenate([c.point(np.linspace(c.breaks[0], c.breaks[-1], POINTS)) for c in curves])
    radius, angle = np.abs(z), np.arctan2(z.real, z.imag)
    order = np.argsort(radius, kind="stable")
    return radius[order], angle[order]


def tip_margin(pair: GearPair, of_second: bool) -> float:
    """Least distance along circles, mm, of one gear's tip edges from the other's teeth; negative inside them."""
    moving, still = (pair.second, pair.first) if of_second else (pair.first, pair.second)
    last = moving.flank.breaks[-1]
    edges = [moving.flank.point(last)]
    if (edge := getattr(moving, "tip_edge", None)) is not None:
        edges.extend(edge.point(np.linspace(0, 1, 9)))
    radii, angles = side_angles(still)
    # The tip's corner meets the other's circle of tips, and through the space leaves it again, within this angle.
    a, mine = pair.centre_distance, abs(edges[-1])
    reach = still.root_radius if still is pair.second and pair.is_internal else still.tip_radius
    cosine = (a**2 + mine**2 - reach**2) / (2 * a * mine)
    if pair.is_internal:
        cosine = -cosine if moving is pair.first else cosine
    span = np.arccos(np.clip(cosine, -1, 1)) + np.pi / moving.teeth
    swing = np.linspace(-span, span, PLACES)
    poses = pair.poses(swing * pair.ratio if of_second else swing)
    here, there = (poses[1], poses[0]) if of_second else (poses[0], poses[1])
    z = there.locate(here.place(np.array(edges)[:, None]))
    pitch = 2 * np.pi / still.teeth
    angle = np.arctan2(z.real, z.imag)
    off = np.abs(np.mod(angle + pitch / 2, pitch) - pitch / 2)
    radius = np.abs(z)
    beside = (off - np.interp(radius, radii, angles)) * radius
    within = (radius >= radii[0]) & (radius <= radii[-1])
    return float(beside[within].min()) if within.any() else float("inf")
