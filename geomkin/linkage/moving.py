"""In which order bodies are placed: the driver, then dyads in closed form; what is left goes to iteration."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, permutations

import numpy as np

from ..core.arguments import Reals, checked
from ..core.errors import DesignError
from ..plane.vec import Complex, Real
from .linkage import AnyLinkage, Linkage, Slider
from .motion import Motion
from .solve.actuators import Stroked, actuated_dyad
from .solve.branch import Branch, BranchSpec, chosen
from .solve.dyads import RPR, RRP, RRR, Crossed, Dyad
from .solve.formulas import Timing
from .solve.input_dyads import driver_dyad
from .solve.loops import Loops
from .solve.placement import (
    AlignedBody,
    Anchor,
    PinnedBody,
    Placement,
    PrismaticInput,
    RevoluteInput,
    SlideAxis,
    StrokeInput,
)
from .solve.solution import LinkageSolution

# Arms in a row, each with the body that it turns with.
Arms = tuple[tuple[str, complex | Complex], ...]


def plan(linkage: Linkage, follow: bool = False) -> tuple[Placement, ...]:
    """Placements of every body, each on those before it; `follow`: through change points.

    Raises DesignError where the joints leave the linkage rigid or loose. Derived here; that a linkage comes apart into
    groups that are solved one after the other is Assur's.
    """
    if follow not in linkage.plans:
        linkage.plans[follow] = _find_plan(linkage, follow)
    return linkage.plans[follow]


def _find_plan(linkage: Linkage, follow: bool) -> tuple[Placement, ...]:
    _check_mobility(linkage)
    planner = Planner(linkage, follow)
    planner.drive()
    # Every round finds a direction or a place of one body at least.
    for _ in range(2 * len(linkage.bodies)):
        if not (planner.carry() or planner.dyad()):
            break
    planner.rest()
    return tuple(planner.placements)


def _check_mobility(linkage: Linkage) -> None:
    """Each moving body has three freedoms; a pin or a slider takes two; one is to be left, the driver's (Gruebler)."""
    pins = sum(len(bodies) - 1 for bodies in linkage.pins.values())
    freedom = 3 * (len(linkage.bodies) - 1) - 2 * pins - 2 * len(linkage.sliders)
    joined = {body for bodies in linkage.pins.values() for body in bodies}
    joined |= {body for slider in linkage.sliders for body in (slider.body, slider.along)}
    alone = [body for body in linkage.bodies if body not in joined]
    if alone:
        raise DesignError("bodies", f"{alone[0]} is joined to nothing", "give it a point that another body has too")
    if freedom != 1:
        count = f"{len(linkage.bodies) - 1} moving bodies with {pins} pins and {len(linkage.sliders)} sliders"
        raise DesignError(
            "bodies",
            f"{count} have {freedom} freedoms, so the linkage is {'rigid' if freedom < 1 else 'loose'} with one driver",
            "take a bar away, or a pin" if freedom < 1 else "pin another bar to two bodies that move apart",
        )


