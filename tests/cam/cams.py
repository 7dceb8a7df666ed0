"""Cams of all followers for tests, and followers placed by hand: by other ways than the package takes."""

from functools import partial

import numpy as np

import geomkin as gk
from geomkin.cam.followers.flat import OscillatingFlat, TranslatingFlat
from geomkin.cam.followers.roller import OscillatingRoller, TranslatingRoller
from tests.made import Made


def programme(rise, swings=False, ends=(60, 180, 210, 360), laws=("3-4-5", "cycloidal")):
    """Dwell, rise, dwell, return; the rise in mm or deg."""
    up = {"rise_deg" if swings else "rise": rise}
    rest = [gk.Dwell(end_deg=360)] if ends[3] < 360 else []
    return gk.Program(
        [gk.Dwell(end_deg=ends[0]), gk.Rise(laws[0], end_deg=ends[1], **up), gk.Dwell(end_deg=ends[2]),
         gk.Return(laws[1], end_deg=ends[3]), *rest]
    )  # fmt: skip


LIFTS, SWINGS = programme(20), programme(14, swings=True)
FOLLOWERS = Made(
    {
        "roller": lambda: (TranslatingRoller(10, 12), LIFTS),
        "knife": lambda: (TranslatingRoller(0, -7), LIFTS),
        "flat": lambda: (TranslatingFlat(), LIFTS),
        "tilted": lambda: (TranslatingFlat(tilt_deg=-15), LIFTS),
        "roller on arm": lambda: (OscillatingRoller(10, 100, 80), SWINGS),
        "roller on arm below": lambda: (OscillatingRoller(6, 90, 110, "below"), SWINGS),
        "flat on arm": lambda: (OscillatingFlat(110, 8), SWINGS),
        "flat on arm below": lambda: (OscillatingFlat(110, -12, "below"), SWINGS),
    }
)


def made(name, direction):
    follower, program = FOLLOWERS[name]
    return gk.Cam(follower, program, 65 if "flat" in name else 45, direction)


# None of them undercuts.
CAMS = Made({
    f"{name}, {direction}": partial(made, name, direction)
    for name in FOLLOWERS
    for direction in ("counterclockwise", "clockwise")
})  # fmt: skip


def running_back(jump):
    """A peak at 120 deg whose acceleration is -90 mm/rad2 on both sides, where the velocity jumps down."""
    rest = {"end_velocity_per_rad": 0.0, "end_acceleration_per_rad2": 0.0}
    down = gk.cam.LiftPolynomial(
        end_lift=0.0, end_deg=190, start_velocity_per_rad=-jump, start_acceleration_per_rad2=-90.0, **rest
    )
    up = gk.Rise("harmonic", rise=20, end_deg=120)
    return gk.Program([gk.Dwell(end_deg=60), up, down, gk.Dwell(end_deg=360)])


# These do: flanks, peaks, joints, and a tip that is nearly all lost.
SHARP, TURNING = (60, 110, 120, 175), (40, 130, 130, 240)
UNDERCUT = Made({
    "roller": lambda: gk.Cam(TranslatingRoller(30, 5), programme(20, ends=SHARP), 20),
    "roller, tip lost": lambda: gk.Cam(TranslatingRoller(25, 5), programme(20, ends=SHARP), 8, "clockwise"),
    "roller, jumps": lambda: gk.Cam(TranslatingRoller(14, -4), programme(15, laws=("uniform", "uniform")), 30),
    "flat": lambda: gk.Cam(TranslatingFlat(), programme(20, ends=SHARP), 25),
    "tilted": lambda: gk.Cam(TranslatingFlat(15), programme(20, ends=SHARP), 25, "clockwise"),
    "flat, jumps": lambda: gk.Cam(TranslatingFlat(10), programme(15, laws=("uniform", "harmonic")), 30),
    "flat, back on both sides of a jump": lambda: gk.Cam(TranslatingFlat(-5), running_back(6.0), 60),
    "roller on arm": lambda: gk.Cam(OscillatingRoller(30, 100, 80), programme(15, True, SHARP), 20, "clockwise"),
    "roller on arm, jumps": lambda: gk.Cam(
        OscillatingRoller(12, 90, 70, "below"), programme(12, True, laws=("uniform", "uniform")), 35
    ),
    "flat on arm": lambda: gk.Cam(OscillatingFlat(110, 8), programme(20, True), 40, "clockwise"),
    "flat on arm, jumps": lambda: gk.Cam(OscillatingFlat(120, -5, "below"), programme(8, True, laws=("uniform", "3-4-5")), 40),
})  # fmt: skip


