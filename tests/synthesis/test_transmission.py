"""The least transmission angle on a way, in closed form, against angles of the links at very fine steps."""

import numpy as np
import pytest

from geomkin.synthesis.guidance import guides

STEPS = 1501


def acute(one, other):
    """Between two directions, each either way."""
    angle = np.abs(np.angle(one / other))
    return np.minimum(angle, np.pi - angle)


def ways(rng, count, reach):
    """Starts and ends of drives, and steps from one to the other, (steps, count)."""
    start, end = rng.uniform(-reach, reach, (2, count))
    return start, end, start + np.linspace(0, 1, STEPS)[:, None] * (end - start)


def least_of(angle, closed):
    """The least of those that close all the way; nan of others, and of what nearly opens, where steps are too coarse."""
    return np.where(closed.all(axis=0) & (angle.min(axis=0) > 0.15), angle.min(axis=0), np.nan)


def compared(reported, least):
    met = np.isfinite(least)
    assert met.sum() > 60
    assert reported[met] == pytest.approx(least[met], abs=2e-3)
    # The steps may miss the least place by a little, and never go below it.
    assert (reported[met] <= least[met] + 1e-9).all()


def test_of_four_bars():
    rng = np.random.default_rng(1)
    ground, crank, coupler, rocker = rng.uniform(20, 100, (4, 800))
    start, end, turn = ways(rng, 800, 5.0)
    pin = crank * np.exp(1j * turn)
    # From the crank pin to the rocker's pivot; the rocker pin stands on it as on the base of a triangle.
    base = ground - pin
    along = (np.abs(base) ** 2 + coupler**2 - rocker**2) / (2 * np.abs(base))
    high = coupler**2 - along**2
    at = pin + base / np.abs(base) * (along + 1j * np.sqrt(np.maximum(high, 0)))
    least = least_of(acute(at - pin, at - ground), high > 0)
    compared(guides.four_bar_transmission(ground, crank, coupler, rocker, start, end), least)


def test_of_slider_cranks():
    rng = np.random.default_rng(2)
    crank, coupler, offset = rng.uniform(10, 60, 400), rng.uniform(60, 150, 400), rng.uniform(-60, 60, 400)
    start, end, turn = ways(rng, 400, 5.0)
    pin = crank * np.exp(1j * turn)
    across = (offset - pin.imag) / coupler
    rod = np.sqrt(np.maximum(1 - across**2, 0)) + 1j * across
    # The slider is driven by the rod best where it lies along the slide line: from the normal, a right angle.
    compared(
        guides.slider_crank_transmission(crank, coupler, offset, start, end),
        least_of(acute(rod, 1j), np.abs(across) < 1),
    )


def test_of_driving_slides():
    rng = np.random.default_rng(3)
    crank, coupler, offset = rng.uniform(20, 100, (3, 800))
    offset *= rng.choice([-1, 1], 800)
    start, end, place = ways(rng, 800, 150.0)
    slider = place + 1j * offset
    along = (np.abs(slider) ** 2 + crank**2 - coupler**2) / (2 * np.abs(slider))
    high = crank**2 - along**2
    pin = slider / np.abs(slider) * (along + 1j * np.sqrt(np.maximum(high, 0)))
    least = least_of(acute(pin, slider - pin), high > 0)
    compared(guides.driving_slide_transmission(crank, coupler, offset, start, end), least)


def test_of_driving_shuttles():
    rng = np.random.default_rng(4)
    rod, slots = rng.uniform(20, 100, 900), rng.uniform(0.2, np.pi - 0.2, 900)
    start, end, place = ways(rng, 900, 100.0)
    # The second shuttle, on a slot through 0: where the rod's end meets it.
    slot = np.exp(1j * slots)
    foot = (place * np.conj(slot)).real
    high = rod**2 - np.abs(place - foot * slot) ** 2
    other = slot * (foot + np.sqrt(np.maximum(high, 0)))
    least = least_of(acute(other - place, 1j * slot), high > 0)
    compared(guides.driving_shuttle_transmission(rod, np.sin(slots), start, end), least)


def test_the_acute_angle_of_a_triangle():
    rng = np.random.default_rng(5)
    corner, angle = rng.uniform(1, 9, (2, 500)), rng.uniform(0.01, np.pi - 0.01, 500)
    across = np.abs(corner[0] - corner[1] * np.exp(1j * angle))
    reported = guides.acute_at(*corner, across)
    assert reported == pytest.approx(np.minimum(angle, np.pi - angle), abs=1e-7)
    # Beyond what they reach, and where they fold or stretch, nothing is left.
    assert (guides.acute_at(3.0, 5.0, np.array([1.0, 2.0, 8.0, 9.0])) == 0).all()
