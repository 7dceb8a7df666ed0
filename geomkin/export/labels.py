"""Positions of names in a picture, on their bodies and next to their points, chosen so that they hide little."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator

import numpy as np

from ..core.records import record
from ..model.scene import SceneBody
from ..plane.vec import Complex, Mask, Real
from .still import Still, some_points

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
