"""What a summary tells of gears besides their parts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..errors import DesignError
from ..gear.contract import AbstractInvoluteGear
from ..gear.measures import chord, over_pins, span
from ..gear.pair import GearPair


def shown(value: float) -> float:
    """A number with the digits that a summary carries."""
    return float(f"{value:.9g}")


def gear_notes(gear: AbstractInvoluteGear) -> Mapping[str, object]:
    """Radii and measures for the shop, mm; a measure that a gear does not have is left out."""
    notes: dict[str, object] = {
        "teeth": gear.teeth,
        "module": shown(gear.module),
        "pressure_angle_deg": shown(np.degrees(gear.pressure_angle)),
        "profile_shift": shown(gear.profile_shift),
        "tip_radius": shown(gear.tip_radius),
        "form_radius": shown(gear.form_radius),
        "pitch_radius": shown(gear.pitch_radius),
        "base_radius": shown(gear.base_radius),
        "root_radius": shown(gear.root_radius),
        "base_pitch": shown(gear.base_pitch),
    }
    try:
        pins = over_pins(gear)
        word = "between_pins" if gear.is_ring else "over_pins"
        notes[word] = {"pin_diameter": shown(pins.pin), "measure": shown(pins.diameter)}
    except DesignError:
        pass
    if gear.is_undercut:
        notes["share_of_involute_lost"] = shown(gear.involute_lost)
    try:
        over = span(gear)
        notes["span"] = {"teeth": over.teeth, "measure": shown(over.length)}
        tooth = chord(gear)
        notes["chordal_thickness"] = {"thickness": shown(tooth.chord), "height": shown(tooth.height)}
    except DesignError:
        pass
    return notes


def mesh_notes(pair: GearPair) -> Mapping[str, object]:
    """What two gears do together."""
    start, end = pair.contact_lengths
    return {
        "centre_distance_mm": shown(pair.centre_distance),
        "working_pressure_angle_deg": shown(np.degrees(pair.working_pressure_angle)),
        "contact_ratio": shown(pair.contact_ratio),
        "backlash_mm": round(pair.backlash, 9) + 0.0,
        "clearances_mm": [shown(c) for c in pair.clearances],
        "largest_specific_sliding": [shown(float(pair.sliding(start)[0])), shown(float(pair.sliding(end)[1]))],
        "interferences": list(pair.interferences),
    }
