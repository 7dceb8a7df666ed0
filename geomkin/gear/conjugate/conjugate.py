"""The mate of any tooth by the law of gearing."""

from __future__ import annotations

from dataclasses import field, replace
from itertools import pairwise
from typing import Annotated

import numpy as np

from ...core.arguments import RealsOrNan, checked, whole_between
from ...core.errors import DesignError
from ...core.fields import Length, Size
from ...core.records import record
from ...model.table import Column, Table, xy_columns
from ...plane.curve import AbstractCurve, Reversed
from ...plane.joined import Path, PolarArray
from ...plane.primitives import Arc
from ...plane.vec import Pose, Real
from ..contract import AbstractGear
from .conjugate_curve import ConjugateCurve, ToothContact, ToothRun
from .envelope import GRID, BoundaryPiece, Swept, sweep

Teeth = Annotated[int, whole_between(2, 10_000)]
# A contact that there is not: angle, place, tooth, mate, sliding, pressure angle.
UNTOUCHED = (np.nan, *3 * (complex(np.nan, np.nan),), np.nan, np.nan)
# Why a stretch of a tooth never touches.
MISSES = "its normals miss the pitch circle"
CUTS = "touching it would cut the mate's own flank away"
TRIMMED = "another part of the tooth cuts away what it would touch"
BEYOND = "the mate's teeth end before it"


@record
class Untouched:
    """A stretch of a tooth that never touches its mate.

    start, end: parameters of the tooth's curve; inner_radius, outer_radius: its least and largest distance from
    the gear's axis, mm; why: what keeps it from touching.
    """

    start: float
    end: float
    inner_radius: float
    outer_radius: float
    why: str


@record(eq=False)
class Conjugate(AbstractGear):
    """A mate cut by the law of gearing (Litvin and Fuentes, Gear Geometry and Applied Theory, on conjugate profiles).

    teeth, pitch_radius, tip_radius and root_radius, mm, of the mate. outline: closed, counterclockwise, about
    the mate's centre, a tooth centred on +y; of a ring the hole of its plate. pose: where it stands while a
    tooth of the gear about the origin stands on +y. tooth: the gear's, the material to its left (of a ring it
    is reversed). steps: the conjugate curves that the outline is made of, along the tooth. untouched: the
    stretches of the tooth that touch nothing.
    """

    tooth: AbstractCurve
    gear_teeth: int
    teeth: int
    pitch_radius: float
    tip_radius: float
    root_radius: float
    is_ring: bool = field()
    outline: AbstractCurve
    pose: Pose
    steps: tuple[BoundaryPiece, ...]
    untouched: tuple[Untouched, ...]

    @property
    def module(self) -> float:
        """Pitch diameter per tooth, mm."""
        return 2 * self.pitch_radius / self.teeth

    @property
    def distance(self) -> float:
        """Distance of the two axes, mm."""
        return abs(complex(self.pose.origin))

    @property
    def tip_thickness(self) -> float:
        """Thickness of the mate's teeth along their tip circle, mm."""
        a, b = _ends(self.steps)
        space = float(np.angle(b / a) if self.is_ring else np.angle(a / b))
        return self.tip_radius * (2 * np.pi / self.teeth - space % (2 * np.pi))

    @checked
    def contact(self, t: RealsOrNan) -> ToothContact:
        """Where and when the tooth's points at parameters t (...,) touch; nan where never. Corners are left out."""
        t = np.asarray(t, dtype=float)
        found = ToothContact(*(np.full(t.shape, nothing) for nothing in UNTOUCHED))
        for curve, low, high in touched(self.steps):
            mask = (t >= low) & (t <= high) & np.isnan(found.angle)
            part = curve.contact(curve.parameter_of(t[mask]))
            for name in ToothContact.__dataclass_fields__:
                getattr(found, name)[mask] = getattr(part, name)
        return found

    @checked
    def contact_ratio(self, start: float, end: float) -> float:
        """Turn of the gear during which the tooth touches between two of its parameters, in pitches."""
        angles = [
            curve.contact(curve.parameter_of(np.clip([low, high], start, end))).angle
            for curve, low, high in touched(self.steps)
            if low < end and high > start
        ]
        return float(np.ptp(angles)) * self.gear_teeth / (2 * np.pi) if angles else 0.0


