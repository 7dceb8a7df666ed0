"""`move`, and the order in which bodies are placed: the driver, dyads in closed form, then the remaining loops."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from itertools import combinations, permutations
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..plane.vec import Complex, Real
from .joints.slide import AbstractSlide, Slider
from .linkage import AbstractLinkage, Linkage
from .motion import Motion
from .solve.actuators import ActuatorBar, actuated_dyad
from .solve.branch import Branch, BranchSpec, Continuation, as_branch_spec
from .solve.dyads import RPR, RRP, RRR, Crossed, Dyad
from .solve.input_dyads import driver_dyad
from .solve.loops import Loops
from .solve.placement import (
    AlignedBody,
    Anchor,
    GearedBody,
    PinnedBody,
    Placement,
    PrismaticInput,
    RevoluteInput,
    SlideAxis,
    StrokeInput,
    Timing,
)
from .solve.program import run_of
from .solve.solution import LinkageSolution

# Consecutive arms, each with the body that it turns with.
Arms = tuple[tuple[str, complex | Complex], ...]


def plan(linkage: Linkage, follow: bool = False) -> tuple[Placement, ...]:
    """Placements of all bodies, each of which needs only those before it; `follow`: through change points.

    Raises DesignError if the linkage is over- or under-constrained. Assur's decomposition into groups that are solved
    one after the other; the algorithm is derived here.
    """
    if follow not in linkage.plans:
        linkage.plans[follow] = _find_plan(linkage, follow)
    return linkage.plans[follow]


def _find_plan(linkage: Linkage, follow: bool) -> tuple[Placement, ...]:
    _check_mobility(linkage)
    planner = Planner(linkage, follow)
    planner.drive()
    # Every round finds at least the direction or the position of one body.
    for _ in range(2 * len(linkage.bodies)):
        if not (planner.place_determined() or planner.place_dyad()):
            break
    planner.place_rest()
    return tuple(planner.placements)


def _check_mobility(linkage: Linkage) -> None:
    """Gruebler's count: three freedoms per moving body, less those that joints remove, must leave the driver one."""
    freedom = 3 * (len(linkage.bodies) - 1) - sum(joint.removes for joint in linkage.joints)
    joined = {body for joint in linkage.joints for body in joint.bodies}
    unjoined = [body for body in linkage.bodies if body not in joined]
    if unjoined:
        raise DesignError(
            "bodies", f"{unjoined[0]} is not joined to any other body", "give it a point that another body has too"
        )
    if freedom != 1:
        nouns = Counter({"pin": 0, "slider": 0})
        for joint in linkage.joints:
            nouns[joint.noun] += joint.count
        joints = " and ".join(f"{number} {noun}s" for noun, number in nouns.items())
        count = f"{len(linkage.bodies) - 1} moving bodies with {joints}"
        raise DesignError(
            "bodies",
            f"{count} have {freedom} degrees of freedom and one driver, so the linkage is "
            f"{'over' if freedom < 1 else 'under'}-constrained",
            "remove a bar or a pin"
            if freedom < 1
            else "pin another bar to two bodies that move relative to each other",
        )


