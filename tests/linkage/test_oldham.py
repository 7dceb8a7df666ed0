"""An Oldham coupling: its slots cross at right angles, and its disc runs round a circle over both centres."""

import numpy as np

import geomkin as gk


def test_the_disc_s_tongues_and_the_hubs_slots_stand_at_right_angles():
    """As they are cut: guide pins of the disc on two crossing lines, a hub's slots along the line of its own pins."""
    recipe = gk.load("recipes/oldham-coupling.toml")
    plates = {part.name: part for part in recipe.parts}
    pins = np.array([hole.centre for hole in plates["disc"].holes])
    assert len(pins) == 4
    first, second = pins[:2], pins[2:]
    assert abs(first.sum()) < 1e-9 and abs(second.sum()) < 1e-9
    across = (first[1] - first[0]) * np.conj(second[1] - second[0])
    assert abs(across.real) < 1e-12 * abs(across)
    for hub, places in (("driving", first), ("driven", second)):
        slots = [hole for hole in plates[hub].holes if not isinstance(hole, gk.plane.Circle)]
        assert len(slots) == 2
        for slot, place in zip(slots, places):
            along = slot.point(1.5) - slot.point(1.1), slot.point(3.5) - slot.point(3.1)
            for side in along:
                assert abs((side * np.conj(place)).imag) < 1e-9 * abs(side * place)
