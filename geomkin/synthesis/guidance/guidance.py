"""Linkages that carry a body through poses: four-bars, slider-cranks and elliptic trammels, ranked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Literal

import numpy as np

from ...core.arguments import ArgumentType, between, checked, is_complex, whole_between
from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.processes import Watch
from ...core.records import record
from ...core.units import bare_mm
from ...linkage.linkage import AbstractLinkage
from ...linkage.moving import move
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real, Whole, direction_deg, rounded
from ..found import Found, Rounding, ten_digits
from .dyads import dyads_through
from .guide_groups import (
    KINDS,
    LARGEST_RATIO,
    Group,
    GuideRequest,
    Kind,
    along_curves,
    guided_linkages,
    of_chosen,
    of_dyads,
)
from .guide_search import Displacements
from .guides import AbstractGuides
from .poses import Poses, distinct_poses

# Largest error of an exact linkage, as a share of the size of the poses: rounding of dyads that lie close together.
EXACT = 1e-8
# Least length of a link as a share of the longest. A shorter one results from rounding of two coinciding pins.
LEAST_LINK = 1e-9
# Decimals of a degree to which transmission angles are compared. With fewer a better linkage may come second.
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

    Its coupler point (rod point of a trammel) is the origin of the body.

    Parameters
    ----------
    linkage, branch, drive, transmission_angle_deg, defects
        As for `Found`.
    kind : str
        "four-bar", "crank-slider" (a slider-crank driven by its crank), "slider-crank" (driven by its slider) or
        "elliptic-trammel".
    body_angle_deg : float
        Angle of the body in the coupler's frame.
    pose_error : float
        Largest distance of the body's origin from its wanted position when the linkage is moved to `drive`, mm.
    angle_error_deg : float
        Largest error of the body's angle there.
    cut_short : bool
        Whether the time limit ended the search.
    poses : tuple of two arrays
        The wanted poses: origins, mm, and directions, unit complex.
    """

    kind: str
    body_angle_deg: float
    pose_error: float
    angle_error_deg: float
    cut_short: bool = False
    poses: tuple[Complex, Complex] = field(repr=False)

    def rounded(self, rounding: Rounding) -> BodyGuide:
        body_angle = rounding.angle("", self.body_angle_deg)
        other = replace(super().rounded(rounding), body_angle_deg=body_angle)
        branches = np.full(other.drive.shape, self.branch)
        distances, angles = _pose_errors(other.linkage, other.drive, branches, body_angle, self.poses)
        if self.defects:
            # Some poses may be on the other branch; the nearer position counts.
            distances_by_branch = (
                distances,
                _pose_errors(other.linkage, other.drive, -branches, body_angle, self.poses)[0],
            )
            branches = np.where(
                np.argmin(np.nan_to_num(distances_by_branch, nan=np.inf), axis=0) == 0, branches, -branches
            )
            distances, angles = _pose_errors(other.linkage, other.drive, branches, body_angle, self.poses)
        return replace(other, pose_error=float(distances.max()), angle_error_deg=float(angles.max()))

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
        # The errors of exact poses are rounding noise, which differs between processors.
        entries = {name: to_digits(float(rounded(value, 9)), 6) for name, value in error.items()}
        entries |= {"body_angle_deg": to_digits(self.body_angle_deg, 10)}
        pins = {
            f"{name}_pin_on_body_mm": [ten_digits(pin.real), ten_digits(pin.imag)]
            for name, pin in zip(("driving", "driven"), self.pins)
            if np.isfinite(pin)
        }
        return entries | {"driver": self.linkage.linkage.driver} | pins | dict(super().summary())


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
    time_limit: Annotated[float, between(0, 3600, "s")] = 30.0,
    driving_point: Literal["first", "either"] = "first",
) -> tuple[BodyGuide, ...]:
    """Find linkages that carry a body through three or more poses.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Each pose is the position x + yj of the body's origin, mm, and its angle, rad; they are passed in this order.
    kind : {"four-bar", "crank-slider", "slider-crank", "elliptic-trammel"}, optional
        A "crank-slider" is a slider-crank driven by its crank, a "slider-crank" one driven by its slider. By default a
        four-bar for three poses, and every kind that the dyads allow for more.
    moving_points : tuple of two complex, optional
        For three poses: the driving and the driven pin in the body's frame, mm. If a slider is wanted, the nearest
        point that slides replaces the point.
    fixed_points : tuple of two complex, optional
        For three poses: the ground pivots of a four-bar instead, mm.
    region : tuple of two complex, optional
        Opposite corners (low, high) of the box that holds all joints at all poses, mm. By default a box about the
        origins and the near poles.
    trammel_driver : {"shuttle", "rod"}
        What drives an elliptic trammel.
    least_transmission_angle_deg : float
        Linkages with a smaller transmission angle are left out, 0 to 89 deg.
    largest_ratio : float, optional
        Linkages with a larger ratio of the longest link to the shortest are left out. By default 10 for searches and
        least-squares fits.
    seed : int
        Seed of the random search.
    time_limit : float
        Longest processor time of the search, s, 0 to 3600.
    driving_point : {"first", "either"}
        With "either" the second of two given points may drive as well; both linkages are listed.

    Returns
    -------
    tuple of BodyGuide
        Linkages without defects first, sorted by transmission angle. Linkages through given points are listed whatever
        their defects.

    Raises
    ------
    DesignError
        For fewer than three poses, equal poses, a time limit too short for any result, or if there is no such linkage.
        If the region is too small, the message gives one that is large enough.

    See Also
    --------
    dyads_through, path_generator, function_generator

    Notes
    -----
    Three poses have many linkages: pins are searched for in the region. Four: pairs of dyads along the Burmester curves
    in the region. Five: pairs of all dyads. More: pairs of dyads that fit the poses by least squares; `pose_error` is
    the remaining error. Transmission angles are the least on the motion from the first pose to the last.

    McCarthy and Soh, Geometric Design of Linkages, 2010, chapters 5 and 6; the search and the detection of defects are
    derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> poses = [(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)]
    >>> best = gk.body_guides(poses)[0]
    >>> best.defects, best.pose_error < 1e-9
    ((), True)
    """
    origins, directions = distinct_poses(poses, 3)
    watch = Watch(time_limit, "looking for linkages through the poses")
    body = Displacements(origins, directions)
    has_points = moving_points is not None or fixed_points is not None
    any_point = len(origins) == 3 or body.translated
    kinds: Sequence[Kind] = (kind,) if kind else KINDS[:1] if any_point or has_points else KINDS
    request = GuideRequest(
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

    def search(request: GuideRequest) -> tuple[BodyGuide, ...]:
        if has_points:
            return _ranked(request, of_chosen(request, moving_points, fixed_points))
        if any_point:
            # Any point of the body is a solution. More than three parallel poses have solutions only with cranks, if
            # the origins are on a circle.
            return _ranked(request, guided_linkages(request) if len(origins) == 3 or kinds == KINDS[:1] else [])
        return _ranked(
            request, along_curves(request, poses) if len(origins) == 4 else of_dyads(request, dyads_through(poses))
        )

    guides = search(request)
    if guides:
        return guides
    if watch.cut:
        raise watch.too_short()
    problem = f"found no {' or '.join(kinds)} through them that keeps the limits"
    # Chosen points for three poses, and dyads of more than four, are not limited by a default region.
    if region is not None or not (has_points or len(origins) > 4):
        for corners in request.larger_regions:
            if search(replace(request, region=corners, rng=np.random.default_rng(seed))):
                low, high = (f"{bare_mm(to_digits(z.real, 12), to_digits(z.imag, 12))}" for z in corners)
                problem = f"{problem} in the region"
                raise DesignError("poses", problem, f"give a larger region: [[{low}], [{high}]] is large enough")
            if watch.over():
                raise DesignError("poses", problem, "give a larger region, weaker limits, another kind or other poses")
    raise DesignError(
        "poses", problem, "give weaker limits, another kind or other poses; a larger region does not help"
    )


def _ranked(request: GuideRequest, groups: Sequence[Group]) -> tuple[BodyGuide, ...]:
    """Linkages of all groups within the limits, the best first."""
    ratio = np.inf if request.largest_ratio is None else request.largest_ratio
    ranked: list[BodyGuide] = []
    for kind, guides in groups:
        with np.errstate(all="ignore"):
            no_defects, angle = guides.defects.none, guides.angle
            is_kept = _possible(guides) & (guides.ratio <= ratio) & ~(no_defects & (angle < request.least_angle))
        ranked += [_body_guide(request, kind, guides, k) for k in np.flatnonzero(is_kept).tolist()]
    size = float(np.abs(request.body.shifts).max()) or 1.0
    if len(request.body.origins) > 5 and request.largest_ratio is None:
        # The best fits are often two dyads that nearly coincide. Exact solutions have no limit.
        ranked = [guide for guide in ranked if guide.ratio <= LARGEST_RATIO or guide.pose_error <= EXACT * size]

    def rank(guide: BodyGuide) -> tuple[float, ...]:
        # Least-squares fits are sorted by their error. Among equal transmission angles, which a body that rotates by a
        # given angle may impose, the most even links come first.
        missed = guide.pose_error if np.isfinite(guide.pose_error) else np.inf
        angle = np.nan_to_num(guide.transmission_angle_deg, nan=-1.0)
        return len(guide.defects) > 0, 0.0 if missed <= EXACT * size else missed, -round(angle, ALIKE), guide.ratio

    return tuple(sorted(ranked, key=rank))


def _possible(guides: AbstractGuides) -> Mask:
    """Mask of real linkages: all sizes finite, and no link of zero length."""
    sizes = np.array(guides.links)
    is_finite = np.isfinite(np.concatenate([guides.joints, sizes])).all(axis=0)
    has_drive = np.isfinite(guides.defects.drive).all(axis=0)
    return np.asarray(is_finite & has_drive & (sizes.min(axis=0) > LEAST_LINK * sizes.max(axis=0)))


def _body_guide(request: GuideRequest, kind: Kind, guides: AbstractGuides, k: int) -> BodyGuide:
    origins, directions = request.body.origins, request.body.directions
    point, angle = guides.holds(k, complex(origins[0]), complex(directions[0]))
    linkage, defects = guides.linkage(k, point), guides.defects
    drive, signs = defects.drive[:, k], defects.sign[:, k]
    body_angle_deg = float(np.degrees(angle))
    distances, angles = _pose_errors(linkage, drive, signs, body_angle_deg, (origins, directions))
    return BodyGuide(
        linkage=linkage,
        branch=int(signs[0]),
        drive=drive,
        transmission_angle_deg=float(np.degrees(guides.angle[k])),
        defects=defects.named(k),
        kind=kind,
        body_angle_deg=body_angle_deg,
        pose_error=float(distances.max()),
        angle_error_deg=float(angles.max()),
        cut_short=request.watch.cut,
        poses=(origins, directions),
    )


def _pose_errors(
    linkage: AbstractLinkage, drive: Real, signs: Whole, body_angle_deg: float, poses: tuple[Complex, Complex]
) -> tuple[Real, Real]:
    """Distance of the body from each pose, mm, and error of its angle, deg."""
    positions, directions = _moved(linkage, drive, signs)
    angles = np.angle(directions * direction_deg(body_angle_deg) * np.conj(poses[1]), deg=True)
    return np.abs(positions - poses[0]), np.abs(angles)


def _moved(linkage: AbstractLinkage, drive: Real, signs: Whole) -> tuple[Complex, Complex]:
    """Positions of the body's origin and directions of the coupler at the given drive positions."""
    body, point = ("rod", "rod_point") if "rod" in linkage.linkage.bodies else ("coupler", "coupler_point")
    motions = [move(linkage, drive, sign) for sign in (1, -1)]
    is_positive = signs > 0
    positions = [motion.point(point).position for motion in motions]
    directions = [motion.bodies[body].direction for motion in motions]
    return np.where(is_positive, *positions), np.where(is_positive, *directions)