class Planner:
    """Collects the placements of a linkage, with the bodies whose direction or position is already known."""

    def __init__(self, linkage: Linkage, follow: bool):
        self.linkage = linkage
        self.follow = follow
        self.placements: list[Placement] = []
        self.oriented = {linkage.ground}
        self.placed = {linkage.ground}
        slider = linkage.driven_slider
        # The slider of an actuator between two moving bodies, one of which may be pinned to the ground.
        self.actuator = slider if slider and linkage.ground not in (slider.body, slider.along) else None

    def drive(self) -> None:
        """The driver's own placement, by its joint with the ground; an actuator is placed once its ends are known."""
        ground, slider = self.linkage.ground, self.linkage.driven_slider
        if slider is None:
            self.placements.append(RevoluteInput(self.linkage.driver))
            self.oriented.add(self.linkage.driver)
        elif self.actuator:
            self.placements.append(StrokeInput(slider.name))
        else:
            body = slider.along if slider.body == ground else slider.body
            self.placements.append(AlignedBody(body, ground, _rotation(slider, body)))
            self.oriented.add(body)
            # The displacement of a body is along the line's direction, that of a slider is that of its sliding body.
            self.slide(slider, body, -1 if slider.along == body == self.linkage.driver else 1)
        for body, turn in _geared_bodies(self.linkage).items():
            self.placements.append(GearedBody(body, *turn))
            self.oriented.add(body)

    def slide(self, slider: Slider, body: str, sense: int = 1) -> None:
        """Place a body of known direction by the driven slider, relative to the slider's other body."""
        other = _other_body(slider, body)
        local, through, direction = _stroke_line(slider, other)
        self.placements.append(PrismaticInput(body, local, Anchor(other, through), SlideAxis(other, sense * direction)))
        self.placed.add(body)

    def place_determined(self) -> bool:
        """Place all bodies that have only one possible pose; return whether there were any."""
        before = len(self.placements)
        for slider in self.linkage.sliders:
            for body, other in ((slider.body, slider.along), (slider.along, slider.body)):
                if other in self.oriented and body not in self.oriented:
                    self.placements.append(AlignedBody(body, other, _rotation(slider, body)))
                    self.oriented.add(body)
        for body in self.linkage.bodies:
            if body not in self.oriented - self.placed:
                continue
            pinned = self.pins_to_placed(body)
            rails = self.rails_to_placed(body)
            if self.actuator in rails:
                self.slide(self.actuator, body)
            elif pinned:
                self.placements.append(PinnedBody(body, self.local(body, pinned[0]), self.anchor(pinned[0])))
            elif len(rails) > 1:
                (start_1, rail_1), (start_2, rail_2) = (
                    (self.start(s, body, ()), self.rail(s, body)) for s in rails[:2]
                )
                self.placements.append(
                    Crossed((rails[0].name, rails[1].name), body, (start_1, start_2), (rail_1, rail_2))
                )
            else:
                continue
            self.placed.add(body)
        return len(self.placements) > before

    def place_dyad(self) -> bool:
        """Place the first body in a slot, or pair of bodies that are joined to placed ones and to each other."""
        unplaced = [body for body in self.linkage.bodies if body not in self.placed]
        return any(self.place_in_slot(body) for body in unplaced) or any(
            self.place_pair(one, two) for one, two in combinations(unplaced, 2)
        )

    def place_pair(self, one: str, two: str) -> bool:
        for slider in self.linkage.sliders:
            if {slider.body, slider.along} == {one, two} and not {one, two} & self.oriented:
                if slider is self.actuator:
                    return False
                return self.slide_on_each_other(one, two, slider)
        for name, inner, shift in self.inner_pins(one, two):
            free = [body for body in (one, two) if body not in self.oriented]
            if len(free) == 2:
                if self.two_bars(one, two, name, inner, shift):
                    return True
            elif len(free) == 1:
                slid = one if free == [two] else two
                if self.rails_to_placed(slid) and self.bar_and_slide(free[0], slid, name, inner, shift, free == [two]):
                    return True
            elif self.rails_to_placed(one) and self.rails_to_placed(two):
                return self.two_slides(one, two, inner, shift)
        return False

    def two_bars(self, one: str, two: str, name: str, inner: tuple[str, str], shift: Arms) -> bool:
        outer = self.outer_pin(one), self.outer_pin(two)
        if not (outer[0] and outer[1]):
            return False
        # The bodies at the outer pins: with an actuator it is not the one at the inner pin.
        ends, pins = (outer[0][0], outer[1][0]), (outer[0][1], outer[1][1])
        arms = [
            self.arm(end, pin, inner_pin) if end == body else 1.0
            for body, end, pin, inner_pin in zip((one, two), ends, pins, inner)
        ]
        second = self.anchor(pins[1])
        bases = self.anchor(pins[0]), Anchor(second.body, second.place, tuple((b, -z) for b, z in shift))
        lines = (pins[0], inner[0]), (pins[1], inner[1])
        dyad = RRR(name, lines, ends, (arms[0], arms[1]), bases)
        if ends == (one, two):
            self.append(dyad)
        else:
            which = 0 if ends[0] != one else 1
            arm = self.stroked(ends[which], pins[which], (one, two)[which], inner[which])
            if not self.append_actuated(dyad, which, arm):
                return False
        for body, pin in zip(ends, pins):
            self.placements.append(PinnedBody(body, self.local(body, pin), self.anchor(pin)))
        self.placed |= set(ends)
        self.oriented |= set(ends)
        return True

    def bar_and_slide(
        self, bar: str, slid: str, name: str, inner: tuple[str, str], shift: Arms, bar_is_second: bool
    ) -> bool:
        outer = self.outer_pin(bar)
        if not outer:
            return False
        end, pin = outer
        # `inner` and `shift` lead from the first body of the pair to the second.
        if bar_is_second:
            inner, shift = inner[::-1], tuple((b, -z) for b, z in shift)
        near_pin, far_pin = inner
        slider = self.rails_to_placed(slid)[0]
        start = self.start(slider, slid, ((slid, self.local(slid, far_pin)), *((b, -z) for b, z in shift)))
        arm = self.arm(bar, pin, near_pin) if end == bar else 1.0
        lines = (pin, near_pin), slider.name
        dyad = RRP(name, lines, end, arm, self.anchor(pin), start, self.rail(slider, slid))
        if end == bar:
            self.append(dyad)
        elif not self.append_actuated(dyad, 0, self.stroked(end, pin, bar, near_pin)):
            return False
        self.placements.append(PinnedBody(end, self.local(end, pin), self.anchor(pin)))
        self.placed.add(end)
        self.oriented.add(end)
        return True

    def slide_on_each_other(self, one: str, two: str, slider: Slider) -> bool:
        outer = self.pins_to_placed(one), self.pins_to_placed(two)
        if not all(outer):
            return False
        # Relative to the line: each body's direction, and the distance of its outer pin to the left.
        rotations, left = [], []
        for body, pins in zip((one, two), outer):
            _, on_line, along = _line_on(slider, body)
            rotations.append(np.conj(along))
            left.append((np.conj(along) * (self.local(body, pins[0]) - on_line)).imag)
        bases = self.anchor(outer[0][0]), self.anchor(outer[1][0])
        before = tuple(placement for placement in self.placements if isinstance(placement, Dyad))
        directions, offset = (rotations[0], rotations[1]), left[1] - left[0]
        lines = (outer[0][0], outer[1][0]), slider.name
        self.placements.append(
            RPR(slider.name, lines, (one, two), directions, offset, bases, self.linkage.size, before)
        )
        for body, pins in zip((one, two), outer):
            self.placements.append(PinnedBody(body, self.local(body, pins[0]), self.anchor(pins[0])))
        self.placed |= {one, two}
        self.oriented |= {one, two}
        return True

    def place_in_slot(self, body: str) -> bool:
        """Place a body pinned to a placed one, if its pin runs in a slot of another placed one or the reverse."""
        slots = [slide for slide in self.rails_to_placed(body) if not slide.is_aligned]
        pivots = self.pins_to_placed(body)
        if body in self.oriented or not (slots and pivots):
            return False
        slot, pivot = slots[0], pivots[0]
        (pin,) = slot.points
        lines, base = ((pivot, pin), slot.name), self.anchor(pivot)
        if body == slot.body:
            arm, start = self.arm(body, pivot, pin), Anchor(slot.along, slot.through)
            self.append(RRP(slot.name, lines, body, arm, base, start, self.rail(slot, body)))
        else:
            rotation = np.conj(slot.direction)
            offset = (rotation * (slot.through - self.local(body, pivot))).imag
            bases, before = (
                (base, Anchor(slot.body, slot.point)),
                tuple(p for p in self.placements if isinstance(p, Dyad)),
            )
            turned = (body, body), (rotation, rotation), offset, bases
            self.placements.append(RPR(slot.name, lines, *turned, self.linkage.size, before))
        self.placements.append(PinnedBody(body, self.local(body, pivot), base))
        self.placed.add(body)
        self.oriented.add(body)
        return True

    def two_slides(self, one: str, two: str, inner: tuple[str, str], shift: Arms) -> bool:
        rails = self.rails_to_placed(one)[0], self.rails_to_placed(two)[0]
        # From the origin of `one` over the inner pin to the point of `two` that runs on its rail.
        arms = ((one, -self.local(one, inner[0])), *((b, -z) for b, z in shift), (two, self.local(two, inner[1])))
        starts = self.start(rails[0], one, ()), self.start(rails[1], two, arms)
        lines, axes = (rails[0].name, rails[1].name), (self.rail(rails[0], one), self.rail(rails[1], two))
        self.placements.append(Crossed(lines, one, starts, axes))
        self.placed.add(one)
        return True

    def place_rest(self) -> None:
        """Place the bodies that are in no dyad: all their loops at once, by iteration."""
        unplaced = [body for body in self.linkage.bodies if body not in self.placed]
        if unplaced:
            known = frozenset(self.oriented), frozenset(self.placed)
            turns = any(isinstance(placement, RevoluteInput) for placement in self.placements)
            self.placements.append(Loops(self.linkage, tuple(unplaced), *known, turns, self.follow))

    def append(self, dyad: RRR | RRP) -> None:
        """Append the dyad; if only the driver moves it, in the form that stays accurate at a toggle."""
        self.placements.append(driver_dyad(dyad, self.linkage.ground, self.placements, self.follow) or dyad)

    def append_actuated(self, dyad: RRR | RRP, which: int, arm: ActuatorBar) -> bool:
        """Append the dyad with an actuator as its bar `which`, if its bases are fixed; return whether it was."""
        actuated = actuated_dyad(dyad, which, arm, self.linkage.ground, self.placements, self.follow)
        if actuated is not None:
            self.placements.append(actuated)
        return actuated is not None

    def has(self, body: str, pin: str) -> bool:
        return pin in self.linkage.bodies[body]

    def local(self, body: str, pin: str) -> complex | Complex:
        return self.linkage.bodies[body][pin]

    def arm(self, body: str, outer: str, inner: str) -> complex | Complex:
        arm = self.local(body, inner) - self.local(body, outer)
        if np.any(arm == 0):
            raise DesignError(
                "bodies", f"{outer} and {inner} are at one place of {body}", "move them apart, or pin its neighbours"
            )
        return arm

    def pins_to_placed(self, body: str) -> list[str]:
        return [pin for pin, bodies in self.linkage.pins.items() if body in bodies and self.placed & set(bodies)]

    def outer_pin(self, body: str) -> tuple[str, str] | None:
        """A body and its pin on a placed body: the body itself, or the other half of its actuator."""
        halves = (self.actuator.body, self.actuator.along) if self.actuator else ()
        bodies = (body, *(half for half in halves if half != body)) if body in halves else (body,)
        return next(((b, pins[0]) for b in bodies if (pins := self.pins_to_placed(b))), None)

    def stroked(self, end: str, outer: str, body: str, inner: str) -> ActuatorBar:
        """The actuator from a pin of one half to a pin of the other, in the frame of the first."""
        assert self.actuator is not None
        start = self.actuator.in_other_frame(body, self.local(body, inner), 0.0) - self.local(end, outer)
        return ActuatorBar(start, _stroke_line(self.actuator, end)[2])

    def rails_to_placed(self, body: str) -> list[AbstractSlide]:
        return [
            slide for slide in self.linkage.slides if body in slide.bodies and _other_body(slide, body) in self.placed
        ]

    def inner_pins(self, one: str, two: str) -> list[tuple[str, tuple[str, str], Arms]]:
        """Connections from `one` to `two` over pins that are not placed yet: name, the two pins, arms between them.

        A body between them whose direction is known only shifts one pin relative to the other.
        """
        free = {pin: set(b) for pin, b in self.linkage.pins.items() if not self.placed & set(b)}
        connections: list[tuple[str, tuple[str, str], Arms]] = [
            (pin, (pin, pin), ()) for pin, bodies in free.items() if {one, two} <= bodies
        ]
        for body in self.linkage.bodies:
            if body in self.oriented - self.placed - {one, two}:
                for a, b in permutations(free, 2):
                    if {one, body} <= free[a] and {two, body} <= free[b]:
                        connections.append((body, (a, b), ((body, self.local(body, b) - self.local(body, a)),)))
        return connections

    def anchor(self, pin: str) -> Anchor:
        body = next(b for b in self.linkage.bodies if b in self.placed and self.has(b, pin))
        return Anchor(body, self.local(body, pin))

    def rail(self, slide: AbstractSlide, body: str) -> SlideAxis:
        # The line of a slot turns with the body of the slot alone.
        if not isinstance(slide, Slider):
            return SlideAxis(slide.along, slide.direction)
        other = _other_body(slide, body)
        return SlideAxis(other, _line_on(slide, other)[2])

    def start(self, slider: AbstractSlide, body: str, arms: Arms) -> Anchor:
        """Position of the body's origin, plus `arms`, when the body's point is at the rail's own point."""
        other = _other_body(slider, body)
        local, through = _points_on(slider, other)
        return Anchor(other, through, ((body, -local), *arms))


