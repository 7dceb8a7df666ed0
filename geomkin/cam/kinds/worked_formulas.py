"""Formulas of a disk cam with the numbers put in, for one frame of its table."""

from __future__ import annotations

import numpy as np

from ...core.units import LengthUnit
from ...model.check import WorkedFormula, WorkedFormulas
from ...plane.vec import Real
from ..cam import Cam
from ..followers.flat import TranslatingFlat
from ..followers.follower import side_sign
from ..followers.roller import OscillatingRoller, TranslatingRoller
from ..program.laws import LAWS
from ..program.placed_segments import place_segments
from ..program.segments import Return, Rise

# Laws as formulas of x, or of the angle phi: its start and range in deg, the lift, and its derivatives by
# x. The parabolic one is that of its first half, and those in several pieces are that of the second of them.
FORMS: dict[str, tuple[tuple[float, float], str, str, str]] = {
    "uniform": ((0, 0), "{x}", "1", "0"),
    "parabolic": ((0, 0), "2 {x}^2", "(4 {x})", "4"),
    "harmonic": ((0, 180), "(1 - cos({phi} deg)) / 2", "{pi} sin({phi} deg) / 2", "{pi}^2 cos({phi} deg) / 2"),
    "cycloidal": ((0, 360), "({x} - sin({phi} deg) / (2 {pi}))", "(1 - cos({phi} deg))", "2 {pi} sin({phi} deg)"),
    "modified-trapezoid": (
        (0, 0),
        "8 {pi} (({x} - 1 / 8)^2 / 2 + ({x} - 1 / 8) / (4 {pi}) + 1 / (32 {pi}) - 1 / (16 {pi}^2)) / (2 + {pi})",
        "8 {pi} ({x} - 1 / 8 + 1 / (4 {pi})) / (2 + {pi})",
        "8 {pi} / (2 + {pi})",
    ),
    "modified-sine": (
        (60, 240),
        "(2 + {pi} {x} - 9 sin({phi} deg) / 4) / (4 + {pi})",
        "{pi} (1 - 3 cos({phi} deg)) / (4 + {pi})",
        "4 {pi}^2 sin({phi} deg) / (4 + {pi})",
    ),
    "3-4-5": (
        (0, 0),
        "(10 {x}^3 - 15 {x}^4 + 6 {x}^5)",
        "(30 {x}^2 - 60 {x}^3 + 30 {x}^4)",
        "(60 {x} - 180 {x}^2 + 120 {x}^3)",
    ),
    "4-5-6-7": (
        (0, 0),
        "(35 {x}^4 - 84 {x}^5 + 70 {x}^6 - 20 {x}^7)",
        "(140 {x}^3 - 420 {x}^4 + 420 {x}^5 - 140 {x}^6)",
        "(420 {x}^2 - 1680 {x}^3 + 2100 {x}^4 - 840 {x}^5)",
    ),
}
# Where the pieces of these end, as shares of the segment.
PIECES = {"modified-trapezoid": (1 / 8, 3 / 8), "modified-sine": (1 / 8, 7 / 8)}
# Place in a segment of the frame whose numbers are put in: near the peak of its acceleration, and in the first half.
PLACE = 0.3


