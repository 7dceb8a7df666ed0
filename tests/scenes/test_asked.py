"""Scenes as a script asks for them, without parts and with what recipes leave out, and scenes that are not always there."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.scene_instants import inflection_scene
from tests.cam.cams import CAMS

from .gallery import marks, named, recipe


def scene_of(cam, **more):
    return gk.cam.cam_scene(cam, gk.cam.cam_table(cam, 10.0, np.radians(np.arange(0, 361, 3.0))), **more)


@pytest.mark.parametrize("name", CAMS)
def test_a_cam_by_itself_shows_the_follower_in_lines(name):
    cam = CAMS[name]
    scene, follower = scene_of(cam), cam.follower
    (contact,) = marks(scene, "point", "contact")
    pins = {mark.label: mark.place for mark in scene.marks if mark.sort.endswith("pin")}
    assert ("pivot" in pins) == follower.oscillates and ("roller" in pins) == bool(follower.roller_radius)
    assert scene.cyclic and scene.assembled.all() and not any(body.parts for body in scene.bodies)
    if follower.roller_radius:
        # Where it touches is a roller's radius from its centre, all the time.
        assert np.abs(pins["roller"] - contact.place) == pytest.approx(np.full(121, follower.roller_radius))
    if follower.oscillates:
        (arm,) = marks(scene, "line", "arm")
        assert (arm.place == pins["pivot"]).all() and not marks(scene, "slide")
        if follower.roller_radius:
            assert np.abs(arm.place + arm.vector - pins["roller"]).max() < 1e-9
    else:
        (stem,), (guide,) = marks(scene, "line", "follower"), marks(scene, "slide", "guide")
        way = stem.vector / np.abs(stem.vector)
        # The stem goes along itself through the guide, which stands still, and never leaves it.
        assert np.ptp(guide.place.real) == np.ptp(guide.place.imag) == 0 and np.abs(way - way[0]).max() < 1e-12
        share = np.real((guide.place - stem.place) / stem.vector)
        assert 0 < share.min() and share.max() < 1
        assert np.abs(np.imag((guide.place - stem.place) / way)).max() < 1e-9


def test_undercut_is_found_where_it_is_not_told():
    cam = recipe("undercut-cam").cam
    told, found = scene_of(cam, cut=gk.undercut(cam)), scene_of(cam)
    for one, other in zip(told.marks, found.marks, strict=True):
        np.testing.assert_array_equal(one.place, other.place)
    assert [curve.label for curve in told.curves] == [curve.label for curve in found.curves]


SHARP = gk.Program(
    (gk.Rise("cycloidal", rise=10, end_deg=40), gk.Return("cycloidal", end_deg=80), gk.Dwell(end_deg=360))
)


@pytest.mark.parametrize("sort", ["circle", "line"])
def test_what_undercut_keeps_from_its_place_is_drawn_where_it_should_be(sort):
    """By the table: as far beyond the follower as lift is lost, along its way; nowhere else."""
    follower = gk.TranslatingRoller(12, 0) if sort == "circle" else gk.TranslatingFlat(0)
    cam = gk.Cam(follower, SHARP, 20)
    scene = scene_of(cam)
    (wished,) = [mark for mark in scene.marks if mark.label == "follower without undercut"]
    lost = np.asarray(scene.table["lost_lift"])
    (way,) = marks(scene, "line", "direction of motion")
    assert wished.sort == sort and (lost > 0).any() and np.array_equal(np.isfinite(wished.place), lost > 0)
    along = way.vector / np.abs(way.vector)
    here = lost > 0
    if sort == "circle":
        (pin,) = marks(scene, "pin", "roller")
        assert np.abs(wished.place - pin.place - lost * along)[here].max() < 1e-6
        assert (wished.radius == 12).all()
    else:
        # Square to the way, and through where the face would be by its lift.
        assert np.abs(np.real(wished.vector * np.conj(along)))[here].max() < 1e-9
        high = np.real(wished.place * np.conj(along))[here]
        assert high == pytest.approx(20 + np.asarray(scene.table["lift"])[here] + 0 * lost[here], abs=1e-6)


LIMITED = 'kind = "four-bar"\nlinkage = {ground = 100, crank = 80, coupler = 60, rocker = 50}\ndrive = {step_deg = 5}\n'


def test_copies_stand_open_where_any_of_them_does_and_each_is_where_its_own_crank_is():
    text = LIMITED + "copies = [{phase_deg = 40}, {phase_deg = 100, mirrored = true}]\n"
    own, alone = gk.load(text), gk.load(LIMITED)
    scene = own.scene
    there = np.array([np.isfinite(body.direction) for body in scene.bodies]).all(axis=0)
    assert np.array_equal(scene.assembled, there) and 0 < scene.assembled.sum() < alone.scene.assembled.sum()
    crank = named(scene, "crank, copy 2").direction
    ahead = np.exp(1j * np.radians(np.asarray(scene.drive.values) + 40))
    assert np.abs(crank - ahead)[np.isfinite(crank)].max() < 1e-9
    high = max(body.layer for body in alone.scene.bodies) + 1
    layers = {body.name: body.layer for body in scene.bodies}
    for body in alone.scene.bodies:
        assert layers[f"{body.name}, copy 2"] == high + body.layer
        # Turned over, the lowest is the highest.
        assert layers[f"{body.name}, copy 3"] == 3 * high - 1 - body.layer
    assert [body.name for body in scene.bodies if body.named] == [body.name for body in alone.scene.bodies]


def test_what_is_known_somewhere_is_plotted_and_what_is_known_nowhere_is_not():
    scene = gk.load(LIMITED).scene
    assert not scene.assembled.all()
    plotted = {header for plot in scene.plots for header in plot.columns}
    known = {column.id for column in scene.table.columns if np.isfinite(column.values).any()}
    assert plotted <= known
    assert {"coupler_angle", "rocker_angle", "transmission_angle", "coupler_omega"} <= plotted
    never = gk.move(gk.FourBar(100, 80, 60, 50), np.linspace(3, 3.2, 7))
    assert not never.assembled.any()
    told = {
        header
        for plot in gk.linkage.linkage_scene(never, gk.linkage.motion_table(never)).plots
        for header in plot.columns
    }
    assert not told & plotted


def test_of_a_body_with_one_pin_nothing_is_constructed():
    own = recipe("inflection-circle")
    assert [mark for mark in own.scene.marks if mark.role == "bobillier"]
    linkage = gk.Linkage(
        {"ground": {"O": 0, "C": 60}, "crank": {"O": 0, "A": 20}, "rod": {"A": 0}, "arm": {"C": 0}},
        "crank", (gk.Slider("way", "rod", "arm", through=10j),),
    )  # fmt: skip
    motion = gk.move(linkage, np.linspace(0, 2 * np.pi, 25))
    table = own.table
    rows = {name: np.resize(np.asarray(values), 25) for name, values in table.to_columns().items()}
    columns = tuple(replace(column, values=rows[column.header], scale=0.0) for column in table.columns)
    scene = inflection_scene(motion, replace(table, columns=columns), "rod", 5j)
    assert not [mark for mark in scene.marks if mark.role == "bobillier"]
    assert [mark for mark in scene.marks if mark.role == "inflection"]


def test_polygons_are_about_as_large_as_the_linkage_whichever_way_they_are_longer():
    """Drawn at a round scale: the longer side of the box about each lies between a half and all of what there is."""
    turn = np.linspace(0, 2 * np.pi, 37)
    for linkage, drive in (
        (gk.SliderCrank(30, 90, 0), turn),
        (gk.FourBar(100, 30, 90, 70), turn),
        (gk.FourBar(100, 80, 90, 95), turn),
        # Tall and narrow, wide and low.
        (gk.FourBar(100, 30, 90, 70), turn[:3] / 5),
        (gk.SliderCrank(30, 90, 0), 1.5 + turn[:3] / 5),
    ):
        motion = gk.move(linkage, drive, 1, 2 * np.pi)
        scene = gk.linkage.polygons_scene(motion, gk.linkage.motion_table(motion))
        plain = gk.linkage.linkage_scene(motion, gk.linkage.motion_table(motion))
        low, high = plain.box
        size = max(abs(high - low), float(np.max(motion.linkage.size)))
        for rate in ("v", "a"):
            sides = [mark for mark in scene.marks if mark.sort == "vector" and mark.label.startswith(f"{rate} ")]
            ends = np.concatenate([[*m.place, *(m.place + m.vector)] for m in sides])
            longer = max(np.ptp(ends.real), np.ptp(ends.imag))
            assert 0.3 * size < longer <= 1.0001 * size, (rate, longer, size)


def test_no_force_has_no_arrow_and_any_other_is_drawn_at_one_scale():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 13))
    plain = gk.linkage.linkage_scene(motion, gk.linkage.motion_table(motion))
    plots = (gk.model.scene.Plot("angle", (plain.drive.id,)),)
    what = {"velocity": "one", "wanted": "other"}
    none = gk.linkage.force_scene(plain, 5 + 5j, {"velocity": np.zeros(13, complex)}, what, plots)
    assert none.marks == plain.marks and none.plots == plots
    assert gk.linkage.force_scene(plain, 0j, {}, what, plots).marks == plain.marks
    force = {"velocity": np.linspace(1, 4, 13) * 1j, "wanted": np.full(13, -2 + 0j)}
    force["velocity"][3] = np.nan
    some = gk.linkage.force_scene(plain, 5 + 5j, force, what, plots)
    one, other = some.marks[-2:]
    assert (one.place == 5 + 5j).all() and one.label.startswith("one, ") and other.label.startswith("other, ")
    assert one.vector[-1] / other.vector[-1] == pytest.approx(-2j) and np.isnan(one.vector[3])
    low, high = plain.box
    assert 0.1 < np.nanmax(np.abs(one.vector)) / abs(high - low) < 1


@pytest.mark.parametrize("name", ["straight-sided", "point-tooth", "straight-sided-ring"])
def test_a_conjugate_pair_slides_as_its_table_says(name):
    scene, table = recipe(name).scene, recipe(name).table
    heads = ("pressure_angle_deg", "sliding_mm_per_rad")
    rows = ({column.header: column.values for column in one.columns} for one in (scene.table, table))
    shown, told = (np.stack([one[head] for head in heads]) for one in rows)
    shown, told = (both[:, np.isfinite(both).all(axis=0)] for both in (shown, told))
    size = np.ptp(told, axis=1)[:, None]
    nearest = np.abs((shown[:, :, None] - told[:, None]) / size[:, None]).max(axis=0).min(axis=1)
    assert nearest.max() < 0.03 and np.ptp(shown[1]) > 0.3 * size[1, 0]


def test_wanted_points_are_named_once():
    wanted = [curve.label for curve in recipe("path-generator").scene.curves if curve.role == "wanted"]
    assert len(wanted) > 2 and sorted(wanted)[-2:] == ["", "wanted points"]
