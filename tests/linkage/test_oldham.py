"""An Oldham coupling: its slots cross at right angles, and its disc runs round a circle over both centres."""

import numpy as np
import pytest

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


@pytest.mark.parametrize("shift", [0.5, 6.0])
def test_the_disc_runs_twice_a_turn_round_a_circle_over_both_centres(shift):
    """Thales: seen from the disc's middle, both shafts lie at right angles."""
    drive = np.linspace(0, 2 * np.pi, 361)
    motion = gk.move(gk.OldhamCoupling(shift), drive)
    middle = motion.bodies["disc"].origin.position
    seen = (middle - 0j) * np.conj(middle - shift)
    far = np.abs(middle) * np.abs(middle - shift) > 1e-6 * shift**2
    assert np.abs(seen.real[far] / np.abs(seen[far])).max() < 1e-9
    assert np.abs(np.abs(middle - shift / 2) - shift / 2).max() < 1e-12 * shift
    # Twice a turn: the angle about the circle's middle goes round by two turns.
    about = np.unwrap(np.angle(middle - shift / 2))
    assert about[-1] - about[0] == pytest.approx(4 * np.pi)
    turned = [np.unwrap(np.angle(motion.bodies[b].direction)) for b in ("driving", "disc", "driven")]
    assert all(np.ptp(t - turned[0]) < 1e-12 for t in turned)