@checked
def conjugate(
    tooth: AbstractCurve,
    teeth: Teeth,
    pitch_radius: Size,
    mate_teeth: Teeth,
    addendum: Size,
    internal: bool = False,
) -> Conjugate:
    """The mate of a gear with a tooth of any form: the law of gearing for its flanks, its tips and their corners.

    tooth: one tooth of the gear, about the gear's axis, a tooth centred on +y, either one pitch of a
    counterclockwise outline (`outline.piece` of any gear here) or a closed curve such as a pin. teeth, mate_teeth:
    of the gear and its mate. addendum: how far the mate's teeth reach beyond its pitch circle, mm. internal: the
    mate is a ring round the gear if it has more teeth; with fewer it is the pinion of a gear that is a ring.

    The gear is taken as the tool: the mate's roots are what its tips leave, and what is swept is trimmed where
    its curves cross. Points of the tooth that then touch nothing are told in `.untouched`.
    """
    if internal and teeth == mate_teeth:
        raise DesignError("mate_teeth", f"found {mate_teeth}, as many as the gear has", f"give at least {teeth + 1}")
    ring_gear, ring_mate = internal and mate_teeth < teeth, internal and mate_teeth > teeth
    radius = pitch_radius * mate_teeth / teeth
    signed = -radius if internal else radius
    closed = tooth.closed
    material_left = Reversed(tooth) if ring_gear else tooth
    step = 1 + 0j if closed else np.exp((-2j if ring_gear else 2j) * np.pi / teeth)
    turn = (1 if internal else -1) * np.exp(1j * np.pi / mate_teeth)
    if not closed:
        _check_depth(tooth, pitch_radius, addendum, ring_gear)
    swept = sweep(material_left, step, pitch_radius, signed, turn)
    tip = radius - addendum if ring_mate else radius + addendum
    steps = swept.boundary(tip, not ring_mate)
    piece, root = _piece(steps, mate_teeth, ring_mate, radius)
    return Conjugate(
        tooth=material_left,
        gear_teeth=teeth,
        teeth=mate_teeth,
        pitch_radius=radius,
        tip_radius=tip,
        root_radius=root,
        is_ring=ring_mate,
        outline=PolarArray(piece, mate_teeth),
        pose=Pose(1j * (pitch_radius + signed), complex(1 / turn)),
        steps=tuple(steps),
        untouched=untouched(material_left, swept, steps, tip, not ring_mate),
    )


def _check_depth(tooth: AbstractCurve, pitch_radius: float, addendum: float, ring_gear: bool) -> None:
    """The mate's tips must not reach the gear's bottom lands."""
    b = tooth.breaks
    radii = np.abs(tooth.point(np.concatenate([b0 + (b1 - b0) * GRID for b0, b1 in pairwise(b)])))
    deep = radii.max() - pitch_radius if ring_gear else pitch_radius - radii.min()
    if addendum > deep * (1 + 1e-12):
        raise DesignError(
            "addendum",
            f"found {addendum:.5g} mm, but the spaces of the gear are only {deep:.5g} mm deep below its pitch circle",
            # A little less, so that the number still works when rounded.
            f"give at most {deep * (1 - 1e-5):.6g}",
        )


def _ends(steps: tuple[BoundaryPiece, ...] | list[BoundaryPiece]) -> tuple[complex, complex]:
    return complex(steps[0].curve.point(steps[0].start)), complex(steps[-1].curve.point(steps[-1].end))


def _piece(steps: list[BoundaryPiece], teeth: int, ring: bool, pitch_radius: float) -> tuple[Path, float]:
    """One pitch of the mate's outline, counterclockwise: a space and a tip land; and the root's radius."""
    pieces: list[AbstractCurve] = []
    for step in steps:
        curve = replace(step.curve, start=min(step.start, step.end), end=max(step.start, step.end))
        pieces.append(curve if step.end > step.start else Reversed(curve))
    if not ring:
        pieces = [Reversed(p) for p in reversed(pieces)]
    first = complex(pieces[0].point(pieces[0].breaks[0]))
    last = complex(pieces[-1].point(pieces[-1].breaks[-1]))
    space = float(np.angle(last / first)) % (2 * np.pi)
    land = 2 * np.pi / teeth - space
    if land <= 0:
        # Known from samples: a thousandth less leaves a land.
        most = 0.999 * abs(_pointed(pieces, teeth, ring) - pitch_radius)
        raise DesignError(
            "addendum",
            f"found {abs(abs(last) - pitch_radius):.5g} mm, where the mate's flanks have met: its teeth are pointed",
            f"give at most {most:.6g}, or a gear with thinner teeth",
        )
    samples = np.concatenate([np.abs(p.point(p.breaks[0] + (p.breaks[-1] - p.breaks[0]) * GRID)) for p in pieces])
    root = float(samples.max() if ring else samples.min())
    return Path((*pieces, Arc(0j, last, land))), root


def _pointed(pieces: list[AbstractCurve], teeth: int, ring: bool) -> float:
    """Radius where the two flanks of a tooth meet, from samples of the two sides of a space."""
    z = np.concatenate([p.point(p.breaks[0] + (p.breaks[-1] - p.breaks[0]) * GRID) for p in pieces])
    out = -np.abs(z) if ring else np.abs(z)
    deepest = int(out.argmin())
    falling, rising = z[: deepest + 1][::-1], z[deepest:]
    levels = np.linspace(out[deepest], min(out[0], out[-1]), 2001)
    about = z[deepest] / abs(z[deepest])
    # Where an undercut side turns back inwards it is no wider than before.
    left, right = (
        np.interp(levels, np.maximum.accumulate(-np.abs(side) if ring else np.abs(side)), np.angle(side / about))
        for side in (falling, rising)
    )
    land = 2 * np.pi / teeth - (right - left)
    return float(abs(levels[int(np.argmax(land <= 0))]))


