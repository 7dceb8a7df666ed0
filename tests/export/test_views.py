"""Half sections and tables of the dimensioned drawing, and what it does where no place is free."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export import dimensions
from geomkin.export.dimensioned import dimensioned_drawing
from geomkin.export.drawing_views import ALONG, HATCHED
from geomkin.export.job import Job, StaticSource
from geomkin.plane.primitives import Circle, Polyline

GEAR = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "stock": {"bore": 8, "thickness": 12}}


def drawing(recipe):
    return dimensioned_drawing(Job("a", recipe, recipe.files.tolerance))


def words(made):
    return [text.text for text in made.texts]


def lines(made, layer):
    return [np.asarray(s.vertices) for name, s in made.shapes if name == layer and not isinstance(s, Circle)]


@pytest.mark.parametrize("hand", ["right", "left"])
def test_lines_of_the_half_section_have_the_slope_and_hand_of_the_teeth(hand):
    made = drawing(gk.load({**GEAR, "helix_angle_deg": 25, "hand": hand}))
    teeth = [z for z in lines(made, "DIM") if len(z) == ALONG]
    assert len(teeth) == 3
    # A right-hand screw (R cos p, R sin p, R p / tan b) seen from -x, z to the right: at p = pi y falls by tan b.
    slopes = [np.polyfit(z.real, z.imag, 1)[0] for z in teeth]
    assert slopes == pytest.approx([-np.tan(np.radians(25)) * (1 if hand == "right" else -1)] * 3, rel=1e-6)


def test_hatching_covers_the_cut_rim_from_the_bore_to_the_roots():
    recipe = gk.load(GEAR)
    made = drawing(recipe)
    slanted = [z for z in lines(made, "DIM") if len(z) == 2 and abs((z[1] - z[0]).real - (z[1] - z[0]).imag) < 1e-9]
    hatched = sum(abs(z[1] - z[0]) for z in slanted if abs(z[1] - z[0]) > 0) * HATCHED / 2**0.5 / made.scale**2
    area = 12 * (recipe.design.root_radius - 4)
    assert hatched == pytest.approx(area, rel=0.1)
    (thickness,) = [d for d in made.dimensions if d.kind == "linear"]
    assert thickness.text.text == "12" and abs(thickness.points[1] - thickness.points[0]) == 12 * made.scale


def test_base_circle_of_a_cam_is_drawn_apart_from_its_profile_only():
    recipe = gk.load("recipes/flat-cam.toml")
    made = drawing(recipe)
    (radius,) = [d for d in made.dimensions if d.text.text.startswith("base R")]
    centre, size = radius.points[0], recipe.cam.base_radius * made.scale
    assert abs(radius.points[1] - centre) == pytest.approx(size)
    arcs = [z for z in lines(made, "CENTRE") if np.allclose(np.abs(z - centre), size)]
    profile = gk.flatten(recipe.parts[0].outline, 0.01) * made.scale
    assert arcs
    for z in arcs:
        assert np.abs((z - centre)[:, None] - profile).min() > 0.3


def test_gears_in_a_machine_have_their_data_and_mates():
    train = {"kind": "gear-train", "train": {"stages": [[12, 36], [12, 48]], "module": 1, "directions_deg": [-90, -60]}}
    legs = {"kind": "four-bar", "linkage": {"ground": 50, "crank": 15, "coupler": 45, "rocker": 35}}
    mechanisms = {"train": {"recipe": train}, "leg": {"recipe": legs, "turned_by": "train.driven_2"}}
    made = words(drawing(gk.load({"kind": "machine", "mechanisms": mechanisms})))
    assert made.count("mate") == 4 and made.count("driven_1, 36 teeth") == 1


def test_a_diameter_without_a_free_place_is_listed_with_its_place(monkeypatch):
    monkeypatch.setattr(dimensions, "LEADERS", np.array([7.0, 11.0]))
    side = np.array([0, 200, 200 + 200j, 200j])
    marks = tuple(Polyline(np.array([1 + 2j * k, 199 + 2j * k]), is_closed=False) for k in range(1, 100))
    holes = (Circle(100 + 99j, 2.0), Circle(40 + 99j, 2.0))
    part = gk.Part("plate", Polyline(side), holes, 3.0, marks=marks)
    made = dimensioned_drawing(Job("a", StaticSource((part,)), 1e-3))
    # The datum is the hole nearest to the origin.
    assert "2 x Ø4: centre at 60, 0; 0, 0" in words(made)


def test_coordinates_that_are_rounding_errors_are_nothing():
    side = np.array([0, 90, 90 + 40j, 40j]) + 3e-8j
    part = gk.Part("plate", Polyline(side), (Circle(20 + 10j, 2.0), Circle(60 + 10.00000002j, 2.0)), 3.0)
    made = dimensioned_drawing(Job("a", StaticSource((part,)), 1e-3))
    numbers = [float(d.text.text) for d in made.dimensions if d.kind == "y"]
    assert numbers == [-10, 0, 30]


def test_columns_of_a_table_are_equally_long():
    made = drawing(gk.load("recipes/undercut-cam.toml"))
    heads = [text for text in made.texts if text.text == "point"]
    rows = [
        sum(
            t.text.isdigit() and abs(t.place.real - head.place.real) < 1e-6 and 0 < (head.place - t.place).imag < 155
            for t in made.texts
        )
        for head in heads
    ]
    assert len(rows) >= 4 and max(rows) - min(rows) <= 1 and max(rows) <= 30


def test_a_cam_with_two_hundred_points_is_on_a2_and_its_tables_name_it():
    steps = [{"kind": "rise", "law": "cycloidal", "rise": 20, "end_deg": 90}, {"kind": "dwell", "end_deg": 180}]
    steps += [{"kind": "return", "law": "cycloidal", "end_deg": 270}, {"kind": "dwell", "end_deg": 360}]
    follower = {"kind": "translating-roller", "roller_radius": 8}
    cam = {"base_radius": 30, "follower": follower, "program": steps}
    stock = {"thickness": 8, "bore": 12, "fit": "H7/k6"}
    made = drawing(gk.load({"kind": "disk-cam", "cam": cam, "stock": stock}))
    heads = [text for text in made.texts if text.text == "point"]
    assert made.width <= 594 and len(heads) > 5
    assert sum(text.text == "cam" for text in made.texts) == len(heads)


def test_sentences_are_as_high_as_there_is_room_at_the_left():
    for left, low in ((0.0, -40.0), (90.0, 0.0)):
        canvas = dimensions.DrawingCanvas()
        canvas.line(0j, 100 + 0j)
        canvas.line(complex(left, -40), 100 - 40j)
        canvas.write_below(["short", "words"])
        assert [text.place.real for text in canvas.texts] == [0, 0]
        assert low - 10 < canvas.texts[0].place.imag < low - 3
