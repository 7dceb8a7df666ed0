"""Whole designs in the studio by the mouse alone: each in fewer than 30 gestures, counted."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.checks import pressure_angle

from .test_editor import RECIPES, centre, settle, studio  # noqa: F401  the fixture

MOST_GESTURES = 30
SMALL_CAM = """kind = "disk-cam"
[cam]
base_radius = 20
follower = { kind = "translating-roller", roller_radius = 8 }
[[cam.program]]
kind = "rise"
law = "cycloidal"
rise = 20
end_deg = 90
[[cam.program]]
kind = "return"
law = "3-4-5"
end_deg = 360
"""


class Hand:
    """A mouse on the page of the studio that counts what it does."""

    def __init__(self, editor):
        self.editor, self.page, self.gestures = editor, editor.page, 0
        self.page.set_default_timeout(60_000)

    def count(self):
        self.gestures += 1
        assert self.gestures < MOST_GESTURES

    def click(self, selector):
        self.count()
        self.page.click(selector)
        settle(self.page)

    def drag(self, handle, right, up):
        self.count()
        x, y = centre(self.page, handle)
        self._drag(x, y, x + right, y - up)

    def drag_rim(self, handle, outwards):
        """Drags a circle by its point on the left."""
        self.count()
        box = self.page.locator(f'[data-handle="{handle}"] .rim').bounding_box()
        x, y = box["x"], box["y"] + box["height"] / 2
        self._drag(x, y, x - outwards, y)

    def _drag(self, x, y, to_x, to_y):
        mouse = self.page.mouse
        mouse.move(x, y)
        mouse.down()
        mouse.move(to_x, to_y, steps=3)
        mouse.up()
        settle(self.page)

    def quantity(self, label):
        row = self.page.locator("#quantities tr", has=self.page.locator(f'th:text-is("{label}")'))
        return row.locator("td").first.inner_text().split()

    def saved(self):
        """The recipe in the file after a click on Save."""
        self.click("#save")
        self.page.wait_for_selector("#dirty", state="hidden")
        return gk.load(self.editor.file)


@pytest.fixture
def hand(studio):  # noqa: F811
    return lambda text: Hand(studio(text, viewport={"width": 1300, "height": 1100}))


def test_the_stride_of_a_walking_leg_is_made_longer(hand):
    text = (RECIPES / "walking-leg.toml").read_text()

    def foot(recipe):
        place = recipe.motion.point("foot").position
        return np.ptp(place.real), np.ptp(place.imag)

    stride, lift = foot(gk.load(text))
    mouse = hand(text)
    # A longer crank lengthens the stride, and a longer leg lowers the foot.
    mouse.drag("point:M", 9, 0)
    mouse.drag("point:foot", 0, -12)
    changed = mouse.saved()
    assert changed.motion.assembled.all()
    longer, higher = foot(changed)
    assert longer > 1.05 * stride and higher > lift


def test_a_body_is_guided_through_three_dragged_poses(hand):
    mouse = hand((RECIPES / "three-poses.toml").read_text())
    mouse.drag("point:wanted.poses[1][0]", 14, 9)
    mouse.drag("point:wanted.poses[2][2]", -16, -5)
    mouse.drag("point:wanted.region[1]", 20, 15)
    mouse.page.wait_for_selector("body:not(.unchecked) #candidates button")
    # Rectification: where no driven and no driving pin may be.
    assert all(mouse.page.locator(f"#player input[name={role}]").is_checked() for role in ("driven", "driving"))
    mouse.click("#candidates button >> nth=1")
    recipe = mouse.saved()
    poses = recipe.wanted.pairs
    assert recipe.choose == 2 and abs(poses[1][0] - (-20 + 60j)) > 3 and np.degrees(poses[2][1]) != 90
    # The coupler of the saved linkage goes through all poses, without a defect of branch, circuit or order.
    motion = gk.move(recipe.found.linkage, recipe.found.drive, recipe.found.branch)
    assert np.allclose(motion.point("coupler_point").position, [place for place, _ in poses], atol=0.01)
    turned = motion.coupler.direction / motion.coupler.direction[0]
    assert np.allclose(turned, np.exp(1j * np.array([angle - poses[0][1] for _, angle in poses])), atol=1e-3)
    assert not recipe.found.defects


def test_a_cam_is_enlarged_until_its_pressure_angle_is_at_most_30_degrees(hand):
    mouse = hand(SMALL_CAM)
    assert float(mouse.quantity("pressure angle on the rise")[0]) > 33
    while float(mouse.quantity("pressure angle on the rise")[0]) > 30:
        mouse.drag_rim("circle:cam.base_radius", 12)
    recipe = mouse.saved()
    angle = pressure_angle(recipe.cam, np.linspace(0, 2 * np.pi, 2001))
    assert np.degrees(np.abs(angle)).max() <= 30 and recipe.cam.base_radius > 20


def test_a_gear_pair_gets_a_given_centre_distance(hand):
    wanted = 60.0
    mouse = hand((RECIPES / "gear-pair.toml").read_text())

    def distance():
        return float(mouse.quantity("centre distance")[0])

    # Teeth bring the distance near, and profile shifts the rest; closer by the buttons of the drawing.
    while wanted - distance() > 1.5:
        mouse.drag_rim("circle:second.teeth", 8)
    mouse.click('button[aria-label="Zoom in"]')
    for _ in range(4):
        before, (_, y) = distance(), centre(mouse.page, "point:first.profile_shift")
        mouse.drag("point:first.profile_shift", 0, 6 if wanted > before else -6)
        scale = (y - centre(mouse.page, "point:first.profile_shift")[1]) / (distance() - before)
        mouse.drag("point:first.profile_shift", 0, (wanted - distance()) * scale)
        if abs(distance() - wanted) < 0.02:
            break
    pair = mouse.saved().design
    assert pair.centre_distance == pytest.approx(wanted, abs=0.05) and pair.second.teeth > 24
    assert pair.first.module == pair.second.module == 3 and not pair.interferences


def on_stage(page, x, y):
    """Where a place, mm, is in the window."""
    find = """([x, y]) => {
        const svg = document.querySelector("#player .drawing"), box = svg.getBoundingClientRect();
        const matrix = svg.querySelector(".world").transform.baseVal.consolidate().matrix;
        return [box.left + matrix.e + matrix.a * x, box.top + matrix.f + matrix.d * y];
    }"""
    return page.evaluate(find, [x, y])


# A Klann leg in one position, mm.
KLANN = {
    "O": (0, 0),
    "upper": (-39, 75),
    "lower": (-32, -18),
    "crank": (7, 17),
    "elbow": (-26, 5),
    "hip": (-42, 35),
    "knee": (-118, 33),
    "foot": (-92, -65),
}


def middle(one, other):
    return tuple((a + b) / 2 for a, b in zip(one, other))


class Builder(Hand):
    """A hand that builds a linkage."""

    def count(self):
        self.gestures += 1
        assert self.gestures < 40

    def kept(self, name):
        """The recipe in the file after it was saved under the name that is proposed."""
        self.click("#save")
        self.click("#name-dialog button >> nth=0")
        self.page.wait_for_selector("#dirty", state="hidden")
        return gk.load(self.editor.file.with_name(f"{name}.toml"))

    def use(self, tool, *places):
        """Chooses a tool and clicks at places, mm."""
        self.click(f'[data-tool="{tool}"]')
        for place in places:
            self.count()
            self.page.mouse.move(*on_stage(self.page, *place))
            self.page.mouse.click(*on_stage(self.page, *place))
            settle(self.page)


@pytest.fixture
def empty_stage(studio):  # noqa: F811
    def start(**options):
        builder = Builder(studio("", viewport={"width": 1280, "height": 720}, **options))
        builder.click("text=empty linkage")
        builder.page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')
        return builder

    return start


def built_leg(hand):
    """A Klann leg from an empty stage."""
    places = KLANN
    hand.click("text=empty linkage")
    hand.page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')
    hand.use("pivot", places["O"], places["upper"], places["lower"])
    hand.use("bar", places["O"], places["crank"])
    hand.use("dyad", places["crank"], places["lower"], places["elbow"])
    hand.use("trace", middle(places["crank"], places["elbow"]), places["hip"])
    hand.use("dyad", places["hip"], places["upper"], places["knee"])
    hand.use("trace", middle(places["hip"], places["knee"]), places["foot"])
    assert hand.page.locator("#tools b").inner_text().startswith("1 degree of freedom")
    # The saved leg turns fully, and is that of the clicks, rounded to the grid of a pixel.
    motion = hand.kept("linkage").motion
    assert motion.assembled.all() and len(motion.linkage.bodies) == 6
    at = {name: complex(*place) for name, place in places.items()}
    bodies = ["crank O crank", "coupler crank elbow hip", "rocker lower elbow", "leg hip knee foot", "arm upper knee"]
    linkage = gk.Linkage(
        {"ground": {name: at[name] for name in ("O", "upper", "lower")}}
        | {body: {name: at[name] for name in names} for body, *names in map(str.split, bodies)},
        "crank",
    )
    apart = gk.move(linkage, motion.drive, {"elbow": -1}).point("foot").position
    positions = [motion.point(name).position for points in motion.linkage.bodies.values() for name in points]
    (foot,) = [place for place in positions if np.abs(place - apart).max() < 3]
    # It steps: it lifts its foot, and for a third of a turn its height hardly changes.
    height = foot.imag
    assert np.ptp(height) > 40 and (height < height.min() + 5).mean() > 1 / 3


def heart(share):
    turn = 2 * np.pi * share
    place = 32 * np.sin(turn) ** 3 + 2j * sum(a * np.cos(k * turn) for k, a in enumerate((13, -5, -2, -1), 1))
    return place.real, place.imag


def drawn_heart(hand):
    """A linkage that traces a heart, drawn in one stroke."""
    page = hand.page
    hand.click("text=empty linkage")
    hand.click('[data-tool="path"]')
    hand.count()
    page.mouse.move(*on_stage(page, *heart(0)))
    page.mouse.down()
    for k in range(1, 73):
        page.mouse.move(*on_stage(page, *heart(k / 72)))
    page.mouse.up()
    # Known linkages appear before the search has ended; its result is then shown.
    page.wait_for_selector("#known button", timeout=60_000)
    page.wait_for_selector("body:not(.unchecked) #candidates button", timeout=200_000)
    assert page.locator("#known button").count() >= 4 and page.locator("#tools [data-tool=bar]").is_hidden()
    recipe = hand.kept("path-generator")
    drawn = np.array([complex(*heart(k / 720)) for k in range(720)])
    assert recipe.wanted.closed and np.abs(np.array(recipe.wanted.points)[:, None] - drawn).min(axis=1).max() < 2.5
    # The best candidate is within 8 % of its size.
    size = np.hypot(np.ptp(drawn.real), np.ptp(drawn.imag))
    assert recipe.found.bars == 6 and recipe.found.largest_distance < 0.08 * size
    # A known one takes its place.
    hand.click("#known button >> nth=0")
    page.wait_for_selector("#tools [data-tool=bar]")
    assert page.is_enabled("#undo") and page.is_visible("#dirty")


def designed_cam(hand):
    """A cam whose lift is made larger, and then the cam, until its pressure angle is at most 30 deg."""
    hand.click('#kinds .card:has(b:text-is("disk-cam"))')
    hand.page.wait_for_selector('[data-handle="plot:cam.program[1].end_deg"]')

    def angle():
        return float(hand.quantity("pressure angle on the rise")[0])

    while angle() < 31:
        hand.drag("plot:cam.program[1].end_deg", 0, 25)
    while angle() > 30:
        hand.drag_rim("circle:cam.base_radius", 12)
    recipe = hand.kept("disk-cam")
    exact = pressure_angle(recipe.cam, np.linspace(0, 2 * np.pi, 2001))
    assert np.degrees(np.abs(exact)).max() <= 30 and recipe.cam.base_radius > 40


def joined_leg(hand):
    """The leg that was built, and a cam, on shafts of a gear pair."""
    page = hand.page
    hand.click('#kinds .card:has(b:text-is("gear-pair"))')
    pair = hand.kept("gear-pair")
    hand.click("#join")
    hand.click('#folder .card:has(b:text-is("linkage"))')
    axis = pair.rotating_bodies["second"].axis
    hand.count()
    x, y = on_stage(page, axis.real, axis.imag)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 50, y - 50, steps=3)
    page.mouse.up()
    settle(page)
    hand.click("#join")
    hand.click('#folder .card:has(b:text-is("disk-cam"))')
    hand.count()
    page.mouse.click(*on_stage(page, 0, 0))
    settle(page)
    hand.click("#save")
    page.wait_for_selector("#dirty", state="hidden")
    machine = gk.load(hand.editor.file.with_name("gear-pair.toml"))
    leg, cam = machine.mechanisms["linkage"], machine.mechanisms["disk-cam"]
    assert leg.turned_by == "gear-pair.second" and leg.phase_deg == 45 and leg.recipe.name == "linkage"
    assert cam.turned_by == "gear-pair.first"
    teeth = pair.first.teeth / pair.second.teeth
    assert float(machine.graph.speeds["linkage"]) == pytest.approx(-teeth) and machine.graph.speeds["disk-cam"] == 1
    # Both are moved: the leg's foot is where it is alone at the gear's angle.
    assert np.isfinite(machine.scene.time).all() and machine.scene.assembled.all()


def test_four_designs_are_made_by_mouse_alone_from_an_empty_folder(studio):  # noqa: F811
    """No key is pressed; the fixture holds that the console stays empty."""
    hand = Builder(studio("", viewport={"width": 1280, "height": 720}))
    gestures = {}
    for design in (built_leg, drawn_heart, designed_cam, joined_leg):
        if gestures:
            hand.click("#new")
        design(hand)
        gestures[design.__name__], hand.gestures = hand.gestures, 0
    print(gestures)
    assert max(gestures.values()) < 40


def test_loads_and_a_motor_are_put_on_a_linkage_and_taken_away(empty_stage):
    hand = empty_stage()
    page = hand.page
    hand.use("pivot", (-60, -20), (60, -20))
    hand.use("bar", (-60, -20), (-40, 10))
    hand.use("spring", (-40, 10), (-80, 60))
    # It is drawn before the linkage moves.
    assert len(page.get_attribute(".spring", "d")) > 100
    hand.use("dyad", (-40, 10), (60, -20), (50, 50))
    hand.use("force", (50, 50), (90, 50))
    hand.use("motor", (-50, -5))
    hand.click('#motor-dialog button:has-text("nema17")')
    assert not page.locator(".stale").count()
    hand.click("#save")
    hand.click("#name-dialog button >> nth=0")
    page.wait_for_selector("#dirty", state="hidden")
    recipe = gk.load(hand.editor.file.with_name("linkage.toml"))
    (spring,), (force,) = recipe.loads.springs, recipe.loads.forces
    assert spring.body == "crank" and spring.to_body == "ground" and force.force_n == (10, 0)
    assert recipe.stock.motor is not None and recipe.linkage.driver == "crank"
    # The middle of the spring, and of the arrow, on the screen.
    x, y = centre(page, "point:loads.forces[0].force_n")
    start = on_stage(page, 50, 50)
    hand.click('[data-tool="delete"]')
    for spot in ((x + start[0]) / 2, (y + start[1]) / 2), on_stage(page, *middle((-40, 10), (-80, 60))):
        hand.count()
        page.mouse.move(*spot)
        page.mouse.click(*spot)
        settle(page)
    hand.use("motor", (-50, -5))
    hand.click('#motor-dialog button:has-text("no motor")')
    hand.click("#save")
    page.wait_for_selector("#dirty", state="hidden")
    recipe = gk.load(hand.editor.file.with_name("linkage.toml"))
    assert not recipe.loads and recipe.stock.motor is None and len(recipe.linkage.bodies) == 4
    assert page.get_attribute(".spring", "d") == ""


SQUARE = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H40V-30H0Z" fill="none"/></svg>'


def test_a_dropped_drawing_is_the_wanted_path(empty_stage):
    page = empty_stage().page
    drop = """([text]) => {
        const data = new DataTransfer();
        data.items.add(new File([text], "square.svg", { type: "image/svg+xml" }));
        document.querySelector("#player .stage").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true }));
    }"""
    wanted = lambda request: "/answer" in request.url and '"draw"' in (request.post_data or "")  # noqa: E731
    with page.expect_request(wanted, timeout=60_000) as sent:
        page.evaluate(drop, [SQUARE])
    assert page.locator("#known button").count() >= 4
    xs, ys = zip(*sent.value.post_data_json["draw"]["points"])
    assert (min(xs), max(xs), min(ys), max(ys)) == pytest.approx((0, 40, 0, 30), abs=0.2)
    page.click("#stop")