def _geared_bodies(linkage: Linkage) -> dict[str, tuple[float, float]]:
    """The bodies that gears turn with the driver: their ratio to it, and their angle, rad, where the drive is 0."""
    found = {} if linkage.driven_slider else {linkage.driver: (1.0, 0.0)}
    waiting = list(linkage.meshes)
    while waiting:
        mesh = next((mesh for mesh in waiting if {*mesh.bodies} & found.keys()), None)
        if mesh is None:
            names = " and ".join(waiting[0].bodies)
            problem = f"{waiting[0].name} joins {names}, of which none is geared to the driver"
            raise DesignError("meshes", problem, f"let {waiting[0].bodies[0]} drive, by its angle", "conflict")
        waiting.remove(mesh)
        first, second = mesh.bodies
        body, other = (second, first) if first in found else (first, second)
        (ratio, start), by = found[other], mesh.ratio_of(body)
        found[body] = by * ratio, by * start + (mesh.angle if body == second else -by * mesh.angle)
    return {body: turn for body, turn in found.items() if body != linkage.driver}


def _other_body(slider: AbstractSlide, body: str) -> str:
    return slider.along if body == slider.body else slider.body


def _rotation(slider: Slider, body: str) -> Complex:
    """Direction of the body's x axis in the frame of the other body of the slider."""
    return slider.rotation if body == slider.body else np.conj(slider.rotation)


