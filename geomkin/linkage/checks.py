"""Whether a linkage can be assembled at every frame, how well it drives, and whether its plates can be cut and pass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, islice

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError, printable
from ..core.records import record
from ..core.units import as_sentences, marked, mm
from ..model.check import Check
from .drive_limits import driver_limits, share_reached
from .measures import transmission_extreme
from .motion import Motion
from .moving import move
from .solve.actuators import ActuatedRRP, ActuatedRRR
from .solve.branch import BranchSpec
from .solve.dyads import RPR, RRP, RRR, Crossed, Dyad
from .solve.input_dyads import DrivenRRP, DrivenRRR
from .solve.loops import Loops
from .solve.placement import Placement, RevoluteInput
from .solve.solution import LinkageSolution, extent_of

# Number of branches that are tried, those with the fewest changes first (six dyads have 64), and of frames at which
# they are compared.
TRIED, FRAMES = 64, 60
# Problem and remedy of each gap of a dyad that is below zero.
LACKS = {
    RRR: (
        ("its two links together are {:.4g} too short", "make one of them at least {:up4} longer"),
        ("one of its two links is {:.4g} too long for the other", "make the longer one at least {:up4} shorter"),
    ),
    RRP: (("its link is {:.4g} too short to reach the slide", "make it at least {:up4} longer"),) * 2,
    ActuatedRRR: (
        ("the actuator is {:.4g} too long for its pins", "give a stroke at least {:up4} shorter"),
        ("the actuator is {:.4g} too short for its pins", "give a stroke at least {:up4} longer"),
    ),
    ActuatedRRP: (("the actuator is {:.4g} too short to reach the slide", "give a stroke at least {:up4} longer"),),
    RPR: (("its pins are {:.4g} too close together for its offset", "make the offset at least {:up4} smaller"),),
}


@record
class AssemblyFailure:
    """The first frame of a motion at which the linkage cannot be assembled, and the first dyad that is open there.

    Parameters
    ----------
    joint : str
        The dyad's inner joint; for bodies that are in no dyad their names.
    frame : int
        Index of the frame.
    drive : float
        The drive there, rad, or mm if a slider drives.
    lacking : float
        Length by which the dyad is open, mm; nan if there is none (parallel guides, loops that are not dyads).
    branch : mapping of str to int, or None
        Signs by joint for which the linkage can be assembled there, with the fewest changes among those that close at
        most frames; None if none was found.
    text : str
        The problem in words.
    remedy : str
        What to change on this branch.
    """

    joint: str
    frame: int
    drive: float
    lacking: float
    branch: Mapping[str, int] | None
    text: str
    remedy: str

    def __post_init__(self) -> None:
        as_sentences(self, "text", "remedy")

    def __str__(self) -> str:
        return self.text


@checked
def assembly_failure(motion: Motion) -> AssemblyFailure | None:
    """The first frame of a motion that is open, and the reason.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.

    Returns
    -------
    AssemblyFailure or None
        None if every frame is closed.

    Raises
    ------
    DesignError
        If the motion is of arrays of linkages.

    Notes
    -----
    Derived here, from the gaps by which each dyad is open.
    """
    if motion.assembled.ndim > 1:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    if motion.assembled.all():
        return None
    frame = int(np.argmin(motion.assembled))
    drive, solution = float(motion.drive[frame]), motion.solution
    open_placement = next(placement for placement in solution.placements if _open(placement, solution, frame))
    turns = isinstance(solution.placements[0], RevoluteInput)
    at = f"at {printable(motion.linkage.driver)} {_shown(drive, turns)}"
    kind = type(open_placement.dyad) if isinstance(open_placement, DrivenRRR | DrivenRRP) else type(open_placement)
    if isinstance(open_placement, Dyad):
        gaps = [
            float(np.broadcast_to(gap, motion.assembled.shape)[frame]) for gap in open_placement.gaps(solution.poses)
        ]
        lacking, (problem, remedy) = min(zip([-gap for gap in gaps], LACKS[kind]), key=lambda row: -row[0])
        # If only rounding opens it there is no length to report.
        lacking = max(lacking, 0.0)
        name, text, remedy = open_placement.joint, problem.format(mm(lacking)), remedy.format(mm(lacking * 1.0005))
        text = f"the dyad at {printable(name)} opens first, {at}: {text}"
    else:
        assert isinstance(open_placement, Loops | Crossed)
        bodies = open_placement.waiting if isinstance(open_placement, Loops) else (open_placement.body,)
        name, lacking = ", ".join(bodies), np.nan
        text = f"{printable(name)} cannot be placed, {at}"
        remedy = "turn its guides so that they are not parallel, or give another estimate of its pins"
    branch = _closing(motion, solution, frame, open_placement)
    if branch is not None:
        changed = {joint: sign for joint, sign in branch.items() if sign != solution.signs[joint][frame]}
        signs = ", ".join(f"{printable(joint)} = {sign}" for joint, sign in changed.items())
        text += f"; it closes there with {signs}"
    return AssemblyFailure(name, frame, drive, lacking, branch, text, remedy)


def assembly_error(motion: Motion) -> DesignError:
    """The error for a motion that is open at every frame, with the branch, the drives or the length that closes it."""
    failure = assembly_failure(motion)
    assert failure is not None
    remedy = failure.remedy
    if failure.branch is not None:
        remedy = "take that branch"
    elif not np.isnan(failure.lacking) and (parts := _reached(motion, failure)):
        driver = motion.linkage.driver
        remedy = f"drive the {printable(driver)} between {' or '.join(parts)}"
    return DesignError("drive", f"the linkage closes at no frame; {marked(failure.text)}", remedy, "does-not-assemble")


def _open(placement: Placement, solution: LinkageSolution, frame: int) -> bool:
    reached = placement.reached(solution.poses)
    return reached is not None and not np.isfinite(np.broadcast_to(reached, solution.shape)[frame])


def _shown(drive: float, turns: bool) -> str:
    return f"{np.degrees(drive):.6g} deg" if turns else f"{mm(drive):.6g}"


def _closing(motion: Motion, solution: LinkageSolution, frame: int, opened: Placement) -> dict[str, int] | None:
    """Signs for which the linkage closes at a frame; the sign of a dyad only affects the dyads after it."""
    current = {joint: int(signs[frame]) or 1 for joint, signs in solution.signs.items()}
    before = solution.placements[: solution.placements.index(opened)]
    joints = [dyad.joint for dyad in before if isinstance(dyad, Dyad)]
    drives = np.append(motion.drive[frame], motion.drive[:: len(motion.drive) // FRAMES + 1])
    best: tuple[float, dict[str, int]] = (0.0, {})
    for changed in islice(_choices(joints), TRIED):
        signs = current | {joint: -current[joint] for joint in changed}
        closed = move(solution.linkage, drives, _fixed(solution, signs)).assembled
        if closed[0] and closed.mean() > best[0]:
            best = float(closed.mean()), signs
    return best[1] or None


def _fixed(solution: LinkageSolution, signs: Mapping[str, int]) -> BranchSpec:
    """These signs, with the given positions, from which loops start."""
    return BranchSpec(1, signs, solution.spec.branch_points, False)


def _choices(joints: Sequence[str]) -> Iterator[tuple[str, ...]]:
    return (some for count in range(1, len(joints) + 1) for some in combinations(joints, count))


def _reached(motion: Motion, failure: AssemblyFailure) -> list[str]:
    """The driver's ranges in which the linkage closes on the branch of the failure, as text, rounded inwards."""
    solution = motion.solution
    turns = isinstance(solution.placements[0], RevoluteInput)
    extent = extent_of(solution.linkage)
    # One turn that starts at the open drive, so that no range is cut in two.
    span = (failure.drive, failure.drive + 2 * np.pi) if turns else (-extent, extent)
    signs = {joint: int(row[failure.frame]) or 1 for joint, row in solution.signs.items()}
    texts = []
    for part in driver_limits(solution.linkage, _fixed(solution, signs), span):
        whole = 2 * np.pi * np.round(np.mean(part) / (2 * np.pi)) if turns else 0.0
        part = (part[0] - whole, part[1] - whole)
        low, high = np.degrees(part) if turns else part
        step = 10.0 ** np.floor(np.log10(high - low) - 2)
        low, high = np.ceil(low / step) * step, np.floor(high / step) * step
        texts.append(f"{mm(low, high, unit='deg' if turns else 'mm', between=' and '):.7g}")
    return texts