def rolls(cam):
    return isinstance(cam.follower, TranslatingRoller | OscillatingRoller)


def placed(cam, lift):
    """The follower at lifts of any shape, in the ground's frame: a roller's centre, or a face's (foot, normal).

    By circles that meet and tangents that are turned about their pivot, none of the package's angles.
    """
    f, base = cam.follower, cam.base_radius
    if isinstance(f, TranslatingRoller):
        return f.offset + 1j * (np.sqrt((base + f.roller_radius) ** 2 - f.offset**2) + lift)
    if isinstance(f, TranslatingFlat):
        # A line through the place where it touches the base circle, moved up.
        normal = np.exp(1j * np.radians(90 + f.tilt_deg))
        return base * normal + 1j * lift, normal
    pivot, side = f.pivot_distance, 1 if f.side == "above" else -1
    turn = np.exp(-1j * side * lift)
    if isinstance(f, OscillatingRoller):
        prime = base + f.roller_radius
        along = (prime**2 - f.arm_length**2 + pivot**2) / (2 * pivot)
        start = complex(along, side * np.sqrt(prime**2 - along**2))
        return pivot + (start - pivot) * turn
    # The face is a common tangent of the base circle and the circle of the face offset about the pivot.
    cosine = (base - f.face_offset) / pivot
    normal = complex(cosine, side * np.sqrt(1 - cosine**2)) * turn
    return pivot + f.face_offset * normal, normal


def seen_from_cam(cam, angles):
    """The follower by cam angles, seen from the cam: as `placed`."""
    turn = np.exp(-1j * cam.sense * angles)
    where = placed(cam, cam.program.motion(angles).lift)
    return where * turn if rolls(cam) else (where[0] * turn, where[1] * turn)


def depth(cam, where, z):
    """How deep points lie in the follower, mm, negative outside: `where` as from `placed`, broadcasting."""
    if rolls(cam):
        return cam.follower.roller_radius - np.abs(z - where)
    foot, normal = where
    return np.real(np.conj(normal) * (z - foot))


def resting(cam, polygon, angles):
    """Lift at which the follower rests on a closed polygon on the cam, by cam angles: by bisection."""
    low, high = np.full((2, len(angles)), [[-0.7], [1.5]] if cam.follower.oscillates else [[-30], [60]])
    turned = polygon * np.exp(1j * cam.sense * angles)[:, None]
    for _ in range(50):
        lift = 0.5 * (low + high)
        touching = _enters(cam, lift, turned)
        low, high = np.where(touching, lift, low), np.where(touching, high, lift)
    return 0.5 * (low + high)


def _enters(cam, lift, turned):
    """Whether the follower at lifts (n,) enters polygons (n, m), edges and all."""
    if not rolls(cam):
        where = tuple(np.broadcast_to(w, lift.shape)[:, None] for w in placed(cam, lift))
        return depth(cam, where, turned).max(axis=1) > 0
    centre = placed(cam, lift)[:, None]
    following = np.roll(turned, -1, axis=1)
    edge = following - turned
    along = np.clip(np.real(np.conj(edge) * (centre - turned)) / np.abs(edge) ** 2, 0, 1)
    wound = np.abs(np.angle((following - centre) / (turned - centre)).sum(axis=1))
    return (depth(cam, centre, turned + along * edge).max(axis=1) > 0) | (wound > np.pi)