def _points_on(slide: AbstractSlide, other: str) -> tuple[complex | Complex, complex | Complex]:
    """The point that runs on the line of a slide, and a point of the line, which is on `other`."""
    return (slide.point, slide.through) if other == slide.along else (slide.through, slide.point)


def _line_on(slider: Slider, other: str) -> tuple[complex | Complex, complex | Complex, Complex]:
    """A slider as a line on `other`: the point that runs on it, a point of the line, the line's direction.

    In the frame of the sliding body, it is the guide's own point that runs along a line through `point`, backwards. The
    line's direction is kept, so that the sign of the displacement stays the same.
    """
    on_guide = other == slider.along
    return *_points_on(slider, other), slider.direction if on_guide else np.conj(slider.rotation) * slider.direction


def _stroke_line(slider: Slider, other: str) -> tuple[complex | Complex, complex | Complex, Complex]:
    """The same, with the direction in which the point moves as the slider's displacement grows."""
    local, through, direction = _line_on(slider, other)
    return local, through, direction if other == slider.along else -direction


@checked
def move(
    linkage: AbstractLinkage,
    drive: float | ArrayLike,
    branch: int | Literal["follow"] | Mapping[str, int | complex] | Continuation | BranchSpec = 1,
    speed: float | ArrayLike = 1.0,
    acceleration: float | ArrayLike = 0.0,
) -> Motion:
    """Move a linkage through the given driver positions.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        Its lengths may be arrays of shape (linkages,); results then have the shape (frames, linkages).
    drive : float or array_like, shape (frames,)
        Angle of the driver from the ground's x axis, rad, or its displacement, mm, if a slider drives.
    branch : {+1, -1, "follow"}, mapping or Continuation
        Assembly mode. +1 puts the inner joint of each dyad to the left of the line from the first body's outer pin to
        the second's. A mapping gives the sign of each dyad by the name of its inner joint (+1 if missing). A mapping
        of a point's name to a position, complex, mm, takes the branch nearest to it at the first frame at which its
        dyad can be assembled; it also replaces the linkage's `estimate`. "follow" starts at +1, and
        `Continuation` at any of these; both continue smoothly through change points, at any step.
    speed, acceleration : float or array_like, shape (frames,)
        Of the driver: rad/s and rad/s2, or mm/s and mm/s2 if a slider drives.

    Returns
    -------
    Motion
        Frames that cannot be reached are nan; `Motion.assembled` masks them. At a dead centre of the driver the rates
        are not finite.

    Raises
    ------
    DesignError
        If an argument is not allowed, a branch names no joint or point, or the linkage is over- or under-constrained.

    See Also
    --------
    forces, driver_limits, least_transmission_angle, CouplerCurve, Continuation

    Notes
    -----
    Dyads are solved in closed form, everything else by Newton's method on the loop equations. Rates follow by the chain
    rule from kinematic coefficients (Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters 3, 4).

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), [0.0, 1.0], branch=-1)
    >>> motion.point("rocker_pin").position.round(3)
    array([87.857-68.939j, 56.802-55.081j])
    >>> motion.assembled
    array([ True,  True])
    """
    general = linkage.linkage
    q = np.asarray(drive, dtype=float)
    q = q if q.ndim else q[None]
    if q.ndim != 1:
        raise DesignError(
            "drive", f"found an array of shape {q.shape}", "give a 1-D array of finite numbers, rad or mm", "wrong-type"
        )
    timing = Timing(_time("speed", speed, q, general), _time("acceleration", acceleration, q, general))
    spec = as_branch_spec(branch)
    run = run_of(general, q, timing, spec, plan)
    if run is None:
        _plan_for(general, spec)
    elif spec.branch:
        spec.check(general, run.program.joints)
    solution = LinkageSolution(general, partial(_plan_for, general, spec), q, spec, timing, run)
    return Motion(general, q, timing, solution, linkage)


