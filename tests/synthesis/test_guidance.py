"""Linkages through poses: known ones given back, and each one found moved through its poses, step by step."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import body_guides
from tests.campaign import by_default

KINDS = ("four-bar", "crank-slider", "slider-crank", "elliptic-trammel")
THREE = [(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)]


def random_poses(rng, count, spread=np.pi):
    return [(complex(*rng.uniform(0, 100, 2)), float(rng.uniform(-spread, spread))) for _ in range(count)]


def poses_of(linkage, drive, branch=1, turned=0.3):
    """Poses of a body on the coupler, its origin at the coupler point."""
    motion = gk.move(linkage, drive, branch)
    coupler = motion.bodies["rod" if "rod" in motion.linkage.bodies else "coupler"]
    point = motion.point("rod_point" if "rod" in motion.linkage.bodies else "coupler_point").position
    return list(zip(point.tolist(), (np.angle(coupler.direction) + turned).tolist()))


def check(guide, poses):
    """Move it through all of its way in small steps: it meets the poses in order and never opens or jumps."""
    origins, directions = (np.array(part) for part in zip(*((z, np.exp(1j * t)) for z, t in poses)))
    size = np.ptp(np.abs(origins - origins[0])) + np.abs(guide.linkage.linkage.size)
    body = "rod" if "rod" in guide.linkage.linkage.bodies else "coupler"
    ways = np.concatenate([np.linspace(a, b, 200, endpoint=False) for a, b in zip(guide.drive, guide.drive[1:])])
    motion = gk.move(guide.linkage, np.append(ways, guide.drive[-1]), guide.branch)
    places, turns = motion.point(f"{body}_point").position, motion.bodies[body].direction
    body_turns = turns * np.exp(1j * np.radians(guide.body_angle_deg))
    met = (np.abs(places[::200] - origins) <= 1e-9 * size) & (np.abs(body_turns[::200] - directions) <= 1e-9)
    steps = np.diff(guide.drive)
    goes = bool(motion.assembled.all() and met.all() and ((steps > 0).all() or (steps < 0).all()))
    assert goes == (not guide.defects), (guide.linkage, guide.defects)
    if goes:
        # The turn between frames stays small, or it has jumped to the other branch.
        assert np.abs(np.angle(turns[1:] * np.conj(turns[:-1]))).max() < 0.5
        least = np.degrees(gk.least_transmission_angle(motion))
        assert guide.transmission_angle_deg <= least + 1e-6 and guide.transmission_angle_deg > least - 0.5
    if "circuit" in guide.defects or "branch" in guide.defects:
        assert np.isnan(guide.transmission_angle_deg)
    assert guide.pose_error <= 1e-9 * size


@pytest.mark.parametrize("kind", by_default(KINDS, KINDS[:3]))
def test_every_linkage_through_three_poses_goes_through_them(kind):
    rng = np.random.default_rng(11)
    sound = 0
    for _ in range(2):
        # Within a half turn, which a slide's rod cannot leave.
        poses = random_poses(rng, 3, 1.5)
        try:
            found = body_guides(poses, kind)
        except gk.DesignError as error:
            assert error.field == "poses" and kind == "elliptic-trammel"
            continue
        defects = [bool(guide.defects) for guide in found]
        assert defects == sorted(defects)
        angles = [guide.transmission_angle_deg for guide in found if not guide.defects]
        assert all(a >= b - 0.01 for a, b in zip(angles, angles[1:]))
        for guide in found:
            assert guide.kind == kind
            check(guide, poses)
        sound += not defects[0]
    assert sound >= (0 if kind == "elliptic-trammel" else 1)


KNOWN = gk.FourBar(100, 35, 90, 70, coupler_point=40 + 30j, origin=10 + 5j, ground_angle_deg=20)


def has(found, known, drive):
    """Whether one of those found is the linkage, by its lengths and place."""
    sizes = np.array([known.ground, known.crank, known.coupler, known.rocker])
    for guide in found:
        got = guide.linkage
        if isinstance(got, gk.FourBar):
            at = np.array([got.ground, got.crank, got.coupler, got.rocker])
            turned = np.abs(np.exp(1j * (drive - guide.drive)) - 1).max()
            if np.allclose(at, sizes, rtol=1e-6) and abs(got.origin - known.origin) < 1e-6 and turned < 1e-6:
                assert abs(got.coupler_point - known.coupler_point) < 1e-5
                return not guide.defects
    raise AssertionError("the known linkage is not among them")


def test_three_poses_of_a_known_linkage_and_its_points_give_it_back():
    drive = np.array([0.4, 1.1, 2.3])
    poses = poses_of(KNOWN, drive)
    # The pins in the body's frame, which is turned by 0.3 rad on the coupler.
    pins = tuple(complex(z) for z in (np.array([0, 90]) - KNOWN.coupler_point) * np.exp(-0.3j))
    (first,) = body_guides(poses, moving_points=pins)
    assert has([first], KNOWN, drive) and first.pins == pytest.approx(pins)
    found = body_guides(poses, moving_points=pins, driving_point="either")
    assert has(found, KNOWN, drive) and len(found) == 2
    assert {tuple(np.round(guide.pins, 6)) for guide in found} == {tuple(np.round(p, 6)) for p in (pins, pins[::-1])}
    assert found[0].body_angle_deg == pytest.approx(np.degrees(0.3)) or found[1].body_angle_deg == pytest.approx(
        np.degrees(0.3)
    )
    pivots = KNOWN.origin, KNOWN.origin + 100 * np.exp(1j * np.radians(20))
    assert has(body_guides(poses, fixed_points=pivots), KNOWN, drive)
    for guide in found:
        check(guide, poses)
    # Of a slider-crank: its slider pin slides, and stays where it is.
    slider = gk.SliderCrank(30, 80, 10, 20 + 15j, origin=3 + 4j, ground_angle_deg=30)
    poses = poses_of(slider, drive, turned=0.0)
    back = body_guides(poses, "crank-slider", moving_points=(-20 - 15j, 60 - 15j))
    assert len(back) == 1 and back[0].linkage.crank == pytest.approx(30) and back[0].linkage.offset == pytest.approx(10)
    assert back[0].linkage.origin == pytest.approx(3 + 4j) and back[0].linkage.coupler == pytest.approx(80)
    assert back[0].pins == pytest.approx((-20 - 15j, 60 - 15j))
    # Driven by its slider, whose pin then comes first.
    back = body_guides(poses, "slider-crank", moving_points=(60 - 15j, -20 - 15j))
    assert len(back) == 1 and back[0].linkage.crank == pytest.approx(30) and back[0].linkage.driver == "slider"
    assert back[0].pins == pytest.approx((60 - 15j, -20 - 15j))


def test_five_poses_of_random_known_linkages_give_them_back():
    rng = np.random.default_rng(8)
    for _ in range(25):
        ground, crank, coupler, rocker = rng.uniform(30, 100, 4)
        try:
            known = gk.FourBar(
                ground,
                crank,
                coupler,
                rocker,
                complex(*rng.uniform(-80, 80, 2)),
                origin=complex(*rng.uniform(-50, 50, 2)),
                ground_angle_deg=float(rng.uniform(-180, 180)),
            )
        except gk.DesignError:
            continue
        low, high = max(gk.driver_limits(known), key=lambda part: part[1] - part[0])
        drive = np.sort(low + (high - low) * (0.1 + 0.8 * rng.random(5)))
        if np.diff(drive).min() < 0.05:
            continue
        poses = poses_of(known, drive)
        assert has(body_guides(poses), known, drive)


def test_five_poses_of_a_slider_crank_give_it_back_and_each_found_goes_through():
    drive = np.array([0.2, 0.8, 1.3, 2.0, 2.6])
    known = gk.SliderCrank(30, 80, 10, 20 + 15j)
    poses = poses_of(known, drive)
    found = body_guides(poses)
    back = [guide for guide in found if guide.kind == "crank-slider" and abs(guide.linkage.crank - 30) < 1e-6]
    assert len(back) == 1 and not back[0].defects and back[0].linkage.coupler == pytest.approx(80)
    driven = [guide for guide in found if guide.kind == "slider-crank" and abs(guide.linkage.crank - 30) < 1e-6]
    assert len(driven) == 1 and driven[0].linkage.driver == "slider"
    for guide in found:
        check(guide, poses)


@pytest.mark.campaign
def test_four_poses_have_linkages_as_good_as_the_known_one():
    rng = np.random.default_rng(4)
    for _ in range(1):
        drive = np.sort(rng.uniform(0.3, 3, 4))
        poses = poses_of(KNOWN, drive)
        known = np.degrees(gk.least_transmission_angle(gk.move(KNOWN, np.linspace(drive[0], drive[-1], 500))))
        found = body_guides(poses, "four-bar", region=(-150 - 150j, 250 + 250j))
        assert found[0].transmission_angle_deg > known - 1
        for guide in found:
            check(guide, poses)
    # A slide among the four poses' dyads: its own linkage comes back.
    known = gk.SliderCrank(30, 80, 10, 20 + 15j)
    poses = poses_of(known, np.array([0.2, 0.8, 1.3, 2.0]))
    found = body_guides(poses, "crank-slider")
    assert all(guide.linkage.offset is not None and len(guide.drive) == 4 for guide in found)
    for guide in found:
        check(guide, poses)


def test_more_poses_are_met_by_least_squares_and_it_is_said_by_how_much():
    rng = np.random.default_rng(6)
    drive = np.array([0.4, 0.8, 1.2, 1.7, 2.1, 2.6, 3.0])
    exact = body_guides(poses_of(KNOWN, drive))
    assert has(exact[:1], KNOWN, drive) and exact[0].pose_error < 1e-9
    shaken = [(z + complex(*rng.normal(0, 0.05, 2)), t) for z, t in poses_of(KNOWN, drive)]
    found = body_guides(shaken)
    assert 1e-3 < found[0].pose_error < 0.5 and not found[0].defects
    # The motion agrees with the reported values.
    moved = gk.move(found[0].linkage, found[0].drive, found[0].branch).point("coupler_point").position
    assert np.abs(moved - [z for z, _ in shaken]).max() == pytest.approx(found[0].pose_error, rel=1e-9)


@pytest.mark.campaign
def test_parallel_poses_are_met_by_parallelograms_and_two_of_them_by_anything():
    parallel = [(0j, 0.2), (40 + 0j, 0.2), (60 + 30j, 0.2)]
    for guide in body_guides(parallel):
        assert guide.linkage.ground == pytest.approx(guide.linkage.coupler)
        if not guide.defects:
            check(guide, parallel)
    two = [(0j, 0.2), (40 + 0j, 0.2), (60 + 30j, 0.5)]
    found = body_guides(two, "crank-slider")
    assert not found[0].defects
    for guide in found:
        check(guide, two)
    # More of them, if their origins are on a circle.
    five = [(50 * complex(np.cos(t), np.sin(t)), 0.1) for t in np.radians([0, 30, 70, 100, 130])]
    found = body_guides(five)
    assert not found[0].defects and found[0].linkage.crank == pytest.approx(50)
    for guide in found:
        if not guide.defects:
            check(guide, five)
    with pytest.raises(gk.DesignError):
        body_guides([*five, (0j, 0.1)])
    # Along one line without turning nothing but slides along it goes.
    with pytest.raises(gk.DesignError):
        body_guides([(0j, 0.2), (40 + 0j, 0.2), (60 + 0j, 0.2)])


@pytest.mark.campaign
def test_the_search_is_the_same_for_a_seed_and_for_any_size():
    one, other = body_guides(THREE, seed=5), body_guides(THREE, seed=5)
    assert [g.linkage for g in one] == [g.linkage for g in other]
    for scale in (1e-6, 1e6):
        far = body_guides([(scale * z, t) for z, t in THREE], seed=5)
        assert far[0].transmission_angle_deg == pytest.approx(one[0].transmission_angle_deg, abs=0.2)
        assert far[0].pose_error < 1e-9 * 100 * scale
    # Whatever the seed, about as good.
    assert np.ptp([body_guides(THREE, seed=k)[0].transmission_angle_deg for k in range(2)]) < 0.3


def test_limits_are_kept():
    for guide in body_guides(THREE, least_transmission_angle_deg=60, largest_ratio=3, region=(-60 - 60j, 120 + 120j)):
        assert guide.ratio <= 3 and (guide.defects or guide.transmission_angle_deg >= 60)
        pins = [
            gk.move(guide.linkage, guide.drive, sign).point(pin).position
            for pin in ("crank_pin", "rocker_pin")
            for sign in (1, -1)
        ]
        places = [guide.linkage.origin, *(pins[0] if not guide.defects else ())]
        assert all(-60.001 <= z.real <= 120.001 and -60.001 <= z.imag <= 120.001 for z in places)
    short = body_guides(THREE, time_limit=0)
    assert short[0].cut_short and not short[0].defects and not body_guides(THREE)[0].cut_short


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"poses": THREE[:2]}, "poses"),
        ({"poses": [*THREE, THREE[0]]}, "poses"),
        ({"poses": [(0j, 0.1), (0j, 0.2), (0j, 0.4)]}, "poses"),
        ({"poses": THREE, "kind": "six-bar"}, "kind"),
        ({"poses": THREE, "region": (1 + 1j, 0j)}, "region"),
        ({"poses": THREE, "region": (1j, 1 + 1.1j)}, "poses"),
        ({"poses": THREE, "moving_points": (1j, 2j), "fixed_points": (1j, 2j)}, "fixed_points"),
        ({"poses": THREE, "fixed_points": (1j, 2j), "kind": "crank-slider"}, "fixed_points"),
        ({"poses": THREE, "moving_points": (1j, 1j)}, "poses"),
        ({"poses": THREE, "least_transmission_angle_deg": 95}, "least_transmission_angle_deg"),
        ({"poses": [(0j, "a"), *THREE]}, "poses"),
    ],
)
def test_invalid_requests_are_refused(asked, field):
    with pytest.raises(gk.DesignError) as refusal:
        body_guides(**asked)
    assert refusal.value.field == field
