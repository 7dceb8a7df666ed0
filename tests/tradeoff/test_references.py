"""The exact answers of families against other formulas, other readers, and the library's own motion."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane.vec import Pose
from geomkin.synthesis.path.nine_point_equations import cognates_of, rotations_of
from geomkin.tradeoff.families import lengths, searches
from geomkin.tradeoff.family import circling, coupler_point, exact
from geomkin.tradeoff.tool import Tool
from tests.linkage import exact as independent
from tests.tradeoff.measured import errors, found, problem

ANGLES = np.array([0.7, 4.4])


def test_decimals_agree_with_the_loop_equations_of_another_derivation():
    track, at = problem("four-bar-position"), (0, 45, 200)
    for k in at:
        right = independent.four_bar(100, 30, 90, 70, float(track.drive[k]), 1)
        assert track.right[:, k] == pytest.approx(right[0], rel=1e-15)
        assert [track.first[:, k], track.second[:, k]] == pytest.approx(np.array(right[1:]), rel=1e-14)
        slider = independent.slider_crank(30, 90, 10, float(track.drive[k]), 1)
        assert problem("slider-crank-position").right[k] == pytest.approx(slider[0][1], rel=1e-14)


def test_rates_of_a_coupler_point_are_those_of_the_moving_linkage():
    places = exact(lambda angle: coupler_point((100, 30, 90, 70), 40 + 25j, angle, -1), ANGLES)
    point = gk.move(gk.FourBar(100, 30, 90, 70, 40 + 25j), ANGLES, -1).point("coupler_point")
    for ours, right in zip(places, (point.position, point.first, point.second)):
        assert ours == pytest.approx(right, rel=1e-12)


def test_cosine_and_sine_have_all_their_digits():
    with localcontext() as context:
        context.prec = 110
        for angle in (Decimal("0.5"), Decimal("-7.25"), Decimal(30)):
            z = circling(1, angle)
            assert abs(z.square - 1) < Decimal(10) ** -90
            assert complex(z.real, z.imag) == pytest.approx(np.exp(1j * float(angle)), abs=1e-15)


def test_clearance_of_a_roller_on_a_circle_and_of_a_square_that_slides():
    z = np.array([3, 20, 39.9, 40, 41, 59]) * np.exp(1j * np.arange(6))
    roller = Tool(np.array([0j]), 10.0, lambda t: Pose(50 * np.exp(1j * t), np.exp(7j * t)), (0.0, 2 * np.pi))
    assert roller.clearance(z) == pytest.approx(np.abs(np.abs(z) - 50) - 10, abs=1e-12)
    # A square of 2 mm, rounded by 0.5, that moves 10 mm along +x.
    corners = np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])
    square = Tool(corners, 0.5, lambda t: Pose(t + 0j, np.ones(t.shape, complex)), (0.0, 10.0))
    z = np.array([5 + 3j, 5 + 1.5j, 15 + 0j, 12 + 2j, -4 - 4j, 5 + 1j])
    off = [1.5, 0, 3.5, np.sqrt(2) - 0.5, np.hypot(3, 3) - 0.5, -0.5]
    assert square.clearance(z) == pytest.approx(off, abs=1e-12)


def test_the_rack_cuts_an_undercut_tooth_at_its_known_radius():
    """Cut-in radius of 12 teeth of module 2: below it the involute is gone, above it the rack touches it."""
    tool, gear = problem("gear-root"), gk.SpurGear(12, 2)
    half = (np.pi / 2) / 12 + np.tan(np.radians(20)) - np.radians(20)
    radius = np.array([11.29, 11.302702044909595, 11.5, 13.9])
    roll = np.sqrt((radius / gear.base_radius) ** 2 - 1)
    off = tool.clearance(radius * 1j * np.exp(-1j * (half - (roll - np.arctan(roll)))))
    assert off[0] < -1e-5 and off[1:] == pytest.approx(0, abs=1e-12)
    # And the root circle is as deep as the rack.
    assert tool.clearance(gear.root_radius * 1j * np.exp([-1j * np.pi / 12]))[0] == pytest.approx(0, abs=1e-12)


def test_polygons_of_a_tool_are_the_tool():
    tool = problem("gear-root")
    for polygon, t in zip(tool.polygons(5, 0.01), np.linspace(*tool.span, 5)):
        assert np.abs(tool.distance(polygon, np.full(len(polygon), t))).max() < 1e-12
        edge = np.roll(polygon, -1) - polygon
        assert (np.imag(np.conj(edge) * np.roll(edge, -1)) > -1e-9).all()  # convex, counterclockwise
    assert len(problem("cam-profile").polygons(2, 0.5)[0]) >= 2 * np.pi * 10 / 0.5


def test_deviation_of_tolerances_is_the_limit_of_random_linkages():
    """Within the scatter of a quantile of so many."""
    slope = 2 * np.exp(-4.5) / np.sqrt(2 * np.pi)
    linkages, beyond = 20_000, lengths.BEYOND
    scatter = np.sqrt(beyond * (1 - beyond) / linkages) / slope / 3
    off = errors("tolerance", found("tolerance", "Monte Carlo", linkages)) / problem("tolerance").right
    assert off.max() < 5 * scatter and off.mean() > 0.1 * scatter


@pytest.mark.parametrize(
    ("method", "setting", "least", "most"),
    [
        # The second derivatives that both leave out, of the order of tolerance squared over length squared.
        ("linearised (geomkin.tolerances)", np.nan, 1e-9, 1e-7),
        ("differences", 0.1, 1e-9, 1e-7),
        ("differences", 10.0, 1e-6, 1e-4),
    ],
)
def test_linearised_deviations_are_near_the_reference(method, setting, least, most):
    assert least < errors("tolerance", found("tolerance", method, setting)).max() < most


def test_linkages_by_hand_meet_their_precision_points():
    made = searches.by_hand(np.radians([[45.0, 30.0], [100.0, 60.0]]))
    s = 0.5 - 0.5 * np.cos((np.arange(3) + 0.5) * np.pi / 3)
    off = np.abs(searches.structural_error(made, s)).reshape(2, 2, 3)
    # The equations do not know the assembly mode: each point is met by one, and the second linkage stays on it.
    assert off.min(axis=0) == pytest.approx(0, abs=1e-12) and off[:, 1].max(axis=-1).min() < 1e-12


def test_errors_of_functions_and_paths_are_those_of_the_moving_linkage():
    s = np.linspace(0, 1, 7)
    moved = gk.move(gk.FourBar(100, 60, 110, 90), 1.0 + np.radians(60) * s, -1).rocker.direction
    off = np.angle(moved * np.exp(-1j * (2.0 + np.radians(90) * np.log2(1 + s))))
    sizes = np.array([0.6, 1.1, 0.9, 1.0, 2.0, -1.0])
    assert searches.structural_error(sizes, s) == pytest.approx(off, abs=1e-12)
    rows = found("path-synthesis", "fits alone", 100)
    *lengths, x, y, x_0, y_0, angle, start, branch = rows[0].tolist()
    lengths, origin = (searches.SIZE * np.array(lengths)).tolist(), searches.SIZE * complex(x_0, y_0) + searches.MIDDLE
    point, turned = searches.SIZE * complex(x, y), float(np.degrees(angle) % 360)
    bar = gk.FourBar(*lengths, point, origin=origin, ground_angle_deg=turned)
    at = gk.move(bar, start + np.radians(20) * np.arange(18), int(branch)).point("coupler_point").position
    rms = np.sqrt(np.mean(np.abs(at - searches.TIMED) ** 2))
    off = errors("path-synthesis", np.array([rows[0], np.full(11, np.nan)]))
    assert off == pytest.approx([rms, np.nan], abs=1e-12, nan_ok=True)


@pytest.mark.parametrize("seed", range(2))
def test_the_chosen_four_bar_has_the_least_error_within_the_limits(seed):
    numbers = np.random.default_rng(seed)
    lengths = 10 ** numbers.uniform(-1.2, 0.6, (3, 120))
    rows = np.concatenate([lengths, numbers.uniform(0, 2 * np.pi, (2, 120)), numbers.choice([-1.0, 1.0], (1, 120))])
    shares, known = np.linspace(0, 1, searches.FEW.size), {}
    for k, (a, b, c, start, output_start, branch) in enumerate(rows.T.tolist()):
        try:
            motion = gk.move(gk.FourBar(1.0, a, b, c), start + np.radians(60) * shares, int(branch))
        except gk.DesignError:
            continue
        if motion.assembled.all():
            right = np.exp(1j * (output_start + np.radians(90) * np.log2(1 + shares)))
            least = np.degrees(np.min(motion.transmission_angle))
            ratio = max(1.0, a, b, c) / min(1.0, a, b, c)
            known[k] = (np.abs(np.angle(motion.rocker.direction / right)).max(), least >= 30, ratio <= 10)
    kept = [k for k, (_, *limits) in known.items() if all(limits)]
    best = min(kept, key=lambda k: known[k][0])
    assert searches.best_within_limits(rows) == pytest.approx(rows[:, best])
    # Each limit excludes some.
    assert all(any(not row[which] for row in known.values()) for which in (1, 2))
    others = np.delete(np.arange(120), kept)
    assert np.isnan(searches.best_within_limits(rows[:, others])).all()


@pytest.mark.campaign
def test_cognates_count_once_and_wrong_linkages_not_at_all():
    points = searches.POINTS
    rows = found("nine-points", "some of the paths", 150)
    (missed,) = searches.missed_share(points, rows)
    assert 0.8 < missed < 1 and round(searches.KNOWN * (1 - missed)) == len(rows)
    size = np.sqrt(np.mean(np.abs(points[1:] - points[0]) ** 2))
    offsets = (points - points[0])[1:] / size
    target = np.broadcast_to(np.concatenate([offsets, np.conj(offsets)]), (len(rows), 16))
    places = (rows.view(complex) - points[0]) / size
    dyads = np.stack([places, np.conj(places)], axis=2).reshape(-1, 8)
    pairs = cognates_of(np.concatenate([dyads, rotations_of(dyads, target)], axis=1), target)
    cognates = [(pair[:, 0:8:2] * size + points[0]).copy().view(float) for pair in pairs]
    together = np.concatenate([rows, rows[:, [4, 5, 6, 7, 0, 1, 2, 3]], *cognates, rows * 1.001])
    for linkages in (together, *cognates):
        assert searches.missed_share(points, linkages) == pytest.approx(missed)
    assert searches.missed_share(points, np.empty((0, 8))) == 1


@pytest.mark.campaign
def test_continuation_finds_all_and_other_searches_few():
    assert errors("nine-points", found("nine-points", "continuation (path_generator)")) == 0
    for method, setting in (("Newton from random linkages", 3e3), ("path search", 1)):
        assert 0.5 < errors("nine-points", found("nine-points", method, setting)) <= 1