def _time(name: str, rate: float | ArrayLike, drive: Real, linkage: Linkage) -> Real:
    """Speed or acceleration as a number, or over all frames and linkages."""
    values = np.asarray(rate, dtype=float)
    if not values.ndim:
        return values
    if values.shape != drive.shape:
        raise DesignError(name, f"found shape {values.shape}", f"give a number or {drive.shape} of them", "conflict")
    return values.reshape(-1, *(1,) * len(linkage.shape))


def placements_for(linkage: Linkage, branch: Branch) -> tuple[Placement, ...]:
    """The placements of all bodies on a branch; DesignError if the branch names no joint or point of the linkage."""
    return _plan_for(linkage, as_branch_spec(branch))


def _plan_for(linkage: Linkage, spec: BranchSpec) -> tuple[Placement, ...]:
    estimate = {**linkage.estimate, **spec.branch_points}
    placements = plan(replace(linkage, estimate=estimate) if spec.branch_points else linkage, spec.follow)
    if spec.branch_points and not any(isinstance(placement, Loops) for placement in placements):
        # Only loops start from an estimate. Otherwise the linkage's own plan serves, which is kept.
        placements = plan(linkage, spec.follow)
    if spec.branch or spec.branch_points:
        spec.check(linkage, [placement.joint for placement in placements if isinstance(placement, Dyad)])
    return placements
