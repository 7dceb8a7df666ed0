"""The gears of a linkage's meshes: their sizes from the distances of the pivots, and their positions on the bodies."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...core.units import bare_mm, marked, mm
from ...gear.pair import GearPair
from ...gear.spur import SpurGear
from ...plane.curve import AbstractCurve, Moved
from ...plane.vec import Complex, Pose, spaced_directions
from ..joints.gear_mesh import GearMesh
from ..linkage import Linkage
from .stock import LinkStock

# Largest relative difference of the modules of two meshes of one gear: that of rounded positions of pivots.
SAME_MODULE = 1e-4
# Largest reduction of the thickness of a tooth for backlash, and least rim between a hole and the roots, modules.
MOST_ALLOWANCE, LEAST_RIM = 0.1, 1.0
# Corners of the circle that stands for a gear where plates must not meet.
CORNERS = spaced_directions(48)


@record(eq=False)
class MeshGear:
    """The gear of a body about its pivot, both in mm in the frame of the body; turn: of its tooth from +y, rad."""

    gear: SpurGear
    pivot: complex
    turn: float

    @cached_property
    def outline(self) -> AbstractCurve:
        return Moved(self.gear.outline, Pose(self.pivot, complex(np.exp(1j * self.turn))))

    @property
    def room(self) -> float:
        """Radius within which holes leave a rim, mm."""
        return self.gear.root_radius - LEAST_RIM * self.gear.module

    def corners(self, inset: float) -> Complex:
        """Points around its tip circle, mm inside it by `inset`."""
        radius = max(0.0, self.gear.tip_radius - inset) / np.cos(np.pi / len(CORNERS))
        corners: Complex = self.pivot + radius * CORNERS
        return corners


def mesh_gears(mesh: GearMesh, linkage: Linkage, stock: LinkStock) -> tuple[SpurGear, SpurGear]:
    """The gears of a mesh, with the stock's clearance as backlash: twice the distance of the pivots over the sum of the
    teeth is their module.
    """
    start, end = mesh.pivots(linkage)
    module = 2 * abs(complex(end) - complex(start)) / sum(mesh.teeth)
    allowance = min(stock.clearance / 2, MOST_ALLOWANCE * module)
    try:
        first, second = (
            SpurGear(teeth, module, tooth_thickness_allowance=allowance, on_pointed_tip="cut") for teeth in mesh.teeth
        )
    except DesignError as error:
        problem = f"the gears of {mesh.name} with {mesh.teeth[0]} and {mesh.teeth[1]} teeth: {marked(error.problem)}"
        raise DesignError("meshes", problem, "give more teeth, or pivots farther apart", error.id) from None
    return first, second


def gear_pair(mesh: GearMesh, linkage: Linkage, stock: LinkStock) -> GearPair:
    """The same as a pair at the distance of the pivots."""
    return GearPair(*mesh_gears(mesh, linkage, stock))


def trains(linkage: Linkage, stock: LinkStock) -> Iterator[dict[str, MeshGear]]:
    """The gears by body, those in mesh with each other together; DesignError if a gear would need two sizes."""
    waiting = list(linkage.meshes)
    while waiting:
        train: dict[str, MeshGear] = {}
        while mesh := next((mesh for mesh in waiting if not train or {*mesh.bodies} & {*train}), None):
            waiting.remove(mesh)
            for body, wheel in _in_mesh(mesh, linkage, stock, train).items():
                known = train.setdefault(body, wheel)
                if known.gear.teeth != wheel.gear.teeth:
                    problem = f"{body} has gears of {known.gear.teeth} and of {wheel.gear.teeth} teeth"
                    raise DesignError("meshes", problem, "give it one number of teeth", "conflict")
                if abs(known.gear.module - wheel.gear.module) > SAME_MODULE * known.gear.module:
                    problem = (
                        f"the gear of {body} has a module of {mm(known.gear.module):.5g}, and {mesh.name} with "
                        f"{sum(mesh.teeth)} teeth between its pivots one of {mm(wheel.gear.module):.5g}"
                    )
                    distance = known.gear.module * sum(mesh.teeth) / 2
                    raise DesignError("meshes", problem, f"put its pivots {bare_mm(distance):.6g} mm apart", "conflict")
        yield train


def _in_mesh(mesh: GearMesh, linkage: Linkage, stock: LinkStock, train: dict[str, MeshGear]) -> dict[str, MeshGear]:
    """Both gears of a mesh, turned such that a tooth of one is in a space of the other; one may be turned already."""
    pivots = [complex(z) for z in mesh.pivots(linkage)]
    towards = float(np.angle(pivots[1] - pivots[0]))
    # Directions to the pitch point and of the bodies while the first is at 0; tooth and space of the second then agree.
    ahead, bodies = (towards, towards + np.pi), (0.0, mesh.angle)
    pitch = [2 * np.pi / teeth for teeth in mesh.teeth]
    known = [k for k in (0, 1) if mesh.bodies[k] in train] or [0]
    turns = [train[body].turn if body in train else 0.0 for body in mesh.bodies]
    one, other = known[0], 1 - known[0]
    # Teeth past the pitch point, in pitches: a whole number if a tooth is there. Those of both add up to a half.
    past = (ahead[one] - np.pi / 2 - bodies[one] - turns[one]) / pitch[one]
    turns[other] = ahead[other] - np.pi / 2 - bodies[other] - pitch[other] * (0.5 - past)
    places = [complex(linkage.bodies[body][mesh.pivot(linkage, body)]) for body in mesh.bodies]
    return dict(zip(mesh.bodies, map(MeshGear, mesh_gears(mesh, linkage, stock), places, turns)))