def touched(steps: tuple[BoundaryPiece, ...] | list[BoundaryPiece]) -> list[tuple[ConjugateCurve, float, float]]:
    """Curves of the boundary that stretches of the tooth left, and the tooth's parameters between which they did."""
    found = []
    for step in steps:
        if isinstance(step.curve.side, ToothRun):
            low, high = np.sort(step.curve.tooth_parameter([step.start, step.end])).tolist()
            found.append((step.curve, low, high))
    return found


def untouched(
    tooth: AbstractCurve, swept: Swept, steps: list[BoundaryPiece], tip: float, rising: bool
) -> tuple[Untouched, ...]:
    """In order along the tooth; lands about the axis, which meet nothing but bottom lands, are left out.

    tip: radius of the mate's tips, which lie outside its flanks where `rising`.
    """
    kept = touched(steps)
    curves = [c for c in swept.curves if isinstance(c.side, ToothRun)]
    ends = [c.tooth_parameter([c.start, c.end]) for c in curves]
    reached = [[c.first, c.last] for c in curves]
    edges = np.unique(np.concatenate([tooth.breaks, *reached, *ends, *([low, high] for _, low, high in kept)]))
    # Ends that differ by rounding bound nothing.
    edges = edges[np.append(True, np.diff(edges) > 1e-9 * (edges[-1] - edges[0]))]
    found: list[Untouched] = []
    for low, high in zip(edges.tolist(), edges[1:].tolist()):
        t = 0.5 * (low + high)
        if any(first <= t <= last for _, first, last in kept):
            continue
        radius = np.abs(tooth.point(np.linspace(low, high, 17)))
        if np.ptp(radius) <= 1e-9 * radius.max():
            continue
        why = _why(t, curves, ends, tip, rising)
        if found and found[-1].end == low and found[-1].why == why:
            before = found.pop()
            low, radius = before.start, np.append(radius, [before.inner_radius, before.outer_radius])
        found.append(Untouched(low, high, float(radius.min()), float(radius.max()), why))
    return tuple(found)


def _why(t: float, curves: list[ConjugateCurve], ends: list[Real], tip: float, rising: bool) -> str:
    over = [c for c, (low, high) in zip(curves, ends) if low < t < high]
    if over:
        radii = [abs(complex(c.point(c.parameter_of(t)))) for c in over]
        beyond = [r > tip if rising else r < tip for r in radii]
        return BEYOND if all(beyond) else TRIMMED
    return CUTS if any(c.first < t < c.last for c in curves) else MISSES


# Places on a flank or pin: half a percent of it apart.
PLACES = 201


@checked
def flank_table(mate: Conjugate, backlash: Length = 0.0) -> Table:
    """Contact along the gear's flank. backlash: mm along the pitch circle, as the mate was made with."""
    share = np.linspace(0, 1, PLACES)
    where = Column("flank_share", "", "place on the right-hand flank, 0 at the bottom land, 1 at the tip", share)
    return _table(where, mate, share, backlash)


@checked
def pin_table(mate: Conjugate, quarters: int, backlash: Length = 0.0) -> Table:
    """Contact along a lantern pin's right-hand side, as many quarters of it as are the pin itself, 1 or 2."""
    angle = np.linspace(-90, 90 * (quarters - 1), PLACES)
    where = Column("pin_angle", "deg", "place on the pin, -90 its innermost", angle)
    return _table(where, mate, 1 + angle / 90, backlash)


def _table(where: Column, mate: Conjugate, t: Real, backlash: float) -> Table:
    """Contact at places t of piece 0 of the mate's cutter, the turned right-hand flank of the gear.

    Both angles count from where the gear's tooth stands on +y in the very middle of the mate's space. The gear's is
    the gear's own, the same as without backlash; the mate's is half the play off the ratio, on the side on which the
    right-hand flanks touch, and so over the whole contact.
    """
    ahead = backlash * mate.teeth / (2 * mate.gear_teeth * mate.pitch_radius)
    contact = mate.contact(t)
    tooth = mate.tooth.point(t) * np.exp(1j * ahead)
    # Outside each other two gears turn against each other.
    ratio = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    turned = np.degrees(contact.angle - ahead)
    followed = np.degrees(contact.angle) * ratio
    words = "mate's turn then, 0 with the play shared by both sides of the tooth on +y"
    return Table(
        (
            where,
            *xy_columns("tooth", "mm", "that place on the gear's tooth centred on +y", tooth),
            Column("gear_angle", "deg", "gear's turn when it touches, 0 with the tooth on +y", turned),
            Column("mate_angle", "deg", words, followed),
            *xy_columns("contact", "mm", "path of contact, gear's axis at 0, pitch point on +y", contact.place),
            *xy_columns("mate_tooth", "mm", "the same place in the mate's own frame", contact.mate),
            Column("sliding", "mm/rad", "of the gear along the mate's flank, per turn of the gear", contact.sliding),
            Column("pressure_angle", "deg", "of the common normal", np.degrees(contact.pressure_angle)),
        )
    )
