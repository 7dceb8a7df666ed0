"""Scene of a fit test: a circle of the pin's size passes over the holes, and shows how much wider each one is."""

from __future__ import annotations

import numpy as np

from ..core.arguments import checked
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneMark
from ..model.table import Column, Table
from ..plane.primitives import Circle
from .fit_test import FitTest

# Frames from one hole to the next, and their duration, s: what the eye follows.
FRAMES_PER_HOLE, HOLE_TIME = 20, 0.5


@checked
def fit_test_scene(fit_test: FitTest, parts: tuple[Part, ...]) -> Scene:
    """The coupon and the gauge at rest, and a circle of the pin's diameter that passes over the holes.

    Parameters
    ----------
    fit_test : FitTest
        Its sizes.
    parts : tuple of Part
        The result of `fit_test_parts`.

    Returns
    -------
    Scene
    """
    along = np.linspace(0, fit_test.count - 1, FRAMES_PER_HOLE * (fit_test.count - 1) + 1)
    circles = [hole for hole in parts[0].holes if isinstance(hole, Circle)]
    frames, nearest = len(along), np.rint(along).astype(int)
    place = np.interp(along, np.arange(fit_test.count), [circle.centre for circle in circles])
    table = Table(
        (
            Column("hole_number", "", "position of the pin, as the number of a hole", along + 1),
            Column("difference", "mm", "diameter of the nearest hole minus that of the pin", fit_test.offsets[nearest]),
        )
    )
    still, upright = np.zeros(frames, dtype=complex), np.ones(frames, dtype=complex)
    bodies = tuple(
        SceneBody(part.name, (part,), still, upright, fixed=part is parts[0], named=part is not parts[0])
        for part in parts
    )
    pin = SceneMark("circle", place, label="pin", radius=np.full(frames, fit_test.pin / 2))
    plots = (Plot("hole minus pin", ("difference",)),)
    return Scene(table, HOLE_TIME * along, np.full(frames, True), bodies, marks=(pin,), plots=plots, cyclic=False)
