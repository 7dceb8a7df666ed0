"""Linkages that carry a body through poses: four-bars, slider-cranks, elliptic trammels, ranked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Literal

import numpy as np

from ...core.arguments import ArgumentType, between, checked, is_complex, whole_between
from ...core.errors import DesignError
from ...core.progress import Watch
from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.moving import move
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real, Whole, direction_deg, rounded
from ..found import Found, ten_digits
from ..rounding import Rounding
from .dyads import dyads_through
from .guide_groups import KINDS, LARGEST_RATIO, Asked, Group, Kind, along_curves, of_chosen, of_dyads, searched
from .guide_search import Displacements
from .guides import AbstractGuides
from .poses import Poses, placed

# Share of the poses' size that an exact linkage misses them by, at most: rounding of dyads that lie close together.
EXACT = 1e-8
# Share of the longest link that a link has at least: less is rounding of two pins at one place.
LEAST_LINK = 1e-9
# Decimals of a degree to which transmission angles count as the same. Fewer, and a better one may come second.
ALIKE = 2

Pair = Annotated[
    tuple[complex, complex],
    ArgumentType(
        lambda value: isinstance(value, (tuple, list)) and len(value) == 2 and all(is_complex(z) for z in value),
        "two places x + yj, mm",
    ),
]


@record(eq=False, kw_only=True)
class BodyGuide(Found):
    """A linkage whose coupler carries a body through poses.

    Its coupler point (a trammel's rod point) is the body's origin, and body_angle_deg the body's angle in the
    coupler's frame. kind: by what drives: of a "crank-slider" the crank, of a "slider-crank" the slider; `pins` says
    which points of the body drive and are driven. pose_error:
    the farthest that the body's origin is from where it is wanted, mm, and angle_error_deg the most that its angle is
    off, when the linkage is moved to `drive`. cut_short: whether the search was stopped by its time. poses: those
    wanted, as origins, mm, and directions.
    """

    kind: str
    body_angle_deg: float
    pose_error: float
    angle_error_deg: float
    cut_short: bool = False
    poses: tuple[Complex, Complex] = field(repr=False)

    def rounded(self, rounding: Rounding) -> BodyGuide:
        turned = rounding.angle("", self.body_angle_deg)
        other = replace(super().rounded(rounding), body_angle_deg=turned)
        signs = np.full(other.drive.shape, self.branch)
        off, angles = _missed(other.linkage, other.drive, signs, turned, self.poses)
        if self.defects:
            # Some poses may be on the other branch: of each what is nearer.
            both = off, _missed(other.linkage, other.drive, -signs, turned, self.poses)[0]
            signs = np.where(np.argmin(np.nan_to_num(both, nan=np.inf), axis=0) == 0, signs, -signs)
            off, angles = _missed(other.linkage, other.drive, signs, turned, self.poses)
        return replace(other, pose_error=float(off.max()), angle_error_deg=float(angles.max()))

    @property
    def pins(self) -> tuple[complex, complex]:
        """Driving and driven pin on the body, in its own frame, mm; nan if the rod of a trammel drives."""
        linkage = self.linkage
        if isinstance(linkage, EllipticTrammel):
            length, point, swapped = linkage.rod, linkage.rod_point, False
        else:
            assert isinstance(linkage, (FourBar, SliderCrank))
            length, point, swapped = linkage.coupler, linkage.coupler_point, linkage.driver == "slider"
        first, second = ((pin - point) * np.exp(-1j * np.radians(self.body_angle_deg)) for pin in (0.0, length))
        if linkage.linkage.driver == "rod":
            first = second = complex(np.nan, np.nan)
        return (second, first) if swapped else (first, second)

    def summary(self) -> Mapping[str, object]:
        error = {"pose_error_mm": self.pose_error, "angle_error_deg": self.angle_error_deg}
        # Of exact poses nothing is left but rounding, of which no two processors have the same.
        told = {name: float(f"{rounded(value, 9):.6g}") for name, value in error.items()}
        told |= {"body_angle_deg": float(f"{self.body_angle_deg:.10g}")}
        pins = {
            f"{name}_pin_on_body_mm": [ten_digits(pin.real), ten_digits(pin.imag)]
            for name, pin in zip(("driving", "driven"), self.pins)
            if np.isfinite(pin)
        }
        return told | {"driver": self.linkage.linkage.driver} | pins | dict(super().summary())


@checked
def body_guides(
    poses: Poses,
    kind: Kind | None = None,
    moving_points: Pair | None = None,
    fixed_points: Pair | None = None,
    region: Pair | None = None,
    trammel_driver: Literal["shuttle", "rod"] = "shuttle",
    least_transmission_angle_deg: Annotated[float, between(0, 89, "deg")] = 0.0,
    largest_ratio: Annotated[float, between(1, 1e9)] | None = None,
    seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    time_limit: Annotated[float, between(0, 3600, "s")] = 10.0,
    driving_point: Literal["first", "either"] = "first",
) -> tuple[BodyGuide, ...]:
    """Linkages that carry a body through poses, three or more: those without defects first, the best angle first.

    poses: (origin x + yj in mm, angle in rad) each, to be passed in this order. kind: a "crank-slider" is a
    slider-crank that its crank drives, a "slider-crank" one that its slider drives; an "elliptic-trammel" is driven by
    `trammel_driver`. Where it is left out, a four-bar through three poses, and through more whatever their dyads make.

    Three poses: many linkages. moving_points: the body's two points, in its own frame, the driving link's and the
    driven one's; for a slide the nearest point that slides is taken. fixed_points: ground pivots of a four-bar instead.
    driving_point: with "either" the second point may drive as well, and both linkages are listed. What is chosen so is
    listed whatever its defects. Else pins are searched for in a region,
    corners (low, high), that holds all joints at all poses; left out, it is taken about the origins and near poles.
    Four: pairs of dyads along the Burmester curves, in the region. Five: pairs of all dyads there are. More: pairs of
    dyads that come near the poses in the sense of least squares, `pose_error` being what is missed.
    least_transmission_angle_deg, and largest_ratio of the longest link to the shortest (10 in a search and of least
    squares, where none is given), leave others out. Linkages with defects, by name, come after those without.
    DesignError for fewer poses and equal ones, time too short for any answer, and where there is no such linkage; if
    it lacks room, with a region that is large enough.

    McCarthy and Soh, Geometric Design of Linkages, 2010, chapters 5 and 6; the search and the verdict on defects are
    derived here. Transmission angles are the least on the way from the first pose to the last.
    """
    origins, directions = placed(poses, 3)
    watch = Watch(time_limit, "looking for linkages through the poses")
    body = Displacements(origins, directions)
    chosen = moving_points is not None or fixed_points is not None
    free = len(origins) == 3 or body.translated
    kinds: Sequence[Kind] = (kind,) if kind else KINDS[:1] if free or chosen else KINDS
    ask = Asked(
        body=body,
        kinds=kinds,
        shuttle=trammel_driver == "shuttle",
        region=region,
        either=driving_point == "either",
        least_angle=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=largest_ratio,
        rng=np.random.default_rng(seed),
        watch=watch,
    )

    def look(ask: Asked) -> tuple[BodyGuide, ...]:
        if chosen:
            return _ranked(ask, of_chosen(ask, moving_points, fixed_points))
        if free:
            # Any point of the body will do: of many parallel poses, if their origins are on a circle, for cranks alone.
            return _ranked(ask, searched(ask) if len(origins) == 3 or kinds == KINDS[:1] else [])
        return _ranked(ask, along_curves(ask, poses) if len(origins) == 4 else of_dyads(ask, dyads_through(poses)))

    found = look(ask)
    if found:
        return found
    if watch.cut:
        raise DesignError("time_limit", f"found {time_limit:g} s, too short for any answer", "give 10 or more")
    problem = f"found no {' or '.join(kinds)} through them that keeps the limits"
    # Points that are chosen for three poses, and dyads of more than four, are not kept out of any region of our own.
    if region is not None or not (chosen or len(origins) > 4):
        for corners in ask.larger_regions:
            if look(replace(ask, region=corners, rng=np.random.default_rng(seed))):
                low, high = ([float(f"{v:.12g}") for v in (z.real, z.imag)] for z in corners)
                problem = f"{problem} in the region"
                raise DesignError("poses", problem, f"give a larger region: [{low}, {high}] is large enough")
            if watch.over():
                raise DesignError("poses", problem, "give a larger region, weaker limits, another kind or other poses")
    raise DesignError("poses", problem, "give weaker limits, another kind or other poses: more room does not help")


def _ranked(ask: Asked, groups: Sequence[Group]) -> tuple[BodyGuide, ...]:
    """The linkages of all groups that keep the limits, the best first."""
    ratio = np.inf if ask.largest_ratio is None else ask.largest_ratio
    found: list[BodyGuide] = []
    for kind, guides in groups:
        with np.errstate(all="ignore"):
            none, angle = guides.defects.none, guides.angle
            kept = _possible(guides) & (guides.ratio <= ratio) & ~(none & (angle < ask.least_angle))
        found += [_made(ask, kind, guides, k) for k in np.flatnonzero(kept).tolist()]
    size = float(np.abs(ask.body.ways).max()) or 1.0
    if len(ask.body.origins) > 5 and ask.largest_ratio is None:
        # The best fits are often two dyads that are nearly one: no limit is for what is met exactly.
        found = [one for one in found if one.ratio <= LARGEST_RATIO or one.pose_error <= EXACT * size]

    def rank(guide: BodyGuide) -> tuple[float, ...]:
        # What is met by least squares goes by how nearly; where many have the same angle, as that of a body that turns
        # by so much must, the most even links come first.
        missed = guide.pose_error if np.isfinite(guide.pose_error) else np.inf
        angle = np.nan_to_num(guide.transmission_angle_deg, nan=-1.0)
        return len(guide.defects) > 0, 0.0 if missed <= EXACT * size else missed, -round(angle, ALIKE), guide.ratio

    return tuple(sorted(found, key=rank))


def _possible(guides: AbstractGuides) -> Mask:
    """Which are linkages at all: finite, and no link a point."""
    sizes = np.array(guides.links)
    whole = np.isfinite(np.concatenate([guides.joints, sizes])).all(axis=0)
    told = np.isfinite(guides.defects.drive).all(axis=0)
    return np.asarray(whole & told & (sizes.min(axis=0) > LEAST_LINK * sizes.max(axis=0)))


def _made(ask: Asked, kind: Kind, guides: AbstractGuides, k: int) -> BodyGuide:
    origins, directions = ask.body.origins, ask.body.directions
    point, angle = guides.holds(k, complex(origins[0]), complex(directions[0]))
    linkage, found = guides.linkage(k, point), guides.defects
    drive, signs = found.drive[:, k], found.sign[:, k]
    body_angle_deg = float(np.degrees(angle))
    off, angles = _missed(linkage, drive, signs, body_angle_deg, (origins, directions))
    return BodyGuide(
        linkage=linkage,
        branch=int(signs[0]),
        drive=drive,
        transmission_angle_deg=float(np.degrees(guides.angle[k])),
        defects=found.named(k),
        kind=kind,
        body_angle_deg=body_angle_deg,
        pose_error=float(off.max()),
        angle_error_deg=float(angles.max()),
        cut_short=ask.watch.cut,
        poses=(origins, directions),
    )


def _missed(
    linkage: AbstractLinkage, drive: Real, signs: Whole, body_angle_deg: float, poses: tuple[Complex, Complex]
) -> tuple[Real, Real]:
    """How far the body is from each pose, mm, and by how much it is turned from it, deg."""
    places, turns = _moved(linkage, drive, signs)
    angles = np.angle(turns * direction_deg(body_angle_deg) * np.conj(poses[1]), deg=True)
    return np.abs(places - poses[0]), np.abs(angles)


def _moved(linkage: AbstractLinkage, drive: Real, signs: Whole) -> tuple[Complex, Complex]:
    """Places of the body's origin and directions of the coupler, when the linkage is moved there."""
    body, point = ("rod", "rod_point") if "rod" in linkage.linkage.bodies else ("coupler", "coupler_point")
    both = [move(linkage, drive, sign) for sign in (1, -1)]
    up = signs > 0
    places = [motion.point(point).position for motion in both]
    turns = [motion.bodies[body].direction for motion in both]
    return np.where(up, *places), np.where(up, *turns)
