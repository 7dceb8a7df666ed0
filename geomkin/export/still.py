"""A scene at one frame, as pictures of any format take it: what is shown, and how large it is."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache, cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..model.part import Part
from ..model.roles import ROLES
from ..model.scene import Scene, SceneBody, SceneMark
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.primitives import Circle
from ..plane.vec import Complex, Whole
from .job import Job

# What the page shows only when it is asked to: in a picture that stands still it hides the mechanism.
ASIDE = tuple(role for role, style in ROLES.items() if not style.shown)
# What may run far from the mechanism, and by how much of its size on each side it is followed. More, and the mechanism
# is a dot between two long curves.
FAR, ROOM = tuple(role for role, style in ROLES.items() if style.shown and style.room), 0.3
# Least width and height of a picture, share of the size of all that moves: one point is all that is seen of a block
# that stands on its rail. Less, and a rail as long as the way has strokes by the million.
LEAST = 0.01
# Share of a turn at which the driver stands unless it is told, and of a way there and back: at the start of a turn and
# half way cranks lie along the ground.
SHARE, HALF_WAY = 0.13, 0.5
# Of the larger side of a picture, what is called a pixel here: what sizes of letters and strokes are told in.
PIXELS = 420
# Points of an outline at most that bounds and names are looked up by.
MOST_POINTS = 400


def colours() -> str:
    """The colours and fonts of the page, as its style sheet begins."""
    from importlib.resources import files

    return files("geomkin.page.player").joinpath("style.css").read_text("utf-8").strip().partition("\n* {")[0]


@cache
def palette() -> dict[str, str]:
    """The colours of the page by name, as it has them on white."""
    return dict(re.findall(r"--(\w+): (#[0-9a-f]{3,6});", colours().split("}")[0]))


def frame_at(scene: Scene, at: float | None) -> int:
    """The frame at which the driver stands there, in its own unit; of those at which the mechanism can be.

    DesignError for where the driver never is, or the mechanism cannot be.
    """
    drive, closed = np.asarray(scene.drive.values, dtype=float), np.flatnonzero(scene.assembled)
    if not len(closed):
        raise DesignError("assembly_at", "the mechanism can be put together nowhere", "change its sizes")
    if at is None:
        wanted = drive[0] + (SHARE if scene.cyclic else HALF_WAY) * (drive[-1] - drive[0])
        return int(closed[np.argmin(np.abs(drive[closed] - wanted))])
    nearest = int(np.argmin(np.abs(drive - at)))
    step = float(np.abs(np.diff(drive)).max(initial=0.0))
    found = f"found {at:g} {scene.drive.unit}".rstrip()
    if abs(drive[nearest] - at) > step:
        low, high = float(drive.min()), float(drive.max())
        raise DesignError("assembly_at", f"{found}, where the driver never is", f"give {low:g} to {high:g}")
    if not scene.assembled[nearest]:
        best = drive[closed[np.argmin(np.abs(drive[closed] - at))]]
        raise DesignError("assembly_at", f"{found}, where the mechanism cannot be", f"give {best:g}, the nearest")
    return nearest


@record(eq=False)
class Still:
    """What a picture shows. frames: those that it has to have room for; the first is the one that is drawn."""

    scene: Scene
    frames: Whole

    @property
    def frame(self) -> int:
        return int(self.frames[0])

    @cached_property
    def size(self) -> float:
        """Of all places where something goes, mm, corner to corner."""
        low, high = self.scene.box
        outlines = [float(np.ptp(points.real) + np.ptp(points.imag)) for row in self.outlines for points in row]
        return max(abs(high - low), *outlines, 0.0) or 1.0

    @property
    def digits(self) -> int:
        """Decimals of mm: a twentieth of what a screen shows."""
        return 4 - int(np.floor(np.log10(self.size)))

    @property
    def tolerance(self) -> float:
        """Between a curve and its chords, mm."""
        return SCREEN * self.size

    @cached_property
    def outlines(self) -> list[list[Complex]]:
        """Points of the parts' outlines, body by body, in each body's own frame."""
        return [[some_points(part.outline) for part in body.parts] for body in self.scene.bodies]

    @cached_property
    def marks(self) -> tuple[SceneMark, ...]:
        """Those that are shown, and can be at a frame of the picture."""
        shown = [mark for mark in self.scene.marks if mark.role not in ASIDE]
        return tuple(mark for mark in shown if np.isfinite(mark.place[self.frames]).any())

    @cached_property
    def bodies(self) -> tuple[SceneBody, ...]:
        """From the lowest up; those that can be at a frame of the picture."""
        there = [body for body in self.scene.bodies if np.isfinite(body.origin[self.frames]).any()]
        return tuple(sorted(there, key=lambda body: body.layer))

    @property
    def shows_ground(self) -> bool:
        """Whether a plate shows the ground; where none does, pivots have stands and blocks have rails."""
        return any(body.fixed and body.parts for body in self.bodies)

    def tint(self, body: SceneBody) -> str:
        """The name of its colour in the palette, as the page has it."""
        moving = [other for other in self.scene.bodies if not other.fixed]
        return "ground" if body.fixed else f"t{moving.index(body) % 8}"

    def points_of(self, body: SceneBody) -> list[Complex]:
        """Points of its parts' outlines, in its own frame."""
        return self.outlines[self.scene.bodies.index(body)]

    @cached_property
    def hole_radii(self) -> dict[SceneMark, float]:
        """Radius, mm, of the widest round hole in which a pin sits."""
        k, near, found = self.frame, 1e-3 * self.size, dict[SceneMark, float]()
        for body in self.bodies:
            for hole in (hole for part in body.parts for hole in part.holes if isinstance(hole, Circle)):
                place = body.origin[k] + body.direction[k] * hole.centre
                for mark in self.marks:
                    if mark.sort.endswith("pin") and abs(mark.place[k] - place) < near:
                        found[mark] = max(found.get(mark, 0.0), hole.radius)
        return found

    @cached_property
    def bounds(self) -> tuple[complex, complex]:
        """Lower left and upper right corner, mm, of all that is shown, over the frames of the picture."""
        always = _box([*self._bodies_seen(), *self._marks_seen(), *self._curves_seen()])
        least = LEAST * self.size * (1 + 1j) / 2
        middle = (always[0] + always[1]) / 2
        always = _box([np.array([*always, middle - least, middle + least])])
        far = _box([np.array(always), *self._curves_seen(FAR), *self._marks_seen(FAR)])
        room = ROOM * (always[1] - always[0])
        low = complex(max(far[0].real, (always[0] - room).real), max(far[0].imag, (always[0] - room).imag))
        return low, complex(min(far[1].real, (always[1] + room).real), min(far[1].imag, (always[1] + room).imag))

    def _bodies_seen(self) -> Iterator[Complex]:
        for body, outlines in zip(self.scene.bodies, self.outlines):
            frames = self.frames if not body.fixed else self.frames[:1]
            for points in outlines:
                yield body.origin[frames, None] + body.direction[frames, None] * points

    def _marks_seen(self, roles: Sequence[str] = ()) -> Iterator[Complex]:
        for mark in (mark for mark in self.marks if (mark.role in FAR) == bool(roles)):
            frames = slice(None) if mark.trail else self.frames
            place = np.asarray(mark.place)[frames]
            yield place
            if mark.vector is not None:
                yield place + mark.vector[frames]
            if mark.radius is not None:
                yield np.concatenate([place + mark.radius[frames] * corner for corner in (1 + 1j, -1 - 1j)])

    def _curves_seen(self, roles: Sequence[str] = ()) -> Iterator[Complex]:
        poses = {body.name: body for body in self.scene.bodies}
        for curve in (curve for curve in self.scene.curves if (curve.role in FAR) == bool(roles)):
            points = some_points(curve.curve)
            if curve.body in poses:
                body = poses[curve.body]
                points = body.origin[self.frames, None] + body.direction[self.frames, None] * points
            yield points

    @property
    def pixel(self) -> float:
        """What sizes of letters and strokes are told in, mm."""
        across = self.bounds[1] - self.bounds[0]
        return max(across.real, across.imag) / PIXELS

    def trail_runs(self, mark: SceneMark) -> Iterator[Complex]:
        """Where a point goes, all the time: a run of points for each stretch on which it can be."""
        kept = kept_frames(len(self.scene.time))
        place = np.asarray(mark.place)[kept]
        for run in np.split(np.arange(len(kept)), np.flatnonzero(np.diff(np.isfinite(place))) + 1):
            if len(run) > 1 and np.isfinite(place[run[0]]):
                yield place[run]