class Planner:
    """A linkage that is being solved: the placements so far, and the bodies whose direction or whose place is known."""

    def __init__(self, linkage: Linkage, follow: bool):
        self.linkage = linkage
        self.follow = follow
        self.placements: list[Placement] = []
        self.oriented = {linkage.ground}
        self.placed = {linkage.ground}
        slider = linkage.driven_slider
        # The two bodies of an actuator, which hangs between bodies that move or is pinned to the ground.
        self.actuator = slider if slider and linkage.ground not in (slider.body, slider.along) else None

    def drive(self) -> None:
        """The driver's own placement, by how it is joined to the ground; an actuator waits for what holds its ends."""
        ground, slider = self.linkage.ground, self.linkage.driven_slider
        if slider is None:
            self.placements.append(RevoluteInput(self.linkage.driver))
            self.oriented.add(self.linkage.driver)
        elif self.actuator:
            self.placements.append(StrokeInput(slider.name))
        else:
            body = slider.along if slider.body == ground else slider.body
            self.placements.append(AlignedBody(body, ground, _turn(slider, body)))
            self.oriented.add(body)
            # A body's displacement is along the line's direction, a slider's that of its sliding body.
            self.slide(slider, body, -1 if slider.along == body == self.linkage.driver else 1)

    def slide(self, slider: Slider, body: str, sense: int = 1) -> None:
        """Place a body of known direction by the driven slider, from the other body of it."""
        other = _other(slider, body)
        near, through, direction = _stroke_seen_from(slider, other)
        self.placements.append(PrismaticInput(body, near, Anchor(other, through), SlideAxis(other, sense * direction)))
        self.placed.add(body)

    def carry(self) -> bool:
        """Whatever follows without a choice; whether anything did."""
        before = len(self.placements)
        for slider in self.linkage.sliders:
            for body, other in ((slider.body, slider.along), (slider.along, slider.body)):
                if other in self.oriented and body not in self.oriented:
                    self.placements.append(AlignedBody(body, other, _turn(slider, body)))
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
                self.placements.append(Crossed(body, (start_1, start_2), (rail_1, rail_2)))
            else:
                continue
            self.placed.add(body)
        return len(self.placements) > before

    def dyad(self) -> bool:
        """The first two bodies, in the linkage's order, that stand on placed ones and on each other."""
        waiting = [body for body in self.linkage.bodies if body not in self.placed]
        return any(self.join(one, two) for one, two in combinations(waiting, 2))

    def join(self, one: str, two: str) -> bool:
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
        # The bodies at the outer pins: of an actuator not the one at the inner pin.
        ends, pins = (outer[0][0], outer[1][0]), (outer[0][1], outer[1][1])
        arms = [
            self.arm(end, pin, near) if end == body else 1.0
            for body, end, pin, near in zip((one, two), ends, pins, inner)
        ]
        second = self.anchor(pins[1])
        bases = self.anchor(pins[0]), Anchor(second.body, second.place, tuple((b, -z) for b, z in shift))
        dyad = RRR(name, ends, (arms[0], arms[1]), bases)
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
        near, far = inner
        slider = self.rails_to_placed(slid)[0]
        start = self.start(slider, slid, ((slid, self.local(slid, far)), *((b, -z) for b, z in shift)))
        arm = self.arm(bar, pin, near) if end == bar else 1.0
        dyad = RRP(name, end, arm, self.anchor(pin), start, self.rail(slider, slid))
        if end == bar:
            self.append(dyad)
        elif not self.append_actuated(dyad, 0, self.stroked(end, pin, bar, near)):
            return False
        self.placements.append(PinnedBody(end, self.local(end, pin), self.anchor(pin)))
        self.placed.add(end)
        self.oriented.add(end)
        return True

    def slide_on_each_other(self, one: str, two: str, slider: Slider) -> bool:
        outer = self.pins_to_placed(one), self.pins_to_placed(two)
        if not all(outer):
            return False
        # Seen along the line: each body's direction, and how far left of it its outer pin lies.
        turns, left = [], []
        for body, pins in zip((one, two), outer):
            _, on_line, along = _seen_from(slider, body)
            turns.append(np.conj(along))
            left.append(np.imag(np.conj(along) * (self.local(body, pins[0]) - on_line)))
        bases = self.anchor(outer[0][0]), self.anchor(outer[1][0])
        before = tuple(one for one in self.placements if isinstance(one, Dyad))
        directions, offset = (turns[0], turns[1]), left[1] - left[0]
        self.placements.append(RPR(slider.name, (one, two), directions, offset, bases, self.linkage.size, before))
        for body, pins in zip((one, two), outer):
            self.placements.append(PinnedBody(body, self.local(body, pins[0]), self.anchor(pins[0])))
        self.placed |= {one, two}
        self.oriented |= {one, two}
        return True

    def two_slides(self, one: str, two: str, inner: tuple[str, str], shift: Arms) -> bool:
        rails = self.rails_to_placed(one)[0], self.rails_to_placed(two)[0]
        # From the origin of `one` over the inner pin to the point of `two` that runs on its rail.
        way = ((one, -self.local(one, inner[0])), *((b, -z) for b, z in shift), (two, self.local(two, inner[1])))
        starts = self.start(rails[0], one, ()), self.start(rails[1], two, way)
        self.placements.append(Crossed(one, starts, (self.rail(rails[0], one), self.rail(rails[1], two))))
        self.placed.add(one)
        return True

    def rest(self) -> None:
        """Bodies that no dyad places: all their loops at once, by iteration."""
        waiting = [body for body in self.linkage.bodies if body not in self.placed]
        if waiting:
            joined = frozenset(self.oriented), frozenset(self.placed)
            turns = any(isinstance(one, RevoluteInput) for one in self.placements)
            self.placements.append(Loops(self.linkage, tuple(waiting), *joined, turns, self.follow))

    def append(self, dyad: RRR | RRP) -> None:
        """The dyad, in the form that keeps its digits at a toggle where the driver alone moves it."""
        self.placements.append(driver_dyad(dyad, self.linkage.ground, self.placements, self.follow) or dyad)

    def append_actuated(self, dyad: RRR | RRP, which: int, arm: Stroked) -> bool:
        """The dyad with an actuator for its bar `which`, where what it stands on does not move."""
        found = actuated_dyad(dyad, which, arm, self.linkage.ground, self.placements, self.follow)
        if found is not None:
            self.placements.append(found)
        return found is not None

    # What the linkage says of a body.

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
        """A body and its pin on a placed one: the body itself, or where it is half of an actuator the other half."""
        halves = (self.actuator.body, self.actuator.along) if self.actuator else ()
        bodies = (body, *(half for half in halves if half != body)) if body in halves else (body,)
        return next(((b, pins[0]) for b in bodies if (pins := self.pins_to_placed(b))), None)

    def stroked(self, end: str, outer: str, body: str, inner: str) -> Stroked:
        """The actuator from a pin of one half, in the frame of that, to a pin of the other."""
        assert self.actuator is not None
        start = self.actuator.seen(body, self.local(body, inner), 0.0) - self.local(end, outer)
        return Stroked(start, _stroke_seen_from(self.actuator, end)[2])

    def rails_to_placed(self, body: str) -> list[Slider]:
        return [s for s in self.linkage.sliders if body in (s.body, s.along) and _other(s, body) in self.placed]

    def inner_pins(self, one: str, two: str) -> list[tuple[str, tuple[str, str], Arms]]:
        """Ways from `one` to `two` over pins that are not placed yet: name, the two pins, and the arms between.

        A body between them whose direction is known shifts one pin from the other, no more.
        """
        free = {pin: set(b) for pin, b in self.linkage.pins.items() if not self.placed & set(b)}
        ways: list[tuple[str, tuple[str, str], Arms]] = [
            (pin, (pin, pin), ()) for pin, bodies in free.items() if {one, two} <= bodies
        ]
        for body in self.linkage.bodies:
            if body in self.oriented - self.placed - {one, two}:
                for a, b in permutations(free, 2):
                    if {one, body} <= free[a] and {two, body} <= free[b]:
                        ways.append((body, (a, b), ((body, self.local(body, b) - self.local(body, a)),)))
        return ways

    def anchor(self, pin: str) -> Anchor:
        body = next(b for b in self.linkage.bodies if b in self.placed and self.has(b, pin))
        return Anchor(body, self.local(body, pin))

    def rail(self, slider: Slider, body: str) -> SlideAxis:
        other = _other(slider, body)
        return SlideAxis(other, _seen_from(slider, other)[2])

    def start(self, slider: Slider, body: str, way: Arms) -> Anchor:
        """Where the body's origin, less the arms of `way`, is when its point stands at the rail's own point."""
        other = _other(slider, body)
        near, through, _ = _seen_from(slider, other)
        return Anchor(other, through, ((body, -near), *way))


