"""Contacts of flanks that touch in places, in pieces, or several times at once, by plain interpolation."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.scene_pairs import _Touching

NAN = np.nan
# Of 6 teeth a pitch is 60 deg; each of the mate's degrees is half a one of the gear, the other way.
PIECES = [NAN, -20, -60, -100, NAN, -30, NAN, -80, -120, NAN, NAN, -160, -200, -210]


def touching(angles, ratio=-2.0, teeth=6):
    k = np.arange(float(len(angles)))
    columns = {"mate_angle": np.array(angles, dtype=float), "contact_x": 10 * k, "contact_y": k**2}
    return _Touching(gk.Table(tuple(gk.Column(name, "", "", row) for name, row in columns.items())), ratio, teeth)


def test_paths_of_contact_are_in_as_many_pieces_as_have_two_places():
    found = [np.asarray(path.vertices) for path in touching(PIECES).paths()]
    wanted = [[1, 2, 3], [7, 8], [11, 12, 13]]
    assert len(found) == 3
    for piece, run in zip(found, wanted):
        assert piece == pytest.approx(10 * np.array(run) + 1j * np.array(run) ** 2)
    assert not list(touching([NAN, 3, NAN]).paths()) and not list(touching([NAN, NAN]).paths())
    assert len(list(touching([1, 2, 3]).paths())) == 1


def test_a_flank_touches_from_the_first_to_the_last_of_its_turns():
    one = touching(PIECES)
    assert one.pitch == pytest.approx(np.pi / 3)
    assert one.first == pytest.approx(np.radians(10)) and one.pitches == pytest.approx((105 - 10) / 60)
    none = touching([NAN, NAN])
    assert (none.first, none.pitches) == (0, 0)


def test_where_it_touches_is_between_the_places_of_the_table():
    """Turns of 10 to 50 deg, and of 40 to 60 deg in another place: from 40 to 50 deg in both."""
    one = touching(PIECES)
    turn = np.array([10.0, 12.5, 30, 39.9, 40.1, 45, 50.1, 59.9, 60.1, 79, 80.1, 100.1, 104.9, 106])
    values = 10 * np.arange(14.0) + 3j
    found = one.at((turn - 10) / 60, values)
    assert found.shape == (2, len(turn))
    runs = [((10, 30, 50), (1, 2, 3)), ((40, 60), (7, 8)), ((80, 100, 105), (11, 12, 13))]
    for at, row in zip(turn, found.T):
        wanted = [10 * np.interp(at, turns, places) + 3j for turns, places in runs if turns[0] <= at < turns[-1]]
        assert row[np.isfinite(row)] == pytest.approx(wanted)
    nothing = touching([NAN, NAN]).at(np.array([0.0, 0.5]), np.zeros(2))
    assert nothing.shape == (1, 2) and np.isnan(nothing).all()
