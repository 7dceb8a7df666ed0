"""The mate of a straight-sided tooth: the exact envelope, a tooth cut out by booleans, distances over positions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...gear.conjugate.conjugate import conjugate
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Pose, Real
from ..family import Method, MethodFamily, Tool

# Points of each curve that the exact outline is made of.
POINTS = 20
COUNTS = (40.0, 80.0, 160.0, 320.0, 640.0)
# Radii at which the sampled distances are looked at, and halvings of the angle there: to 1e-12 of a pitch.
RADII, HALVINGS = 60, 40


@record(eq=False)
class StraightTooth:
    """A straight-sided tooth and the sizes of its mate; the tool is the tooth, rolling round the mate.

    What is found is the mate's space, from tip to tip, on the side of -y.
    """

    teeth: int
    mate_teeth: int
    module: float
    tool: Tool

    @property
    def mate_radius(self) -> float:
        """Pitch radius of the mate, mm."""
        return self.module * self.mate_teeth / 2

    @property
    def tip_radius(self) -> float:
        """Of the mate, mm."""
        return self.mate_radius + self.module


def problem() -> StraightTooth:
    """40 straight-sided teeth of module 2, 25 deg, mating with 20."""
    teeth, mate_teeth, module = 40, 20, 2.0
    slope, high, deep = np.tan(np.radians(25.0)), 1.0, 1.2
    wide, narrow = np.pi / 4 + deep * slope, np.pi / 4 - high * slope
    r, mate = module * teeth / 2, module * mate_teeth / 2
    heights = 1j * np.array([-deep, -deep, high, high])
    corners = 1j * r + module * (np.array([-wide, wide, narrow, -narrow]) + heights)

    def place(angle: Real) -> Pose:
        # The gear's axis goes round the mate's, and the gear turns by so much more as the pitch circles roll.
        return Pose(-1j * (r + mate) * np.exp(1j * angle), np.exp(1j * angle * (1 + mate / r)))

    # The tooth goes through the mate while its axis goes round by a little more than a pitch to either side.
    return StraightTooth(teeth, mate_teeth, module, Tool(corners, 0.0, place, (-0.6, 0.6)))


def _exact(tooth: StraightTooth, _: float) -> Callable[[], Complex]:
    def space() -> Complex:
        gear = Polyline(tooth.tool.corners)
        mate = conjugate(gear, tooth.teeth, tooth.module * tooth.teeth / 2, tooth.mate_teeth, tooth.module)
        share = np.linspace(0, 1, POINTS)
        z = np.concatenate([step.curve.point(step.start + (step.end - step.start) * share) for step in mate.steps])
        turned = z * mate.pose.direction
        pitch = 2 * np.pi / mate.teeth
        return np.asarray(turned * np.exp(-1j * pitch * np.round(np.angle(turned.mean() / -1j) / pitch)))

    return space


def _cut(tooth: StraightTooth, count: float) -> Callable[[], Complex]:
    from ...plane import region as region

    def space() -> Complex:
        half, inner = np.pi / tooth.mate_teeth, 0.5 * tooth.mate_radius
        around = -1j * np.exp(1j * np.linspace(-half, half, 33))
        blank = np.concatenate([tooth.tip_radius * around, inner * around[::-1]])
        found = region.without([blank], tooth.tool.polygons(int(count), 1.0))
        z = np.concatenate([loops[0] for loops in found])
        kept = (np.abs(z) < tooth.tip_radius * (1 - 1e-9)) & (np.abs(z) > 1.01 * inner)
        kept &= np.abs(np.angle(z / -1j)) < half * (1 - 1e-9)
        left: Complex = z[kept]
        return left

    return space


def _sampled(tooth: StraightTooth, count: float) -> Callable[[], Complex]:
    """At each of many radii the angle at which the least distance over so many positions is 0, by halving."""
    positions = np.linspace(*tooth.tool.span, int(count))

    def space() -> Complex:
        radii = np.linspace(tooth.mate_radius - tooth.module, tooth.tip_radius, RADII + 2)[1:-1]
        # From the middle of the space, where the tooth has been, to that of the mate's tooth, where it never comes.
        within, beyond = np.zeros(RADII), np.full(RADII, np.pi / tooth.mate_teeth)
        for _ in range(HALVINGS):
            angle = 0.5 * (within + beyond)
            z = -1j * radii * np.exp(1j * angle)
            off = tooth.tool.distance(*np.broadcast_arrays(z[:, None], positions)).min(axis=1)
            within, beyond = np.where(off < 0, angle, within), np.where(off < 0, beyond, angle)
        side: Complex = -1j * radii * np.exp(0.5j * (within + beyond))
        return side

    return space


CONJUGATE_TOOTH: MethodFamily[StraightTooth, Complex] = MethodFamily(
    name="conjugate-tooth",
    title="Conjugate tooth",
    about="The space that a straight-sided tooth, 25 deg, module 2, one of 40, leaves in its mate of 20 teeth.",
    per="space",
    unit="mm",
    reference="brute force: the distance of every corner from the tooth, the least over all positions of the rolling, "
    "without the law of gearing",
    floor=1e-12,
    problem=problem,
    count=lambda _, found: 1,
    error=lambda tooth, found: np.abs(tooth.tool.clearance(found)),
    methods=(
        Method(
            "law of gearing",
            "Where the normal passes the pitch point, in closed form; what cuts what is settled by crossings, solved "
            f"for to rounding. {POINTS} points a curve (`conjugate`).",
            _exact,
            rationale="It is exact, trimmed corners included, and names the part of the tooth that cuts each curve.",
        ),
        Method(
            "cut by booleans",
            "The tooth at so many positions cut out of the blank (shapely).",
            _cut,
            "positions",
            COUNTS,
        ),
        Method(
            "sampled distances",
            f"At {RADII} radii on one side of the space, the angle at which the least distance from the tooth over so "
            "many positions is 0, by halving.",
            _sampled,
            "positions",
            COUNTS,
        ),
    ),
)