def _other(slider: Slider, body: str) -> str:
    return slider.along if body == slider.body else slider.body


def _turn(slider: Slider, body: str) -> Complex:
    """Direction of the body's x axis seen from the other body of the slider."""
    turn = slider.direction * np.exp(1j * np.radians(slider.angle_deg)) if slider.angle_deg else slider.direction
    return turn if body == slider.body else np.conj(turn)


def _seen_from(slider: Slider, other: str) -> tuple[complex | Complex, complex | Complex, Complex]:
    """A slider as a line on `other`: the point that runs on it, a point of the line, the line's direction.

    Seen from the body that slides, it is the guide's own point that runs along a line through `point`,
    backwards; the line's direction is kept, which leaves the slide's sign as it is.
    """
    if other == slider.along:
        return slider.point, slider.through, slider.direction
    return slider.through, slider.point, _turn(slider, slider.body).conjugate() * slider.direction


def _stroke_seen_from(slider: Slider, other: str) -> tuple[complex | Complex, complex | Complex, Complex]:
    """The same with the direction in which the point runs as the slider's displacement grows."""
    near, through, direction = _seen_from(slider, other)
    return near, through, direction if other == slider.along else -direction


@checked
def move(
    linkage: AnyLinkage, drive: Reals, branch: Branch = 1, speed: Reals = 1.0, acceleration: Reals = 0.0
) -> Motion:
    """Motion of a linkage whose driver stands at `drive`: rad from the ground's x axis, mm where a slider drives.

    drive: (frames,). speed and acceleration of the driver, rad/s and rad/s2 or mm/s and mm/s2: numbers or
    (frames,). branch: +1 or -1 for all dyads, or for each by the name of its inner joint (+1 where not
    named): +1 puts the joint left of the line from the first body's outer pin to the second's. A point's name with
    its place, a complex number in mm, takes the branch nearest to that at the first frame at which its dyad closes, and
    starts bodies that are no chain of dyads as the linkage's `estimate` does. "follow" starts at +1, `Continuation`
    at any of these, and keeps the smooth continuation, at any step: through a change point, where the branches meet,
    and past a place where they only come near. A frame that cannot be reached is nan with closed False. At a true
    dead centre of the driver the rates are not finite. Dyads are solved in closed form, whatever else by Newton's method on their
    loop equations; rates come by the chain rule from kinematic coefficients.
    """
    general = linkage.linkage
    q = np.asarray(drive, dtype=float)
    q = q if q.ndim else q[None]
    if q.ndim != 1:
        raise DesignError(
            "drive", "found something else than one row of finite numbers", "give (frames,) of rad or mm", "wrong-type"
        )
    timing = Timing(_time("speed", speed, q, general), _time("acceleration", acceleration, q, general))
    asked = chosen(branch)
    return Motion(general, q, timing, LinkageSolution(general, _plan_for(general, asked), q, asked, timing))


