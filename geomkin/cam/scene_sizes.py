"""How far each length of a cam turns its pressure angle, for the page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..core.fields import to_digits
from ..model.scene import Plot, Scene
from ..model.table import Column, Table
from .cam import Cam

# Change, deg per mm, below which a length matters only by rounding.
LEAST = 1e-9


def with_size_plot(scene: Scene, cam: Cam) -> Scene:
    """The scene of a cam with a plot of the change of the pressure angle per mm of each length.

    The most influential length comes first. A face that does not turn has the same pressure angle with all lengths, and
    its scene no such plot.
    """
    columns = [column for column in _columns(scene, cam) if np.max(column.values) > LEAST]
    if not columns:
        return scene
    # To six digits, so that rounding does not decide the order.
    columns.sort(key=lambda column: -to_digits(np.max(column.values), 6))
    plot = Plot("effect of 1 mm of each length", tuple(column.id for column in columns), bars=True)
    return replace(scene, table=Table((*scene.table.columns, *columns)), plots=(*scene.plots, plot))


def _columns(scene: Scene, cam: Cam) -> Iterator[Column]:
    angle = np.radians(scene.table["cam_angle"])
    for size, (_, rate) in cam.follower.contact_rates(cam.program.motion(angle), cam.base_radius, cam.sense).items():
        if not size.endswith("_deg"):
            words = f"change of the pressure angle for 1 mm of {size}"
            yield Column(f"pressure_angle_by_{size}", "deg/mm", words, np.abs(np.degrees(rate)))
