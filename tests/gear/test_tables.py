"""Tables of teeth and contact, row by row: turned flanks that meet, speeds by differences, places on outlines."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear import contact_table, flank_table, pin_table, tooth_table
from tests.campaign import by_default

CONTACTS = {
    "pair": lambda: gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(40, 2, 0.3)),
    "high ratio": lambda: gk.GearPair(*2 * [gk.SpurGear(60, 2, 0, gk.gear.RackCutter(14.5, 1.25, 1.5, 0.1))]),
    "ring": lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=0.8)),
    "rack": lambda: gk.gear.RackPair(gk.SpurGear(18, 2), gk.gear.GearRack(12, 2)),
}


def columns(table):
    return {column.id: np.asarray(column.values) for column in table.columns}


def on_flank(gear, radius):
    """Angles of the points of the right-hand flank at radii, counterclockwise."""
    z = gear.flank.point(np.linspace(gear.flank.breaks[0], gear.flank.breaks[-1], 20_001))
    return np.interp(radius, np.abs(z), np.angle(z))


@pytest.mark.parametrize("name", CONTACTS)
def test_contact_runs_along_the_line_of_action_as_the_driver_turns(name):
    pair = CONTACTS[name]()
    gear, (driver, driven) = pair.driver, pair.names
    found = columns(contact_table(pair))
    along, radius = found["along"], found[f"{driver}_radius"]
    assert (along[0], along[-1]) == pytest.approx(pair.contact_lengths)
    assert radius**2 == pytest.approx(gear.base_radius**2 + along**2)
    # The line touches the base circle: seen from the axis, its places lie beside where it does. The flank follows.
    reached = on_flank(gear, radius) + np.arccos(gear.base_radius / radius)
    still = on_flank(gear, gear.pitch_radius) + np.arccos(gear.base_radius / gear.pitch_radius)
    assert found[f"{driver}_turn"] == pytest.approx(np.degrees(reached - still), abs=1e-5)
    first, second = pair.sliding(along)
    assert (found[f"{driver}_sliding"] == first).all() and (found[f"{driven}_sliding"] == second).all()
    pitch, (start, end) = gear.base_pitch, pair.contact_lengths
    pairs = 1 + np.floor((end - along) / pitch + 1e-9) + np.floor((along - start) / pitch + 1e-9)
    assert (found["pairs"] == pairs).all()
    assert set(found["pairs"]) <= {np.floor(pair.contact_ratio), np.ceil(pair.contact_ratio)}


TEETH = {
    "sharp": lambda: gk.SpurGear(24, 2),
    "rounded": lambda: gk.SpurGear(11, 2, tip_rounding=0.1),
    "chamfered": lambda: gk.SpurGear(30, 2, tip_chamfer=0.15),
    "ring": lambda: gk.RingGear(60, 2),
    "cut tips": lambda: gk.SpurGear(24, 2, rack=gk.gear.RackCutter(fillet_radius=0.3)),
    "ring with cut tips": lambda: gk.RingGear(60, 2, 0, gk.gear.PinionCutter(fillet_radius=0.2), 0.8),
}


@pytest.mark.parametrize("name", TEETH)
def test_half_a_tooth_goes_outwards_along_the_outline(name):
    gear, tolerance = TEETH[name](), 1e-3
    found = columns(tooth_table(gear, tolerance))
    z = found["tooth_x"] + 1j * found["tooth_y"]
    assert gk.nearest(gear.outline.piece, z)[1].max() < 1e-9
    assert (np.diff(np.abs(z)) > -1e-9).all() and (found["radius"] == np.abs(z)).all()
    assert found["half_thickness_angle"] == pytest.approx(np.degrees(np.arctan(z.real / z.imag)))
    ends = sorted([gear.root_radius, gear.tip_radius])
    assert (found["radius"][0], found["radius"][-1]) == pytest.approx(ends, rel=1e-9)
    region = found["region"].tolist()
    edge = [] if gear.tip_edge is None else ["tip chamfer" if name == "chamfered" else "tip rounding"]
    order = ["bottom land", "root fillet", "flank", *edge, "tip land"]
    assert list(dict.fromkeys(region)) == (order[::-1] if gear.is_ring else order)
    for land, radius in (("bottom land", gear.root_radius), ("tip land", gear.tip_radius)):
        assert found["radius"][found["region"] == land] == pytest.approx(radius, rel=1e-9)
    # A joint is listed once, with the piece before it.
    flank = np.abs(gear.flank.point(gear.flank.breaks[[0, -1]]))
    inside = (found["radius"] < flank.max() * (1 - 1e-9)) & (found["radius"] > flank.min() * (1 + 1e-9))
    assert set(found["region"][inside]) == {"flank"}
    # No chord leaves its arc by more than the tolerance; half of it would take more rows.
    middles = 0.5 * (z[1:] + z[:-1])
    assert gk.nearest(gear.outline.piece, middles)[1].max() <= tolerance
    assert len(columns(tooth_table(gear, tolerance / 100))["radius"]) > 5 * len(z)


def straight(mate_teeth, internal, backlash):
    gear = gk.gear.StraightSidedGear(40, 3, 20, 0.8, 1.2)
    teeth = gear.cutter(0.3, backlash)
    mate = gk.conjugate(teeth, 40, gear.pitch_radius, mate_teeth, 2.0, internal)
    return gear.flank, mate, flank_table(mate, backlash)


def pins(mate_teeth, internal, backlash):
    pinion = gk.gear.LanternPinion(12, 4, 5.5)
    # A ring is touched by both quarters of a pin's side; a pin drawn out for clearance has its second one farther out.
    clearance, quarters = (0.0, 2) if internal else (0.5, 1)
    mate = gk.conjugate(pinion.cutter(clearance, backlash), 12, pinion.pitch_radius, mate_teeth, 4.0, internal)
    return pinion.pin, mate, pin_table(mate, quarters, backlash)


# Columns for a place on the tooth, touched or not.
SIDE = {"flank_share", "pin_angle", "tooth_x", "tooth_y"}
MATES = {
    "straight": lambda: straight(64, False, 0.0),
    "straight with play": lambda: straight(64, False, 0.3),
    "straight in a ring": lambda: straight(90, True, 0.2),
    "pins": lambda: pins(48, False, 0.0),
    "pins with play": lambda: pins(48, False, 0.4),
    "pins in a ring": lambda: pins(36, True, 0.2),
}


@pytest.mark.parametrize("name", by_default(MATES, slice(0, None, 2)))
def test_teeth_rotated_to_each_row_touch_and_slide_as_reported(name):
    side, mate, table = MATES[name]()
    found = columns(table)
    tooth, contact, other = (found[f"{w}_x"] + 1j * found[f"{w}_y"] for w in ("tooth", "contact", "mate_tooth"))
    assert gk.nearest(side, tooth)[1].max() < 1e-9
    pin = "pin_angle" in found
    where = found["pin_angle"] if pin else found["flank_share"]
    ends = (-90, 90 * mate.is_ring) if pin else (0, 1)
    assert (where[0], where[-1]) == ends and (np.diff(where) > 0).all()
    if pin:
        assert np.degrees(np.angle(tooth - 24j)) == pytest.approx(where, abs=1e-9)
    else:
        assert where == pytest.approx(np.abs(tooth - tooth[0]) / np.abs(tooth[-1] - tooth[0]), abs=1e-9)
    meets = np.isfinite(contact)
    assert 20 < meets.sum()
    assert all((np.isfinite(values) == meets).all() for column, values in found.items() if column not in SIDE)
    gear_angle, mate_angle = (np.radians(found[k]) for k in ("gear_angle", "mate_angle"))
    assert np.abs(tooth * np.exp(1j * gear_angle) - contact)[meets].max() < 1e-9
    axis = mate.pose.origin
    placed = axis + (mate.pose.place(other) - axis) * np.exp(1j * mate_angle)
    assert np.abs(placed - contact)[meets].max() < 1e-9
    # Both places are on the finished mate.
    assert gk.nearest(mate.outline, other[meets][::20])[1].max() < 1e-9
    # In the mesh the speeds differ along the flanks only: as seen from the mate.
    ratio = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    slides = 1j * contact - 1j * ratio * (contact - axis)
    inner = np.flatnonzero(meets)[2:-2]
    along = (tooth[inner + 1] - tooth[inner - 1]) * np.exp(1j * gear_angle[inner])
    along /= np.abs(along)
    speed = slides[inner] / along
    assert speed.real == pytest.approx(found["sliding"][inner], abs=1e-3)
    assert np.abs(speed.imag).max() < 1e-3 * np.abs(speed).max()
    lean = np.degrees(np.arccos(np.abs(along.imag)))
    assert lean == pytest.approx(found["pressure_angle"][inner], abs=1e-2)
