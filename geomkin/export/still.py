"""A scene at one frame for pictures of any format: its visible elements, its size, and the positions of names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Sequence
from functools import cache, cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.named import VIEWS, named
from ..core.records import record
from ..model.part import Part
from ..model.scene import ROLES, Scene, SceneBody, SceneMark
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.primitives import Circle
from ..plane.vec import Complex, Mask, Real, Whole, box_of
from .job import Job, lacking
from .svg_path import FINE

# Roles that the page shows only on request; in a still picture they would cover the mechanism.
HIDDEN = tuple(role for role, style in ROLES.items() if not style.shown)
# Roles that may extend far from the mechanism, and the margin on each side, as a share of its size, up to which they
# are included. A larger margin makes the mechanism tiny.
FAR, ROOM = tuple(role for role, style in ROLES.items() if style.shown and style.room), 0.3
# Least width and height of a picture as a share of the size of the motion, since a block on its rail may have no extent
# in one direction. With a smaller value a rail has millions of strokes.
LEAST = 0.01
# Default driver position as a share of a turn, and of a stroke. At the start and the middle of a turn cranks are
# collinear with the ground.
SHARE, HALF_WAY = 0.13, 0.5
# Number of pixels along the larger side of a picture; letters and strokes are sized in these pixels.
PIXELS = 420
# Most points of an outline for bounds and names.
MOST_POINTS = 400


@cache
def palette() -> dict[str, str]:
    """The colours of the page on white, by name."""
    return dict(re.findall(r"--(\w+): (#[0-9a-f]{3,6});", named(VIEWS["colours"])().split("}")[0]))


def rgb(name: str) -> tuple[int, int, int]:
    """Red, green and blue of a colour of the palette."""
    digits = palette()[name].lstrip("#")
    red, green, blue = bytes.fromhex(digits if len(digits) == 6 else "".join(2 * digit for digit in digits))
    return red, green, blue


def frame_at(scene: Scene, at: float | None) -> int:
    """The assembled frame nearest to a driver position, in the driver's unit.

    DesignError if the driver never reaches it, or the mechanism cannot be assembled there.
    """
    drive, assembled = np.asarray(scene.drive.values, dtype=float), np.flatnonzero(scene.assembled)
    if not len(assembled):
        problem = "the mechanism cannot be assembled in any position"
        raise DesignError("assembly_at", problem, "change its sizes", "does-not-assemble")
    if at is None:
        at = drive[0] + (SHARE if scene.cyclic else HALF_WAY) * (drive[-1] - drive[0])
        return int(assembled[np.argmin(np.abs(drive[assembled] - at))])
    nearest = int(np.argmin(np.abs(drive - at)))
    step = float(np.abs(np.diff(drive)).max(initial=0.0))
    found = f"found {at:g} {scene.drive.unit}".rstrip()
    if abs(drive[nearest] - at) > step:
        low, high = float(drive.min()), float(drive.max())
        problem = f"{found}, outside the range of the driver"
        raise DesignError("assembly_at", problem, f"give {low:g} to {high:g}", "out-of-range")
    if not scene.assembled[nearest]:
        best = drive[assembled[np.argmin(np.abs(drive[assembled] - at))]]
        problem = f"{found}, where the mechanism cannot be assembled"
        raise DesignError("assembly_at", problem, f"give {best:g}, the nearest", "does-not-assemble")
    return nearest


@record(eq=False)
class Still:
    """The visible elements of a picture. It shows the first of `frames` and has room for all of them."""

    scene: Scene
    frames: Whole

    @property
    def frame(self) -> int:
        return int(self.frames[0])

    @cached_property
    def size(self) -> float:
        """Size of the whole motion, mm, corner to corner."""
        low, high = self.scene.box
        outlines = [float(np.ptp(points.real) + np.ptp(points.imag)) for row in self.outlines for points in row]
        return max(abs(high - low), *outlines, 0.0) or 1.0

    @property
    def digits(self) -> int:
        """Decimals of mm: a twentieth of what a screen resolves."""
        return 4 - int(np.floor(np.log10(self.size)))

    @property
    def tolerance(self) -> float:
        """Distance between a curve and its chords, mm."""
        return FINE * self.pixel

    @cached_property
    def outlines(self) -> list[list[Complex]]:
        """Points of the parts' outlines by body, in each body's frame."""
        return [[some_points(part.outline) for part in body.parts] for body in self.scene.bodies]

    @cached_property
    def marks(self) -> tuple[SceneMark, ...]:
        """Marks that are shown and exist at a frame of the picture."""
        shown = [mark for mark in self.scene.marks if mark.role not in HIDDEN]
        return tuple(mark for mark in shown if np.isfinite(mark.place[self.frames]).any())

    @cached_property
    def bodies(self) -> tuple[SceneBody, ...]:
        """Bodies that exist at a frame of the picture, the lowest first."""
        existing = (body for body in self.scene.bodies if np.isfinite(body.origin[self.frames]).any())
        return tuple(sorted(existing, key=lambda body: body.layer))

    @property
    def shows_ground(self) -> bool:
        """Whether a plate shows the ground; if not, pivots have supports and blocks have rails."""
        return any(body.fixed and body.parts for body in self.bodies)

    def tint(self, body: SceneBody) -> str:
        """Name of the body's colour in the palette, as on the page."""
        moving = [other for other in self.scene.bodies if not other.fixed]
        return "ground" if body.fixed else f"t{moving.index(body) % 8}"

    def points_of(self, body: SceneBody) -> list[Complex]:
        """Points of the outlines of a body's parts, in its frame."""
        return self.outlines[self.scene.bodies.index(body)]

    @cached_property
    def hole_radii(self) -> dict[SceneMark, float]:
        """Radius, mm, of the widest round hole around each pin."""
        k, near, radii = self.frame, 1e-3 * self.size, dict[SceneMark, float]()
        for body in self.bodies:
            for hole in (hole for part in body.parts for hole in part.holes if isinstance(hole, Circle)):
                place = body.origin[k] + body.direction[k] * hole.centre
                for mark in self.marks:
                    if mark.sort.endswith("pin") and abs(mark.place[k] - place) < near:
                        radii[mark] = max(radii.get(mark, 0.0), hole.radius)
        return radii

    @cached_property
    def bounds(self) -> tuple[complex, complex]:
        """Lower left and upper right corner, mm, of all visible elements over the frames of the picture."""
        low, high = _box([*self._body_points(), *self._mark_points(), *self._curve_points()])
        least, middle = LEAST * self.size * (1 + 1j) / 2, (low + high) / 2
        low, high = _box([np.array([low, high, middle - least, middle + least])])
        far_low, far_high = _box([np.array([low, high]), *self._curve_points(FAR), *self._mark_points(FAR)])
        room = ROOM * (high - low)
        low, high = low - room, high + room
        low = complex(max(far_low.real, low.real), max(far_low.imag, low.imag))
        return low, complex(min(far_high.real, high.real), min(far_high.imag, high.imag))

    def _body_points(self) -> Iterator[Complex]:
        for body, outlines in zip(self.scene.bodies, self.outlines):
            frames = self.frames if not body.fixed else self.frames[:1]
            for points in outlines:
                yield body.origin[frames, None] + body.direction[frames, None] * points

    def _mark_points(self, roles: Sequence[str] = ()) -> Iterator[Complex]:
        for mark in (mark for mark in self.marks if (mark.role in FAR) == bool(roles)):
            frames = slice(None) if mark.trail else self.frames
            place = np.asarray(mark.place)[frames]
            yield place
            if mark.vector is not None:
                yield place + mark.vector[frames]
            if mark.radius is not None:
                yield np.concatenate([place + mark.radius[frames] * corner for corner in (1 + 1j, -1 - 1j)])

    def _curve_points(self, roles: Sequence[str] = ()) -> Iterator[Complex]:
        poses = {body.name: body for body in self.scene.bodies}
        for curve in (curve for curve in self.scene.curves if (curve.role in FAR) == bool(roles)):
            points = some_points(curve.curve)
            if curve.body in poses:
                body = poses[curve.body]
                points = body.origin[self.frames, None] + body.direction[self.frames, None] * points
            yield points

    @property
    def pixel(self) -> float:
        """Size of a pixel, mm."""
        across = self.bounds[1] - self.bounds[0]
        return max(across.real, across.imag) / PIXELS

    def trail_runs(self, mark: SceneMark) -> Iterator[Complex]:
        """The path of a point over the whole motion, as runs of points where it exists."""
        place = np.asarray(mark.place)[kept_frames(len(self.scene.time))]
        for run in np.split(np.arange(len(place)), np.flatnonzero(np.diff(np.isfinite(place))) + 1):
            if len(run) > 1 and np.isfinite(place[run[0]]):
                yield place[run]