# deg. Below it the coupler pushes the rocker into its pivot more than round it, and play and friction grow quickly
# (Norton, Design of Machinery, on the transmission angle: above about 40 deg; the angle itself: Alt, Der
# Übertragungswinkel, Werkstattstechnik 26, 1932).
LEAST_TRANSMISSION_ANGLE_DEG = 40
# deg, the same of polygons, which only have to be drawn. At less, their vectors run off the plate; derived here, of
# polygons drawn at many positions.
LEAST_ANGLE_OF_POLYGONS_DEG = 5
# Hole to thickness. Smaller ones burn shut or break out; what cutting services ask for of laser and water jet alike.
LEAST_HOLE_TO_THICKNESS = 0.5
# mm. Traces of one curve by three linkages that are farther apart are not the same; derived here, of rounding.
SAME_CURVE = 1e-6
# Largest force over the least that it could be; chosen here.
MOST_FORCE_TO_BEST = 1.05
# Diameters and radii that are drawn, in longest links. Larger ones leave nothing else to be seen; derived here.
LARGEST_DRAWN = 5.0


def reached(motion: Motion, what: str, advice: str = "") -> Check:
    """Share of the driver's range that a motion reaches. what: whose range, such as "crank's turn"."""
    share, end = share_reached(motion)
    at = None if end is None else in_driver_unit(motion, end)
    return Check("share_reached", f"share of the {what} reached", 100 * share, "at least", 100, "%", advice, at=at)