def some_points(curve: AbstractCurve) -> Complex:
    """Points of a curve, some hundreds at most."""
    ends = curve.breaks
    points = curve.point(np.linspace(ends[0], ends[-1], 65))
    size = float(np.ptp(points.real) + np.ptp(points.imag)) or 1.0
    fine = flatten(curve, 2e-3 * size)
    return fine[:: len(fine) // MOST_POINTS + 1]


def _box(rows: Sequence[Complex]) -> tuple[complex, complex]:
    points = np.concatenate([np.ravel(row) for row in rows] or [np.zeros(0, complex)])
    points = points[np.isfinite(points)]
    if not len(points):
        points = np.array([-1 - 1j, 1 + 1j])
    return complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())


@record(eq=False)
class InPlace:
    """A part where it stands.

    name: of the part, with a number where another has it; body: that it belongs to. origin, mm, and direction, a unit
    complex number: of the part's frame in the assembly's; height: of its lower face, mm.
    """

    name: str
    part: Part
    body: SceneBody
    origin: complex
    direction: complex
    height: float


def in_place(job: Job) -> tuple[Still, tuple[InPlace, ...]]:
    """The assembly as it stands where the job wants its driver, and its parts, body by body."""
    scene = job.scene
    still = Still(scene, np.array([frame_at(scene, job.assembly_at)]))
    heights, names, found = _heights(scene), list[str](), list[InPlace]()
    for body in scene.bodies:
        origin, direction = (
            complex(np.broadcast_to(row, scene.assembled.shape)[still.frame]) for row in (body.origin, body.direction)
        )
        for part in body.parts:
            name = f"{part.name} {names.count(part.name) + 1}" if part.name in names else part.name
            names.append(part.name)
            found.append(InPlace(name, part, body, origin, direction, heights[body.layer]))
    return still, tuple(found)


def _heights(scene: Scene) -> dict[int, float]:
    """Height of the lower face of each layer, mm: the lowest that has a part stands on 0, each is as thick as its
    thickest part, and one that stays empty as the thickest of all.
    """
    thick: dict[int, float] = {}
    for body in scene.bodies:
        for part in body.parts:
            thick[body.layer] = max(part.thickness, thick.get(body.layer, 0.0))
    heights, height = dict[int, float](), 0.0
    for layer in range(min(thick, default=0), max(thick, default=-1) + 1):
        heights[layer] = height
        height += thick.get(layer, max(thick.values()))
    return heights


# Distance between an outline and its chords, as a share of the scene's size. More, and corners show on a wide screen;
# a tenth of it, and a gear's page is three times as long.
SCREEN = 2e-4
# Frames of a page at most, evenly chosen. More make no smoother picture and a page of megabytes; fewer would leave
# out frames of a full turn in half degrees.
MOST_FRAMES = 1001


def kept_frames(frames: int) -> Whole:
    """Which of so many frames a page shows, both ends included."""
    return np.rint(np.linspace(0, frames - 1, min(frames, MOST_FRAMES))).astype(np.intp)
