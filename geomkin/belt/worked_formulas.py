"""Formulas of belt and chain drives with the numbers put in."""

from __future__ import annotations

import numpy as np

from ..core.units import LengthUnit
from ..model.check import WorkedFormula, WorkedFormulas
from .drive import LoopDrive
from .profiles import BeltProfile


def loop_formulas(drive: LoopDrive, unit: LengthUnit) -> tuple[WorkedFormula, ...]:
    """Pitch diameters, ratios, strands, and the length of the loop round all wheels."""
    source = "Shigley, Mechanical Engineering Design, chapter 17"
    p, loop, count = float(unit.of(drive.profile.pitch)), drive.loop, len(drive.wheels)
    worked = WorkedFormulas(source, {"p": p, "N": drive.count, "pi": np.pi})
    for k, (wheel, wrap, axis) in enumerate(zip(drive.wheels, loop.wraps, drive.axes), 1):
        following = drive.wheels[k % count]
        worked.numbers[f"D_{k}"] = float(unit.of(abs(drive.axes[k % count] - axis)))
        worked.numbers[f"w_{k}"] = float(np.degrees(wrap))
        if wheel.teeth is None:
            worked.numbers[f"d_{k}"] = float(unit.of(2 * wheel.radius))
            continue
        worked.numbers[f"z_{k}"] = wheel.teeth
        form = "{p} {z} / {pi}" if isinstance(drive.profile, BeltProfile) else "{p} / sin(180 deg / {z})"
        template = form.replace("{z}", f"{{z_{k}}}")
        worked.add(f"pitch diameter of {wheel.name}", f"d_{k}", template, float(unit.of(2 * wheel.radius)), unit.name)
    lengths, terms = 0.0, []
    for k, (wheel, span) in enumerate(zip(drive.wheels, loop.spans), 1):
        after = k % count + 1
        following = drive.wheels[after - 1]
        sign = "-" if wheel.is_outside == following.is_outside else "+"
        if wheel.teeth and k > 1:
            ratio = wheel.teeth / (drive.wheels[0].teeth or 1)
            worked.add(f"turns of the driver for one of {wheel.name}", f"i_{k}", f"{{z_{k}}} / {{z_1}}", ratio)
        template = f"sqrt({{D_{k}}}^2 - (({{d_{k}}} {sign} {{d_{after}}}) / 2)^2)"
        name = f"strand from {wheel.name} to {following.name}, axes D_{k} apart"
        terms.append(f"{{t_{k}}}")
        lengths += worked.add(name, f"t_{k}", template, float(unit.of(span)), unit.name)
    for k, (wheel, wrap) in enumerate(zip(drive.wheels, loop.wraps), 1):
        arc = wrap / (2 * np.pi) * (p * wheel.teeth if wheel.teeth else 2 * np.pi * float(unit.of(wheel.radius)))
        template = f"{{p}} {{z_{k}}} {{w_{k}}} / 360" if wheel.teeth else f"{{d_{k}}} {{pi}} {{w_{k}}} / 360"
        terms.append(f"{{b_{k}}}")
        lengths += worked.add(f"length round {wheel.name}, along w_{k} deg", f"b_{k}", template, arc, unit.name)
    worked.add("length of strands and arcs", "L", " + ".join(terms), lengths, unit.name)
    worked.add("length of the loop", "L_N", "{N} {p}", drive.count * p, unit.name)
    return tuple(worked.formulas)
