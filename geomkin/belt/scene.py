"""The moving drawing of a belt or chain drive: wheels that turn, and teeth or rollers that pass along the loop."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.units import mm
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneCurve, SceneMark, dimension
from ..model.table import Table
from ..plane.primitives import Circle
from ..plane.vec import Real
from .drive import LoopDrive
from .parts import LoopPlates
from .profiles import ChainProfile

# Largest number of pitches in a scene, frames per pitch and in total, and of drawn teeth; more make pages too large.
MOST_PITCHES, FINE, FRAMES, MOST_TEETH_DRAWN = 60, 8, 240, 24
# Time of a pitch, s: about what the eye follows.
PITCH_TIME = 0.15


def loop_scene(plates: LoopPlates, parts: tuple[Part, ...]) -> Scene:
    """The scene of a drive whose driver turns counterclockwise until all toothed wheels are where they began."""
    drive = plates.drive
    period, teeth = drive.period, drive.wheels[0].teeth or 1
    pitches = period if period <= MOST_PITCHES else teeth
    steps = max(2, min(FINE, FRAMES // pitches))
    passed = np.arange(pitches * steps + 1) / steps
    turn = 2 * np.pi * passed / teeth
    dimensions = (
        dimension(
            drive.axes[k - 1], drive.axes[k], f"distance {mm(abs(drive.axes[k] - drive.axes[k - 1])):.5g} of the axes"
        )
        for k in range(1, len(drive.axes))
    )
    # Only every few of the teeth are drawn, so that the last frame may have others than the first.
    is_cyclic = pitches == period and not drive.has_idlers and pitches % _every(drive) == 0
    return _scene(plates, parts, turn, PITCH_TIME * passed, tuple(dimensions), is_cyclic)


def turned_loop_scene(plates: LoopPlates, parts: tuple[Part, ...], turn: Real) -> Scene:
    """The scene at rotations of the driver, rad, (frames,), whose time a machine sets."""
    return _scene(plates, parts, turn, turn * 0, (), True)


def _scene(
    plates: LoopPlates, parts: tuple[Part, ...], turn: Real, time: Real, further: tuple[SceneCurve, ...], cyclic: bool
) -> Scene:
    drive = plates.drive
    table = Table(tuple(drive.columns(turn)))
    back = SceneCurve(drive.loop.path(drive.profile.back), "traced", f"outside of the {plates.loop_name}")
    lines = (SceneCurve(drive.loop.path(), "pitch", f"pitch line of the {plates.loop_name}"), back)
    circles = (
        SceneCurve(Circle(axis, wheel.radius), "construction", f"pitch circle of {wheel.name}")
        for axis, wheel in zip(drive.axes, drive.wheels)
    )
    axes = (
        SceneMark("fixed pin", turn * 0 + axis, "construction", f"axis of {wheel.name}")
        for axis, wheel in zip(drive.axes, drive.wheels)
    )
    plots = (Plot("rotations", tuple(column.id for column in table.columns[1:-1])),)
    curves, marks = (*lines, *circles, *further), (*axes, *_teeth(drive, turn))
    bodies = tuple(plates.bodies(parts, turn))
    return Scene(table, time, np.ones(turn.shape, bool), bodies, curves, marks, plots, cyclic)


def _every(drive: LoopDrive) -> int:
    """Every how many teeth of the loop one is drawn."""
    return -(-drive.count // MOST_TEETH_DRAWN)


def _teeth(drive: LoopDrive, turn: Real) -> Iterator[SceneMark]:
    """Teeth of the belt from the pitch line inwards, or rollers of the chain."""
    travel, profile = turn * drive.loop.wheels[0].pitches / (2 * np.pi), drive.profile
    for k in range(0, drive.count, _every(drive)):
        place, direction = drive.loop.place(drive.loop.first_tooth + travel + k)
        if isinstance(profile, ChainProfile):
            yield SceneMark("circle", place, "traced", radius=np.full(turn.shape, profile.roller / 2))
        else:
            yield SceneMark("line", place, "traced", vector=1j * profile.front * direction)