def cam_formulas(cam: Cam, angles: Real, rates: tuple[float, float], unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """Lift, velocity, acceleration and pressure angle in a frame of the first segment whose law is a plain formula.

    angles: of the cam in all frames, deg. rates: its speed and acceleration, rad/s and rad/s2.
    """
    placed = place_segments(cam.program.segments, cam.program.folder)
    found = next((p for p in placed if isinstance(p.segment, Rise | Return) and p.segment.law in FORMS), None)
    if found is None:
        return ()
    is_arm, law = cam.follower.oscillates, str(getattr(found.segment, "law", ""))
    size, length = (float(np.radians(1.0)), "rad") if is_arm else (float(unit.of(1.0)), unit.name)
    wanted = (found.start + PLACE * (found.end - found.start)) % 360
    row = int(np.argmin(np.abs(angles - wanted)))
    x = float((angles[row] - found.start) % 360) / (found.end - found.start)
    low, high = PIECES.get(law, (0.0, 0.5))
    if not low < x < high:
        return ()
    (start_deg, range_deg), *forms = FORMS[law]
    worked = WorkedFormulas(f"VDI 2143 Blatt 1, the law {law}")
    worked.give("theta", "cam angle in this frame", angles[row], "deg")
    worked.give("theta_0", "cam angle at the start of the segment", found.start % 360, "deg")
    worked.give("beta", "range of the segment", found.end - found.start, "deg")
    start = worked.give("s_0", "lift at the start of the segment", found.lift * size, length)
    rise = worked.give("h", "change of the lift in the segment", (found.end_lift - found.lift) * size, length)
    rate = worked.give("omega", "angular velocity of the cam", rates[0], "rad/s")
    alpha = worked.give("alpha", "angular acceleration of the cam", rates[1], "rad/s2")
    worked.add("place in the segment, from 0 to 1", "x", "({theta} - {theta_0}) / {beta}", x)
    width = worked.add("range of the segment", "B", "{beta} {pi} / 180", found.radians, "rad")
    if range_deg:
        template = f"{start_deg:g} + {range_deg:g} {{x}}" if start_deg else f"{range_deg:g} {{x}}"
        worked.add("angle of the law", "phi", template, start_deg + range_deg * x, "deg")
    values = np.asarray(LAWS[law](np.array([x])))[:, 0] * rise
    words = "angle of the arm from its start" if is_arm else "lift"
    lift = worked.add(words, "s", f"{{s_0}} + {{h}} {forms[0]}", start + values[0], length)
    first = worked.add(
        "its derivative by the cam angle", "s_1", f"{{h}} {forms[1]} / {{B}}", values[1] / width, f"{length}/rad"
    )
    second = worked.add(
        "its second derivative", "s_2", f"{{h}} {forms[2]} / {{B}}^2", values[2] / width**2, f"{length}/rad2"
    )
    worked.add("velocity", "v", "{s_1} {omega}", first * rate, f"{length}/s")
    value = second * rate**2 + first * alpha
    worked.add("acceleration", "a", "{s_2} {omega}^2 + {s_1} {alpha}", value, f"{length}/s2")
    return (*worked.formulas, *_pressure(cam, unit, worked.numbers, lift, first, second))


def _pressure(
    cam: Cam, unit: LengthUnit, numbers: dict[str, float], lift: float, first: float, second: float
) -> tuple[WorkedFormula, ...]:
    """The pressure angle of a roller, or the radius of curvature under a flat face that moves straight."""
    worked = WorkedFormulas("Norton, Design of Machinery, chapter 8", numbers)
    base = worked.give("R_b", "radius of the base circle", unit.of(cam.base_radius), unit.name)
    if roller := cam.follower.roller_radius:
        worked.give("R_r", "radius of the roller", unit.of(roller), unit.name)
    else:
        worked.numbers["R_r"] = 0.0
    prime = float(unit.of(cam.prime_radius))
    match cam.follower:
        case TranslatingRoller(offset=offset):
            e = worked.give("e", "offset, positive where it helps the rise", cam.sense * unit.of(offset), unit.name)
            template, value = "sqrt(({R_b} + {R_r})^2 - {e}^2) + {s}", np.sqrt(prime**2 - e * e) + lift
            height = worked.add("height of the roller's centre above the cam's axis", "H", template, value, unit.name)
            template, value = "atan2({s_1} - {e}, {H})", np.degrees(np.arctan2(first - e, height))
            worked.add("pressure angle", "mu", template, value, "deg")
        case OscillatingRoller(pivot_distance=distance, arm_length=arm, side=side):
            c = worked.give("c", "distance of the pivot from the cam's axis", unit.of(distance), unit.name)
            reach = worked.give("L", "length of the arm", unit.of(arm), unit.name)
            tau = worked.give("tau", "1 or -1, by the direction of the cam and the side", cam.sense * side_sign(side))
            template = "arccos(({c}^2 + {L}^2 - ({R_b} + {R_r})^2) / (2 {c} {L})) + {s} 180 / {pi}"
            value = np.degrees(np.arccos((c * c + reach**2 - prime**2) / (2 * c * reach)) + lift)
            psi = np.radians(worked.add("angle of the arm at its pivot", "psi", template, value, "deg"))
            template = "atan2({L} (1 + {tau} {s_1}) - {c} cos({psi} deg), {c} sin({psi} deg))"
            value = np.degrees(np.arctan2(reach * (1 + tau * first) - c * np.cos(psi), c * np.sin(psi)))
            worked.add("pressure angle", "mu", template, value, "deg")
        case TranslatingFlat():
            template, value = "{R_b} + {s} + {s_2}", base + lift + second
            worked.add("radius of curvature of the profile", "rho", template, value, unit.name)
    return tuple(worked.formulas)