def in_driver_unit(motion: Motion, drive: float) -> float:
    """A drive as tables state it: deg, or mm if it slides."""
    return drive if motion.linkage.driven_slider else float(np.degrees(drive))


def transmission_check(motion: Motion) -> Check:
    """The least transmission angle over the motion, deg."""
    least, drive = transmission_extreme(motion, -1)
    at = None if np.isnan(least) else in_driver_unit(motion, drive)
    driver, turns = motion.linkage.driver, motion.linkage.driven_slider is None
    change = f"such as that of the {driver}, or give a smaller range of it" if turns else "or give a shorter stroke"
    advice = f"change the link lengths, {change}"
    if at is not None:
        shown = f"{round(at, 2) + 0.0:g} deg" if turns else f"{mm(at):.4g}"
        advice = f"it is least at {printable(driver)} {shown}: {advice}"
    name, column, limit = "least transmission angle", "transmission_angle", LEAST_TRANSMISSION_ANGLE_DEG
    return Check("transmission_angle", name, least, "at least", limit, "deg", advice, column, at)


@checked
def linkage_checks(motion: Motion) -> tuple[Check, ...]:
    """Check that the driver moves through all frames, and how well it drives.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.

    Returns
    -------
    tuple of Check
        The share of the driver's range that is reached, %, and the least transmission angle, deg, both also between
        frames. The second is missing if the driver drives nothing else. The advice of a failed check names the dyad
        that opens first.

    Raises
    ------
    DesignError
        If the motion is of many linkages at once.

    Notes
    -----
    The limits are constants of this module, each with its source.
    """
    if motion.linkage.is_batch:
        raise DesignError(
            "motion", "found many linkages at once", "give one, for each has checks of its own", "wrong-type"
        )
    driver, turns, opens = motion.linkage.driver, motion.linkage.driven_slider is None, assembly_failure(motion)
    advice = (
        f"change the lengths, as that of the {driver}, or give a smaller range of the driver"
        if turns
        else "give a shorter stroke"
    )
    share = reached(
        motion, f"{driver}'s {'turn' if turns else 'stroke'}", f"{marked(opens.text)}; {advice}" if opens else advice
    )
    transmission = transmission_check(motion)
    return (share,) if motion.assembled.any() and np.isnan(transmission.value) else (share, transmission)


@checked
def hole_check(hole_diameter: PositiveFloat, thickness: PositiveFloat) -> Check:
    """Check that pin holes can be cut in a sheet, by the rule of cutting services.

    Parameters
    ----------
    hole_diameter, thickness : float
        Diameter of the holes and thickness of the sheet, mm.

    Returns
    -------
    Check
        Hole diameter to thickness.
    """
    advice = "smaller holes burn or break out when cut"
    ratio, least = hole_diameter / thickness, LEAST_HOLE_TO_THICKNESS
    return Check("pin_hole", "pin hole to thickness", ratio, "at least", least, "", advice)


def collision_advice(collisions: Sequence[object]) -> str:
    """Advice that names the first pair that meets, and the number of others."""
    more = f", and {len(collisions) - 1} more" if len(collisions) > 1 else ""
    return f"{marked(str(collisions[0]))}{more}: give narrower bars or other lengths" if collisions else ""


@checked
def collision_check(collisions: int, advice: str = "") -> Check:
    """Check that plates and pins pass each other.

    Parameters
    ----------
    collisions : int
        Number of pairs that do not, `len(stack.collisions)`.
    advice : str
        Advice of the check if it fails.

    Returns
    -------
    Check
    """
    return Check("collisions", "plates and pins that collide", collisions, "at most", 0, "", advice)