def _time(name: str, told: Reals, drive: Real, linkage: Linkage) -> Real:
    """Speed or acceleration as a number, or over all frames and linkages."""
    values = np.asarray(told, dtype=float)
    if not values.ndim:
        return values
    if values.shape != drive.shape:
        raise DesignError(name, f"found shape {values.shape}", f"give a number or {drive.shape} of them", "conflict")
    return values.reshape(-1, *(1,) * len(linkage.shape))


def planned(linkage: Linkage, branch: Branch) -> tuple[Placement, ...]:
    """How the bodies are placed on a branch; DesignError for joints or points that the linkage has not."""
    return _plan_for(linkage, chosen(branch))


def _plan_for(linkage: Linkage, asked: BranchSpec) -> tuple[Placement, ...]:
    told = replace(linkage, estimate={**linkage.estimate, **asked.branch_points}) if asked.branch_points else linkage
    placements = plan(told, asked.follow)
    if asked.branch_points and not any(isinstance(one, Loops) for one in placements):
        # Only what is iterated starts from places. Any other plan is the linkage's own, by which its formulas are kept.
        placements = plan(linkage, asked.follow)
    if asked.branch or asked.branch_points:
        asked.check(linkage, [one.joint for one in placements if isinstance(one, Dyad)])
    return placements
