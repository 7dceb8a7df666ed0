"""The longest dwell of an output against a brute-force search over very many frames; Grashof's sums."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import grashof, longest_dwell

SIX_BAR = gk.StephensonSixBar(gk.FourBar(99, 30, 77, 95, 128 + 15j), 58.7, 60, 69 + 191j)


def longest_by_search(value: np.ndarray, band: float) -> int:
    """Steps of the longest window in which values keep within a band: window by window."""
    longest, start = 0, 0
    for end in range(len(value)):
        while np.ptp(value[start : end + 1]) > band:
            start += 1
        longest = max(longest, end - start)
    return longest


@pytest.mark.parametrize("band_deg", [0.05, 5.0])
@pytest.mark.parametrize("step_deg", [2.5])
def test_the_dwell_of_a_six_bar(band_deg: float, step_deg: float) -> None:
    motion = gk.move(SIX_BAR, np.radians(np.arange(0, 360 + step_deg / 2, step_deg)))
    found = longest_dwell(motion, "output", np.radians(band_deg))
    fine = gk.move(SIX_BAR, np.radians(np.arange(0, 540, 0.05)))
    seen = longest_by_search(np.degrees(np.unwrap(np.angle(fine.output.direction))), band_deg) * 0.05
    assert np.degrees(found.range) == pytest.approx(seen, abs=0.3)
    within = gk.move(SIX_BAR, np.linspace(found.start, found.end, 1000)).output.direction
    assert np.degrees(np.ptp(np.angle(within))) <= band_deg * (1 + 1e-4)
    assert 0 <= found.start < 2 * np.pi


def test_a_dwell_may_begin_in_one_turn_and_end_in_the_next() -> None:
    linkage = gk.SliderCrank(30, 90)
    found = longest_dwell(gk.move(linkage, np.linspace(0, 2 * np.pi, 361)), "slider", 1.0)
    # About the inner dead centre, at half a turn, where x is 60.
    x = 30 * np.cos(found.start) + np.sqrt(90**2 - 900 * np.sin(found.start) ** 2)
    assert x == pytest.approx(61, abs=1e-3) and (found.start + found.end) / 2 == pytest.approx(np.pi, abs=1e-3)
    later = longest_dwell(gk.move(linkage, np.linspace(np.pi, 3 * np.pi, 361)), "slider", 1.0)
    assert (later.start, later.end) == pytest.approx((found.start + 2 * np.pi, found.end + 2 * np.pi), abs=1e-3)
    assert later.start < 3 * np.pi < later.end


def test_open_frames_break_a_dwell() -> None:
    motion = gk.move(gk.FourBar(100, 80, 60, 50), np.linspace(0, 2 * np.pi, 721))
    found = longest_dwell(motion, "rocker", 10.0)
    assert not motion.assembled.all()
    assert gk.move(motion.linkage, np.linspace(found.start, found.end, 500)).assembled.all()


def test_falling_drives_have_the_dwell_of_rising_ones() -> None:
    four_bar = gk.FourBar(100, 30, 90, 70, 40 + 25j)
    linkage = gk.StephensonSixBar(four_bar, 120, 90, 100 + 100j)
    drive = np.linspace(0, 2 * np.pi, 361)
    rising = longest_dwell(gk.move(linkage, drive), "output", 0.03)
    for falling in (drive[::-1], drive[::-1] - 2 * np.pi):
        found = longest_dwell(gk.move(linkage, falling), "output", 0.03)
        assert found.range == pytest.approx(rising.range, abs=1e-9)
        assert np.exp(1j * found.start) == pytest.approx(np.exp(1j * rising.start), abs=1e-9)
        assert (found.low, found.high) == pytest.approx((rising.low, rising.high), abs=1e-9)


def test_refusals() -> None:
    motion = gk.move(gk.FourBar(100, 30, 100, 30), np.linspace(0.2, 3, 100))
    for output, band, field in (("ground", 0.1, "output"), ("coupler", 0.1, "output"), ("rocker", 0.0, "band")):
        with pytest.raises(gk.DesignError) as caught:
            longest_dwell(motion, output, band)
        assert caught.value.field == field


@pytest.mark.parametrize("band", [1e-7, 1e-4, 0.01])
@pytest.mark.parametrize("count", [37, 361])
def test_a_narrow_band_is_left_at_both_sides_of_a_dead_centre(band: float, count: int) -> None:
    """Crank and rod in line: x is least there, and the longest dwell has the band at its ends; solved for by hand."""
    motion = gk.move(gk.SliderCrank(30, 100), np.linspace(0, 2 * np.pi, count))
    found = longest_dwell(motion, "slider", band)
    low, high = 0.0, 0.5
    for _ in range(60):
        turn = (low + high) / 2
        away = -30 * np.cos(turn) + np.sqrt(100**2 - (30 * np.sin(turn)) ** 2) - 70
        low, high = (turn, high) if away < band else (low, turn)
    assert found.range == pytest.approx(2 * turn, rel=2e-2)
    assert (found.start + found.end) / 2 == pytest.approx(np.pi, abs=0.05 * found.range)


def test_grashof_sums_agree_with_the_links_that_turn_fully() -> None:
    rng = np.random.default_rng(5)
    for lengths in rng.uniform(20, 100, (200, 4)).tolist():
        if 2 * max(lengths) >= sum(lengths):
            continue
        linkage = gk.FourBar(*lengths)
        found = grashof(linkage)
        assert found.shortest_and_longest + found.other_two == pytest.approx(sum(lengths))
        assert found.shortest_and_longest == pytest.approx(min(lengths) + max(lengths))
        # With no room to spare no two neighbouring links turn fully against each other.
        a, b, c, d = (lengths[k] for k in (1, 2, 3, 0))
        turns = [
            abs(one - two) > abs(three - four) and one + two < three + four
            for one, two, three, four in ((a, d, b, c), (d, c, a, b), (a, b, c, d), (b, c, a, d))
        ]
        assert any(turns) == (found.spare > 0)