def some_points(curve: AbstractCurve) -> Complex:
    """At most some hundreds of points of a curve."""
    ends = curve.breaks
    points = curve.point(np.linspace(ends[0], ends[-1], 65))
    size = float(np.ptp(points.real) + np.ptp(points.imag)) or 1.0
    fine = flatten(curve, 2e-3 * size)
    return fine[:: len(fine) // MOST_POINTS + 1]


def _box(rows: Sequence[Complex]) -> tuple[complex, complex]:
    points = np.concatenate([np.ravel(row) for row in rows] or [np.zeros(0, complex)])
    points = points[np.isfinite(points)]
    return box_of(points if len(points) else np.array([-1 - 1j, 1 + 1j]))


@record(eq=False)
class InPlace:
    """A part in the assembly.

    `name` is the part's name, numbered if it repeats. `origin`, mm, and `direction`, unit complex, are those of the
    part's frame in the assembly's; `height` is that of its lower face, mm.
    """

    name: str
    part: Part
    body: SceneBody
    origin: complex
    direction: complex
    height: float


def in_place(job: Job) -> tuple[Still, tuple[InPlace, ...]]:
    """The assembly at the job's driver position, and its parts by body. Raises DesignError if there are no parts."""
    scene = job.scene
    still = Still(scene, np.array([frame_at(scene, job.assembly_at)]))
    heights, names, placements = _heights(scene), list[str](), list[InPlace]()
    for body in scene.bodies:
        origin, direction = (
            complex(np.broadcast_to(row, scene.assembled.shape)[still.frame]) for row in (body.origin, body.direction)
        )
        for part in body.parts:
            name = f"{part.name} {names.count(part.name) + 1}" if part.name in names else part.name
            names.append(part.name)
            placements.append(InPlace(name, part, body, origin, direction, heights[body.layer]))
    if not placements:
        raise lacking("part")
    return still, tuple(placements)


def _heights(scene: Scene) -> dict[int, float]:
    """Height of the lower face of each layer, mm.

    The lowest layer with a part is at 0. Each is as thick as its thickest part, an empty one as the thickest of all.
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


# Distance between an outline on a page and its chords, as a share of the scene's size. Larger values show visible
# corners on a wide screen; a tenth of it makes a gear's page three times as large.
SCREEN = 2e-4
# Largest number of frames of a page, evenly chosen. More make a page of megabytes and no smoother motion; fewer
# would leave out frames of a full turn in half degrees.
MOST_FRAMES = 1001


def kept_frames(frames: int) -> Whole:
    """The frames that a page shows, both ends included."""
    return np.rint(np.linspace(0, frames - 1, min(frames, MOST_FRAMES))).astype(np.intp)


# Height of letters, in pixels of the picture. Smaller ones are illegible in a README, larger ones hide plates.
LETTER = 11.0
# Numbers of positions along and across a body that are tried for its name. Fewer miss the rim of a ring; more have no
# effect.
ALONG, ACROSS = 21, 11
# Relative difference of length and width, as a share of the spread, below which a body counts as round.
EVEN = 1e-6
# Width of a letter over its height: of Latin letters, and of those that fill a square.
NARROW, WIDE = 0.52, 1.0
# Shift of a tested position as a share of its size. Without it rounding would decide whether positions exactly on an
# edge, which mirrored copies often have, are on a plate.
ASIDE = 1e-5 * (1 + 0.7j)
# Costs of positions on another name, on a pin, on a covered part of the body or off it (per third of the letters), on
# a traced path, and far from the middle.
ON_NAME, ON_PIN, COVERED, BESIDE, ON_PATH, AWAY = 40.0, 6.0, 2.5, 0.5, 1.0, 1.5
# Directions from a point in which its name may be placed.
AROUND = np.exp(1j * np.radians([45, 135, -45, -135, 0, 180, 90, -90]))
# A name's text and role, the positions at which it may be placed, mm, and the cost of each.
Candidates = tuple[str, str, Complex, Real]


@record(eq=False)
class Name:
    """A name in a picture: the middle and half size of its letters, mm, and its role ("" for a body's)."""

    text: str
    place: complex
    half: complex
    role: str = ""


def place_labels(still: Still) -> tuple[Name, ...]:
    """The names, bodies first, each in the best position that the earlier ones leave.

    A name that would overlap another is left out, since neither would be legible.
    """
    tall = LETTER * still.pixel
    obstacles = _obstacles(still, tall)
    names: list[Name] = []
    for text, role, places, cost in (*_on_bodies(still, tall), *_on_lines(still, tall), *_at_points(still, tall)):
        half = half_size(text, tall)
        for name in names:
            apart, room = places - name.place, half + name.half
            cost = cost + ON_NAME * ((np.abs(apart.real) < room.real) & (np.abs(apart.imag) < 1.15 * room.imag))
        for price, points, radius in obstacles:
            offset = places[:, None] - points
            overlaps = (np.abs(offset.real) < half.real + radius) & (np.abs(offset.imag) < half.imag + radius)
            cost = cost + price * (overlaps.any(axis=1) if price == ON_PATH else overlaps.sum(axis=1))
        best = int(np.argmin(np.round(cost, 6)))
        if cost[best] < ON_NAME:
            names.append(Name(text, complex(places[best]), half, role))
    return tuple(names)


def _obstacles(still: Still, tall: float) -> list[tuple[float, Complex, Real | float]]:
    """Pins, dots and traced paths: the cost of a name on each, their points and radii, mm."""
    k = still.frame
    joints = [m for m in still.marks if m.sort.endswith("pin") or m.sort == "slide"]
    pins = np.array([m.place[k] for m in joints], dtype=complex)
    pin_radii = np.array([min(still.hole_radii.get(m, 0.4 * tall), 0.8 * tall) for m in joints])
    dots = [m.place[k] for m in still.marks if m.sort == "point"]
    # If no plate shows the ground, a support is drawn below the pivot.
    dots += [m.place[k] - 0.8j * tall for m in joints if m.sort == "fixed pin" and not still.shows_ground]
    paths = [run for mark in still.marks if mark.trail for run in still.trail_runs(mark)]
    path = np.concatenate([*paths, np.zeros(0, complex)])
    return [(ON_PIN, pins, pin_radii), (ON_PIN, np.array(dots, dtype=complex), 0.3 * tall), (ON_PATH, path, 0.0)]


def _on_bodies(still: Still, tall: float) -> Iterator[Candidates]:
    k = still.frame
    lines = {mark.label for mark in still.marks if mark.sort == "line"}
    for body in sorted(still.bodies, key=lambda body: _extent(still, body)):
        if not body.named:
            continue
        text = _spaced(body.name)
        half = half_size(text, tall)
        if body.parts and np.isfinite(body.origin[k]):
            yield text, "", *_on(still, body, half)
        elif not body.fixed and body.name not in lines and (slide := _slide_of(still, body)) is not None:
            aside = half.real + 1.2 * tall
            offsets = np.array([-1.6j * tall, 1.6j * tall, aside, -aside, -2.8j * tall, 2.8j * tall])
            yield text, "", slide + offsets, np.arange(6) * 0.1


def _on_lines(still: Still, tall: float) -> Iterator[Candidates]:
    k = still.frame
    lines = {m.label: m for m in reversed(still.marks) if m.sort == "line"}
    for label in dict.fromkeys(m.label for m in still.marks if m.sort == "line" and m.label and m.role != "contact"):
        mark = lines[label]
        if mark.vector is not None and np.isfinite(mark.place[k] + mark.vector[k]):
            text = _spaced(label)
            shares = np.array([0.5, 0.35, 0.65, 0.2, 0.8])
            on, aside = mark.place[k] + shares * mark.vector[k], half_size(text, tall).real + 0.5 * tall
            steps, away = (0, aside, -aside, 1.7j * tall, -1.7j * tall), np.abs(shares - 0.5)
            cost = np.concatenate([0.5 * (step != 0) + away for step in steps])
            yield text, mark.role, np.concatenate([on + step for step in steps]), cost


def _at_points(still: Still, tall: float) -> Iterator[Candidates]:
    for mark in still.marks:
        place = mark.place[still.frame]
        if mark.sort == "point" and mark.label and np.isfinite(place):
            text = _spaced(mark.label)
            half = half_size(text, tall)
            corners = np.sign(np.round(AROUND.real, 9)) * half.real + 1j * np.sign(np.round(AROUND.imag, 9)) * half.imag
            offsets = np.concatenate([corners + 0.75 * tall * AROUND, 1.3 * corners + 1.8 * tall * AROUND])
            yield text, mark.role, place + offsets, 0.05 * np.arange(len(offsets))


def half_size(text: str, tall: float) -> complex:
    """Half of the width and height of a text, mm."""
    width = sum(WIDE if unicodedata.east_asian_width(c) in "WF" else NARROW for c in text)
    return 0.5 * tall * complex(width, 1.0)


def _spaced(name: str) -> str:
    return name.replace("_", " ")


def _extent(still: Still, body: SceneBody) -> float:
    return sum(float(np.ptp(points.real) + np.ptp(points.imag)) for points in still.points_of(body))


def _slide_of(still: Still, body: SceneBody) -> complex | None:
    """Position of the slider block of a body without parts, if it has one."""
    k = still.frame
    near = [
        m.place[k] for m in still.marks if m.sort == "slide" and abs(m.place[k] - body.origin[k]) < 0.3 * still.size
    ]
    return complex(min(near, key=lambda place: abs(place - body.origin[k]))) if near else None


def _on(still: Still, body: SceneBody, half: complex) -> tuple[Complex, Real]:
    """Positions on a body, mm, and the cost of each for a name of this size."""
    k = still.frame
    points = np.concatenate(still.points_of(body))
    middle = points.mean()
    offsets = points - middle
    axis_squared = (offsets**2).sum()
    # A round part has no direction, and rounding must not give it one.
    axis = np.exp(0.5j * np.angle(axis_squared)) if abs(axis_squared) > EVEN * (np.abs(offsets) ** 2).sum() else 1.0
    along, across = (offsets / axis).real, (offsets / axis).imag
    grid = np.linspace(along.min(), along.max(), ALONG)[:, None] + 1j * np.linspace(across.min(), across.max(), ACROSS)
    places = body.origin[k] + body.direction[k] * (middle + axis * np.append(0, grid))
    # The middle of the letters and both their ends.
    letters = (places[:, None] + half.real * (ASIDE + 0.9 * np.array([0, -1, 1]))).ravel()
    inside = _lies_on(still, body, letters)
    covered = np.zeros(len(letters), dtype=bool)
    for other in still.bodies:
        if other is not body and other.layer >= body.layer and np.isfinite(other.origin[k]):
            covered |= _lies_on(still, other, letters)
    away = np.abs(places - places[0]) / (np.abs(offsets).max() or 1.0)
    is_on_plate = inside[::3]
    off_plate_count, covered_count = (flags.reshape(-1, 3).sum(axis=1) for flags in (~inside, covered))
    cost = AWAY * away + BESIDE * off_plate_count + COVERED * covered_count
    return (places[is_on_plate], cost[is_on_plate]) if is_on_plate.any() else (places[:1], cost[:1])


def _lies_on(still: Still, body: SceneBody, places: Complex) -> Mask:
    """Whether points are on a plate of the body and not in a hole."""
    local = (places - body.origin[still.frame]) * np.conj(body.direction[still.frame])
    is_on_plate = np.zeros(len(places), dtype=bool)
    for part, outline in zip(body.parts, still.points_of(body)):
        on = within(outline, local)
        for hole in part.holes if on.any() else ():
            on[on] = ~within(some_points(hole), local[on])
        is_on_plate |= on
    return is_on_plate


def within(polygon: Complex, places: Complex) -> Mask:
    """Whether points are inside a polygon: a ray from each crosses its edges an odd number of times."""
    a, b = polygon, np.roll(polygon, -1)
    y = places[:, None].imag
    spans = (a.imag <= y) != (b.imag <= y)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a.real + (y - a.imag) * (b.real - a.real) / (b.imag - a.imag)
    crossed: Mask = (spans & (places[:, None].real < x)).sum(axis=1) % 2 == 1
    return crossed
