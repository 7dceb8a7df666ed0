"""Scene of a gear train: all gears in mesh, in their layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import lcm

import numpy as np

from ..core.arguments import checked
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneCurve, SceneHandle, circle_handle, dimension, mm, point_handle
from ..model.table import Table
from ..plane.curve import Moved
from ..plane.primitives import Circle
from ..plane.vec import Pose, Real
from .scene import (
    MOST_PITCHES,
    Meshing,
    axis_mark,
    bodies_at,
    centre_distance,
    contact_marks,
    meshing_scene,
    pitches_in_contact,
    turned_scene,
)
from .scene_pairs import LineOfAction
from .train import GearTrain, turn_columns


@checked
def train_scene(train: GearTrain, parts: Sequence[Part] = ()) -> Scene:
    """The scene of a gear train whose first gear turns counterclockwise.

    Parameters
    ----------
    train : GearTrain
        The train.
    parts : sequence of Part, optional
        The result of `train_parts`.

    Returns
    -------
    Scene
        Each gear is a body in the layer of its stage. The contacts are those of the first stage.

    Notes
    -----
    Derived here.
    """
    frames = _frames(train)
    pair, direction = train.pairs[0], train.directions[0]
    line, (start, _), pitch = LineOfAction(pair), pair.contact_lengths, pair.first.base_pitch
    roll = (start + pitch * frames.passed) / pair.first.base_radius
    axes = train.axes
    bodies = train_bodies(train, parts, roll + line.flank_turn + float(np.angle(direction / 1j)))
    curves = list[SceneCurve]()
    for k, (mesh, unit) in enumerate(zip(train.pairs, train.directions)):
        # A pair's contact is on +y of its driver.
        frame = Pose(complex(axes[k]), complex(unit / 1j))
        curves += _pitch_circles(train, k)
        path = LineOfAction(mesh).between(*mesh.contact_lengths)
        curves.append(SceneCurve(Moved(path, frame), "contact", f"path of contact of stage {k + 1}"))
        curves.append(_distance(train, k))
    contacts = axes[0] + direction / 1j * line.place(start + pitch * frames.all_since)
    marks = [axis_mark(frames, axis, label) for label, axis in _axes(train).items()]
    marks += contact_marks(contacts)
    columns = tuple(turn_columns(train, roll - roll[0]))
    plots = (Plot("rotations", tuple(column.id for column in columns[1:])),)
    return meshing_scene(Table(columns), frames, bodies, curves, marks, plots)


def train_bodies(train: GearTrain, parts: Sequence[Part], turn: Real) -> tuple[SceneBody, ...]:
    """The gears at rotations of the first one, rad, (frames,), each in the layer of its stage, and the ground."""
    poses, still = train.poses(turn), np.zeros(turn.shape, complex)
    bodies, layers = {"ground": Pose(still, still + 1)}, {"ground": 0}
    for k in range(len(train.stages)):
        for name, pose in ((f"driver_{k + 1}", poses[k]), (f"driven_{k + 1}", poses[k + 1])):
            bodies[name], layers[name] = pose, k + 1
    return bodies_at(parts, bodies, layers=layers)


def turned_train_scene(train: GearTrain, parts: Sequence[Part], turn: Real) -> Scene:
    """The scene of a train as a part of a machine. turn: of the first gear, rad, (frames,)."""
    circles = (circle for k in range(len(train.stages)) for circle in _pitch_circles(train, k))
    return turned_scene(turn_columns(train, turn), train_bodies(train, parts, turn), circles, _axes(train))


def _axes(train: GearTrain) -> dict[str, complex]:
    return {f"arbor {letter}": axis for letter, axis in train.arbor_axes.items()}


def _pitch_circles(train: GearTrain, k: int) -> Iterator[SceneCurve]:
    for name, radius, axis in zip(("driver", "driven"), train.pairs[k].working_radii, train.axes[k : k + 2]):
        yield SceneCurve(Circle(complex(axis), radius), "pitch", f"pitch circle of {name}_{k + 1}")


def _distance(train: GearTrain, k: int) -> SceneCurve:
    start, end = (complex(z) for z in train.axes[k : k + 2])
    if k == 0:
        return centre_distance(start, end)
    return dimension(start, end, f"centre distance {mm(abs(end - start))} of stage {k + 1}")


def _frames(train: GearTrain) -> Meshing:
    """The pitches of the first gear after which all gears are where they began, or as many as a scene may have."""
    teeth, contact_ratio = train.stages[0][0], train.pairs[0].contact_ratio
    period = lcm(pitches_in_contact(contact_ratio), *(Fraction(speed, teeth).denominator for speed in train.speeds))
    return Meshing(contact_ratio, min(period, MOST_PITCHES), period <= MOST_PITCHES)


def train_handles(train: GearTrain, are_stages_given: bool, are_directions_given: bool) -> Iterator[SceneHandle]:
    """Handles of the module of a train, of its directions and, if the recipe gives them, of its numbers of teeth.

    Parameters
    ----------
    train : GearTrain
        The train.
    are_stages_given : bool
        Whether the recipe gives the numbers of teeth.
    are_directions_given : bool
        Whether the recipe gives the directions.

    Returns
    -------
    iterator of SceneHandle
    """
    axes = train.axes
    radius = train.pairs[0].first.root_radius
    yield circle_handle("train.module", radius=radius, label="module")
    for k, pair in enumerate(train.pairs):
        if are_stages_given:
            for j, (name, gear_radius) in enumerate(zip(("driver", "driven"), pair.working_radii)):
                label = f"teeth of {name}_{k + 1}"
                yield circle_handle(f"train.stages[{k}][{j}]", radius=gear_radius, centre=axes[k + j], label=label)
        if are_directions_given:
            yield point_handle(f"train.directions_deg[{k}]", at=axes[k + 1], label=f"direction of stage {k + 1}")
