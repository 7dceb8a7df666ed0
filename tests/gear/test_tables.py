"""Tables of teeth and contact, row by row: turned flanks that meet, speeds by differences, places on outlines."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear import contact_table, tooth_table

CONTACTS = {
    "pair": lambda: gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(40, 2, 0.3)),
    "high ratio": lambda: gk.GearPair(*2 * [gk.SpurGear(60, 2, 0, gk.gear.RackCutter(14.5, 1.25, 1.5, 0.1))]),
    "ring": lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=0.8)),
    "rack": lambda: gk.gear.RackPair(gk.SpurGear(18, 2), gk.gear.GearRack(12, 2)),
}


def columns(table):
    return {column.name: np.asarray(column.values) for column in table.columns}


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
}


@pytest.mark.parametrize("name", TEETH)
def test_half_a_tooth_goes_outwards_along_the_outline(name):
    gear, tolerance = TEETH[name](), 1e-3
    found = columns(tooth_table(gear, tolerance))
    z = found["tooth_x"] + 1j * found["tooth_y"]
    assert gk.nearest(gear.outline.piece, z)[1].max() < 1e-9
    assert (np.diff(np.abs(z)) > 0).all() and (found["radius"] == np.abs(z)).all()
    assert found["half_thickness_angle"] == pytest.approx(np.degrees(np.arctan(z.real / z.imag)))
    ends = sorted([gear.root_radius, gear.tip_radius])
    assert (found["radius"][0], found["radius"][-1]) == pytest.approx(ends, rel=1e-9)
    region = found["region"].tolist()
    order = ["involute", "root"] if name == "ring" else ["root", "involute"] + ["tip"] * (gear.tip_edge is not None)
    assert list(dict.fromkeys(region)) == order
    # A joint is told once, with what comes before it.
    flank = np.abs(gear.flank.point(gear.flank.breaks[[0, -1]]))
    inside = (found["radius"] < flank.max() * (1 - 1e-9)) & (found["radius"] > flank.min() * (1 + 1e-9))
    assert set(found["region"][inside]) == {"involute"}
    # No chord leaves its arc by more than the tolerance; half of it would take more rows.
    middles = 0.5 * (z[1:] + z[:-1])
    assert gk.nearest(gear.outline.piece, middles)[1].max() <= tolerance
    assert len(columns(tooth_table(gear, tolerance / 100))["radius"]) > 5 * len(z)
