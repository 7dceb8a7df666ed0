"""Pages as a reader has them: they open, move, follow the slider, the pointer and the keys, and show what the files state."""

import csv
from base64 import b64encode, urlsafe_b64decode, urlsafe_b64encode
from itertools import combinations
from pathlib import Path
from urllib.parse import urlsplit

import pytest

import geomkin as gk

RECIPES = Path(__file__).parent.parent.parent / "recipes"
GALLERY = sorted(file.stem for file in RECIPES.glob("*.toml"))
# One of every four; the campaign opens them all.
SOME = [name if k % 4 == 0 else pytest.param(name, marks=pytest.mark.campaign) for k, name in enumerate(GALLERY)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


def page_of(name, folder):
    recipe = gk.load(RECIPES / f"{name}.toml")
    if recipe.scene is None:
        pytest.skip("this kind shows nothing moving yet")
    gk.write(recipe, folder / f"{name}.html")
    return recipe, folder / f"{name}.html"


def go_to(page, frame):
    page.evaluate(
        "k => { const slider = document.querySelector('.drive input'); slider.value = k;"
        " slider.dispatchEvent(new Event('input')); }",
        frame,
    )


def frame_of(page):
    return int(page.get_attribute("#player", "data-frame"))


def matrix_of(page, body):
    return page.get_attribute(f'[data-body="{body}"]', "transform")


def number(text):
    return float(text.replace("−", "-").split()[0].rstrip("°"))


@pytest.mark.parametrize("name", SOME)
def test_every_page_opens_without_a_complaint_and_asks_for_nothing(name, folder, opened):
    _, file = page_of(name, folder)
    for width in (320, 1400):
        tab = opened(file, viewport={"width": width, "height": 800})
        assert not tab.said and set(tab.asked.urls) <= {tab.asked.own, "data:,"}
        assert tab.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


def test_play_moves_the_linkage_and_the_wish_for_less_motion_stops_it(folder, opened):
    _, file = page_of("crank-rocker", folder)
    tab = opened(file)
    before = matrix_of(tab.page, "crank")
    tab.page.wait_for_timeout(300)
    assert matrix_of(tab.page, "crank") == before and frame_of(tab.page) == 0
    tab.page.click('button[aria-label="Play"]')
    tab.page.wait_for_function("() => +document.querySelector('#player').dataset.frame > 5")
    tab.page.click('button[aria-label="Pause"]')
    assert matrix_of(tab.page, "crank") != before
    stopped = frame_of(tab.page)
    tab.page.wait_for_timeout(200)
    assert frame_of(tab.page) == stopped
    playing = opened(file, still=False)
    playing.page.wait_for_function("() => +document.querySelector('#player').dataset.frame > 5")


@pytest.mark.parametrize("name", ["crank-rocker", "walking-leg", "slider-crank-by-slider", "inflection-circle"])
def test_the_slider_s_end_is_the_last_row_of_the_csv(name, folder, opened):
    recipe, file = page_of(name, folder)
    gk.write(recipe.scene.table, folder / f"{name}.csv")
    rows = list(csv.reader((folder / f"{name}.csv").read_text().splitlines()))
    tab = opened(file)
    go_to(tab.page, len(rows) - 2)
    tab.page.click("summary")
    cells = "rows => rows.map((row) => [2, 3, 5].map((k) => row.children[k].textContent))"
    shown = tab.page.eval_on_selector_all(".values tbody tr", cells)
    assert len(shown) == len(rows[0])
    for header, *column, (now, least, largest) in zip(*rows, shown):
        known = [float(cell) for cell in column if cell]
        # It shows five digits of each.
        assert [number(least), number(largest)] == pytest.approx([min(known), max(known)], rel=5.1e-5, abs=1e-9), header
        if column[-1]:
            assert number(now) == pytest.approx(float(column[-1]), rel=5.1e-5, abs=1e-9), header
        else:
            assert now == "–"
    assert number(tab.page.inner_text(".drive output")) == pytest.approx(float(rows[-1][0]))


def test_data_are_saved_as_the_csv_has_them(folder, opened):
    recipe, file = page_of("crank-rocker", folder)
    tab = opened(file)
    with tab.page.expect_download() as download:
        tab.page.click("text=Data as CSV")
    saved = list(csv.reader(Path(download.value.path()).read_text().splitlines()))
    columns = recipe.scene.table.to_columns()
    # The page has more quantities than the recipe's own file: the effects of sizes.
    assert download.value.suggested_filename == "crank-rocker.csv" and saved[0] == list(columns)
    assert saved[0][: len(recipe.table.columns)] == list(recipe.table.to_columns())
    for k, values in enumerate(columns.values()):
        assert [float(row[k]) for row in saved[1:]] == pytest.approx(list(values), rel=1e-6, abs=1e-9)
    assert not tab.said and set(tab.asked.urls) <= {tab.asked.own, "data:,"}


@pytest.mark.parametrize(("body", "share"), [("crank", 0.75), ("rocker", 0.75)])
def test_dragging_a_link_turns_the_driver(body, share, folder, opened):
    recipe, file = page_of("crank-rocker", folder)
    tab = opened(file, viewport={"width": 1200, "height": 900})
    page = tab.page
    go_to(page, 60)
    # Where a point of the body is on the screen at a frame.
    place = """([name, u, frame]) => {
      const slider = document.querySelector('.drive input'), back = slider.value, go = (k) => {
        slider.value = k; slider.dispatchEvent(new Event('input')); };
      go(frame);
      const group = document.querySelector(`[data-body="${name}"]`);
      const at = new DOMPoint(u, 0).matrixTransform(group.getScreenCTM());
      go(back);
      return [at.x, at.y];
    }"""
    length = share * getattr(recipe.linkage, body)
    start, end = (page.evaluate(place, [body, length, frame]) for frame in (60, 100))
    page.mouse.move(*start)
    page.mouse.down()
    for k in range(1, 11):
        page.mouse.move(*(a + k / 10 * (b - a) for a, b in zip(start, end)))
    page.mouse.up()
    assert abs(frame_of(page) - 100) <= 4


def test_a_failed_check_s_click_lands_on_its_frame(folder, opened):
    recipe, file = page_of("walking-leg", folder)
    tab = opened(file)
    assert "least transmission angle" in tab.page.inner_text("header")
    row = tab.page.query_selector("#checks tbody tr")
    assert row.get_attribute("class") == "fails"
    row.query_selector("button").click()
    assert frame_of(tab.page) == int(recipe.table["transmission_angle"].argmin())


def test_keys_step_and_play(folder, opened):
    _, file = page_of("crank-rocker", folder)
    page = opened(file).page
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert frame_of(page) == 2
    page.keyboard.press("ArrowLeft")
    assert frame_of(page) == 1
    page.keyboard.press(" ")
    page.wait_for_selector('button[aria-label="Pause"]')
    page.keyboard.press(" ")
    page.wait_for_selector('button[aria-label="Play"]')


def test_a_sweeps_page_opens_and_is_read_by_keys(folder, opened):
    recipe = {"kind": "spur-gear", "gear": {"teeth": 12, "module": 2}}
    values = {"gear.teeth": "12:20:4", "gear.profile_shift": [0, 0.4]}
    sweep = gk.sweep(recipe, values, [], folder)
    file = next(path for path in sweep.files if path.suffix == ".html")
    for width in (320, 1400):
        tab = opened(file, viewport={"width": width, "height": 800})
        assert not tab.said and set(tab.asked.urls) <= {tab.asked.own, "data:,"}
        assert tab.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    page = tab.page
    assert page.locator("#plots .plot").count() == 2 and page.locator("#rows tbody tr").count() == 6
    over = page.locator("#plots .u-over").first
    over.focus()
    said = []
    for key in ("ArrowRight", "ArrowRight", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
        said.append(over.get_attribute("aria-valuetext").split()[0])
    assert said == ["16", "20", "20", "16"]
    for row, line in zip(sweep.rows[2:4], page.locator("#plots .legend").first.locator("b").all()):
        assert number(line.inner_text()) == pytest.approx(row.checks[0].value, rel=1e-4)


def test_a_design_of_a_front_is_chosen_by_mouse_and_by_keys(folder, opened):
    gear = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}}
    front = gk.optimise(gear, {"gear.teeth": (8, 20)}, ["rim", "-tip_thickness"], "undercut <= 0", out=folder)
    file = next(path for path in front.files if path.suffix == ".html")
    for width in (320, 1400):
        tab = opened(file, viewport={"width": width, "height": 800})
        assert not tab.said and set(tab.asked.urls) <= {tab.asked.own, "data:,"}
        assert tab.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    page = tab.page

    def chosen():
        [text] = page.locator("#designs details[open] code").all_inner_texts()
        return gk.load(text).gear.teeth

    over = page.locator("#plots .u-over").first
    box = over.bounding_box()
    over.click(position={"x": box["width"] - 1, "y": 20})
    assert chosen() == front.designs[-1].values["gear.teeth"]
    over.focus()
    for key in ("ArrowLeft", "Enter"):
        page.keyboard.press(key)
    assert chosen() == front.designs[-2].values["gear.teeth"] != front.designs[-1].values["gear.teeth"]


def test_still_scene_has_no_player(folder, opened):
    (folder / "parts.html").write_bytes(gk.show(gk.load(RECIPES / "crank-rocker.toml").parts).page)
    page = opened(folder / "parts.html").page
    for control in ('button[aria-label="Play"]', 'button[aria-label="One step on"]', ".speed", ".drive"):
        assert page.locator(control).count() == 1 and not page.is_visible(control)
    page.keyboard.press(" ")
    assert page.locator('button[aria-label="Play"]').count() == 1
    assert page.is_visible('button[aria-label="Zoom in"]') and page.is_visible("svg.drawing")


def test_family_is_plotted_with_a_line_at_the_chosen_member(folder, opened):
    recipe, file = page_of("wiper", folder)
    choice = recipe.scene.choice
    for width, plots in ((320, 1), (1400, 2)):
        page = opened(file, viewport={"width": width, "height": 800}).page
        assert page.locator("#choice .plot").count() == plots
        over = page.locator("#choice .u-over").first
        reported = page.locator("#choice .legend").first.locator("b").all_inner_texts()
        assert [number(one) for one in reported] == pytest.approx([recipe.found.transmission_angle_deg] * 2, rel=1e-4)
        # The line stands between the ends of the axis as its angle does.
        angles, line, box = (
            choice.table["free_angle"],
            page.locator("#choice .now").first.bounding_box(),
            over.bounding_box(),
        )
        share = (angles[choice.chosen] - angles[0]) / (angles[-1] - angles[0])
        assert abs(line["x"] - box["x"] - share * box["width"]) < 3
    over.focus()
    page.keyboard.press("ArrowRight")
    assert over.get_attribute("aria-valuenow") == str(choice.chosen + 1) and frame_of(page) == 0


def test_plots_follow_and_lead(folder, opened):
    _, file = page_of("crank-rocker", folder)
    page = opened(file, viewport={"width": 1400, "height": 900}).page
    assert page.locator(".plot").count() == 2
    page.click("text=Another plot")
    page.click("text=Another plot")
    assert page.locator(".plot").count() == 4 and not page.is_visible("text=Another plot")
    page.locator(".plot select").first.select_option(label="transmission angle")
    page.locator(".plot .u-over").first.scroll_into_view_if_needed()
    box = page.locator(".plot .u-over").first.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 4, box["y"] + box["height"] / 2)
    assert abs(frame_of(page) - 90) <= 1
    line = page.locator(".plot .now").first.bounding_box()
    assert abs(line["x"] - box["x"] - box["width"] / 4) < 3


def test_a_page_opens_its_recipe_in_the_studio_and_that_of_a_link(folder, opened):
    """A stand-in for `window.open`, since no studio runs here: what it gets is decoded apart."""
    page = opened(page_of("crank-rocker", folder)[1]).page
    page.evaluate("window.open = (link) => { window.asked = link; return true; }")
    text = page.text_content("#recipe-text") + "\n"

    def asked():
        address, held = page.evaluate("window.asked").split("#recipe=")
        assert urlsplit(address).hostname == "127.0.0.1"
        return urlsafe_b64decode(held + "=" * (-len(held) % 4)).decode()

    page.click("#open-recipe")
    assert asked() == text and page.locator("#linked").count() == 0
    other = "# ½ größer\nkind = 'four-bar'\n"
    held = urlsafe_b64encode(other.encode()).decode().rstrip("=")
    page.evaluate("held => { location.hash = `#recipe=${held}`; }", held)
    page.click('#linked button:has-text("studio")')
    assert asked() == other
    with page.expect_download() as download:
        page.click('#linked button:has-text("Save")')
    assert Path(download.value.path()).read_text() == other
    # A damaged link offers nothing, and says so.
    for damaged in ("%%", "", "QUJD"):
        page.evaluate("held => { location.hash = `#recipe=${held}`; }", damaged)
        page.wait_for_selector('#linked:has-text("incomplete")')
        assert not page.locator("#linked button").count()
    page.evaluate("location.hash = '#elsewhere'")
    page.wait_for_selector("#linked", state="detached")


def test_the_motion_is_saved_as_a_film(folder, opened):
    page = opened(page_of("crank-rocker", folder)[1], viewport={"width": 900, "height": 700}).page
    button = page.locator('button[aria-label="The motion as a film"]')
    # A pass of one second; the first film is given up.
    page.evaluate("document.querySelector('.speed select').value = 1")
    go_to(page, 40)
    button.click()
    page.wait_for_function("document.querySelector('button[aria-label^=\"The motion as\"]').textContent.endsWith('%')")
    button.click()
    page.wait_for_selector('button[aria-label="The motion as a film"]:text-is("Film")')
    with page.expect_download(timeout=60_000) as download:
        button.click()
    assert frame_of(page) == 40 and download.value.suggested_filename.split(".")[1] in ("mp4", "webm")
    content = Path(download.value.path()).read_bytes()
    assert content[4:8] == b"ftyp" or content[:4] == b"\x1a\x45\xdf\xa3"
    # Another page plays it: of a turn's length, and other pictures at other times.
    viewer = page.context.new_page()
    watch = """async (data) => {
        const bytes = Uint8Array.from(atob(data), (sign) => sign.charCodeAt(0)), video = document.createElement("video");
        const at = (time) => new Promise((resolve) => { video.onseeked = resolve; video.currentTime = time; });
        video.src = URL.createObjectURL(new Blob([bytes]));
        await new Promise((resolve, reject) => { video.onloadeddata = resolve; video.onerror = reject; });
        await at(1e5);
        const length = video.duration, canvas = document.createElement("canvas"), paper = canvas.getContext("2d"), seen = [];
        [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
        for (const share of [0.1, 0.5, 0.9]) {
            await at(share * length);
            paper.drawImage(video, 0, 0);
            seen.push([...paper.getImageData(0, 0, canvas.width, canvas.height).data].reduce((sum, x, k) => sum + x * (k % 97), 0));
        }
        return { length, width: canvas.width, seen };
    }"""
    found = viewer.evaluate(watch, b64encode(content).decode())
    assert 0.7 < found["length"] < 2 and found["width"] > 500 and len(set(found["seen"])) == 3


def test_bars_show_the_effect_of_sizes_at_the_frame(folder, opened):
    recipe, file = page_of("crank-rocker", folder)
    tab = opened(file)
    tab.page.select_option(".plot select >> nth=0", label="effect of 1 mm of each size")
    columns = [c for c in recipe.scene.table.columns if "_by_" in c.id]
    for frame in (0, 100):
        go_to(tab.page, frame)
        widths = tab.page.eval_on_selector_all(
            ".legend.bars i", "bars => bars.map((bar) => parseFloat(bar.style.getPropertyValue('--now')))"
        )
        most = max(column.values.max() for column in columns)
        assert widths == pytest.approx([100 * column.values[frame] / most for column in columns], rel=1e-4, abs=1e-4)
    assert not tab.said


def test_switches_show_layers_that_are_hidden_at_first(folder, opened):
    _, file = page_of("crank-rocker", folder)
    page = opened(file).page
    for role in ("velocity", "acceleration", "centre"):
        assert not page.locator(f".mark.{role}").first.is_visible()
        page.click(f".switch.{role} input")
        assert page.locator(f".mark.{role}").first.is_visible()
    assert page.locator("g.names").first.is_visible()
    page.click(".switch.names input")
    assert not page.locator("g.names").first.is_visible()


def test_it_is_looked_at_more_closely_and_that_stays_while_it_moves(folder, opened):
    _, file = page_of("gear-pair", folder)
    tab = opened(file, viewport={"width": 1200, "height": 900})
    page, drawing = tab.page, tab.page.locator("svg.drawing")

    def scale():
        # Of what lies still beneath all that turns.
        return page.evaluate("() => document.querySelector('g.world').getCTM().a")

    whole = scale()
    page.click('button[aria-label="Zoom on the contact"]')
    near = scale()
    assert near > 2 * whole and "times as large" in page.text_content("p.unseen[aria-live]")
    contact, box = page.locator(".mark.contact circle").first.bounding_box(), drawing.bounding_box()
    middle = [contact[a] + contact[s] / 2 - box[a] - box[s] / 2 for a, s in (("x", "width"), ("y", "height"))]
    assert max(map(abs, middle)) < 0.3 * box["width"]
    page.keyboard.press("ArrowRight")
    go_to(page, 50)
    page.set_viewport_size({"width": 1000, "height": 900})
    page.wait_for_timeout(100)
    assert scale() > 2 * whole
    page.keyboard.press("0")
    page.set_viewport_size({"width": 1200, "height": 900})
    page.wait_for_timeout(100)
    assert scale() == pytest.approx(whole)
    # A wheel over a drawing that nobody took up scrolls the page; then it looks closer, and the place under it stays.
    centre = box["x"] + box["width"] / 2, box["y"] + box["height"] / 3
    page.evaluate("() => document.activeElement.blur()")
    page.mouse.move(*centre)
    page.mouse.wheel(0, -300)
    page.wait_for_timeout(100)
    assert scale() == pytest.approx(whole)
    drawing.focus()
    before = page.locator(".mark.fixed-pin").first.bounding_box()
    page.mouse.wheel(0, -300)
    page.wait_for_timeout(100)
    grown = scale() / whole
    assert grown > 1.2
    after = page.locator(".mark.fixed-pin").first.bounding_box()
    for at, size, under in (("x", "width", centre[0]), ("y", "height", centre[1])):
        was, now = (b[at] + b[size] / 2 - under for b in (before, after))
        assert now == pytest.approx(grown * was, abs=12)
    assert frame_of(page) == 50 and not tab.said


def test_dimensions_are_those_of_the_recipe(folder, opened):
    recipe, file = page_of("crank-rocker", folder)
    page = opened(file).page
    assert not page.locator(".name.dimension").first.is_visible()
    page.click(".switch.dimension input")
    reported = [text.text_content() for text in page.locator(".name.dimension:visible").all()]
    assert {f"{getattr(recipe.linkage, name):g} mm" for name in ("ground", "crank", "coupler", "rocker")} == set(
        reported
    )


def test_every_control_is_reached_by_keys_and_has_a_name(folder, opened):
    _, file = page_of("gear-pair", folder)
    page = opened(file).page
    controls = "#player :is(button, select, input, summary, svg.drawing, .u-over)"
    wanted, reached = page.locator(f"{controls}:visible").count(), set()
    for _ in range(wanted + 3):
        page.keyboard.press("Tab")
        k, outline, name = page.evaluate(
            "(controls) => { const at = document.activeElement;"
            " return [[...document.querySelectorAll(controls)].indexOf(at), getComputedStyle(at).outlineStyle,"
            " at.getAttribute('aria-label') || at.labels?.[0]?.textContent || at.textContent]; }",
            controls,
        )
        assert outline != "none" and name.strip()
        reached |= {k} - {-1}
    assert len(reached) == wanted > 15


@pytest.mark.parametrize("name", ["shaking-force", "inflection-circle", "walker"])
def test_no_name_is_cut_by_the_edge_of_a_narrow_drawing(name, folder, opened):
    recipe, file = page_of(name, folder)
    page = opened(file, viewport={"width": 320, "height": 800}).page
    for frame in range(0, len(recipe.scene.time), 45):
        go_to(page, frame)
        reported = page.evaluate("""() => {
          const { left, right } = document.querySelector("svg.drawing").getBoundingClientRect();
          const seen = [...document.querySelectorAll("text.name:not(.off)")].filter((text) => text.checkVisibility({ visibilityProperty: true }));
          return seen.map((text) => [text.textContent, text.getBoundingClientRect()]).filter(([, box]) => box.right > left && box.left < right)
            .map(([text, box]) => [text, box.left - left, right - box.right]);
        }""")
        assert len(reported) > 2 and all(min(room) >= 0 for _, *room in reported), reported
        assert not any("copy" in text and "foot" not in text for text, *_ in reported)


SEEN = """() => [...document.querySelectorAll("svg.drawing")].map((svg) => [...svg.querySelectorAll("text.name:not(.off)")]
  .filter((text) => text.checkVisibility({ visibilityProperty: true })).map((text) => text.getBoundingClientRect())
  .map((box) => [box.left, box.right, box.top, box.bottom]))"""


@pytest.mark.parametrize("width", [360, 1400])
@pytest.mark.parametrize("name", ["crank-rocker", "walking-leg", "sieve", "cognates", "inflection-circle", "gear-pair"])
def test_no_name_lies_over_another(name, width, folder, opened):
    recipe, file = page_of(name, folder)
    page = opened(file, viewport={"width": width, "height": 800}).page
    page.evaluate("for (const box of document.querySelectorAll('.switch input')) if (!box.checked) box.click()")
    for frame in range(0, len(recipe.scene.time), 30):
        go_to(page, frame)
        for names in page.evaluate(SEEN):
            assert names
            for (a, b, c, d), (e, f, g, h) in combinations(names, 2):
                # Positions are written in hundredths of a pixel.
                assert a >= f or e >= b or c >= h - 0.01 or g >= d - 0.01


@pytest.mark.parametrize("name", ["slider-crank", "roller-cam"])
def test_the_name_of_the_ground_is_where_its_plate_is_seen(name, folder, opened):
    recipe, file = page_of(name, folder)
    page = opened(file).page
    seen = []
    for frame in range(0, len(recipe.scene.time), 30):
        go_to(page, frame)
        seen.append(
            page.evaluate("""() => {
          const name = [...document.querySelectorAll("text.name")].find((text) => text.textContent === "ground");
          const { left, right, top, bottom } = name.getBoundingClientRect();
          return document.elementFromPoint((left + right) / 2, (top + bottom) / 2).closest("[data-body]")?.dataset.body;
        }""")
        )
    # The coupler passes over all of the bar of a slider-crank.
    assert seen.count("ground") >= 0.7 * len(seen)


@pytest.mark.parametrize("name", ["crank-rocker", "slider-crank", "walking-leg", "gear-pair"])
def test_on_a_phone_play_and_slider_are_on_the_first_screen_and_large_enough_for_fingers(name, folder, opened):
    _, file = page_of(name, folder)
    page = opened(file, viewport={"width": 360, "height": 640}, is_mobile=True, has_touch=True).page
    low = "(what) => document.querySelector(what).getBoundingClientRect().bottom"
    assert max(page.evaluate(low, what) for what in ("button[aria-label=Play]", ".drive input")) < 480
    targets = page.evaluate("""() => [...document.querySelectorAll("button, select, input, summary, .touch")]
      .map((target) => target.getBoundingClientRect()).filter((box) => box.width).map((box) => [box.width, box.height])""")
    assert len(targets) > 15 and min(map(min, targets)) >= 24


def test_prints_all_of_it(folder, opened):
    _, file = page_of("crank-rocker", folder)
    page = opened(file, color_scheme="dark").page
    assert not page.is_visible(".values table")
    page.emulate_media(media="print")
    assert page.is_visible(".values table")
    assert page.is_visible("svg.drawing") and page.is_visible("#checks") and not page.is_visible(".controls")
    assert len(page.pdf()) > 20_000


NOTEBOOK = {
    "linkage": lambda: gk.FourBar(100, 30, 90, 70, 40 + 25j),
    "pair": lambda: gk.GearPair(gk.SpurGear(12, 3, 0.6), gk.SpurGear(24, 3, 0.36)),
    "curve": lambda: gk.CouplerCurve(gk.FourBar(100, 30, 90, 70, 40 + 25j), "coupler_point"),
    "parts": lambda: gk.load(RECIPES / "crank-rocker.toml").parts,
    "nasty": lambda: gk.load(RECIPES / "crank-rocker.toml").with_name(
        '</script></iframe><img src=x onerror="alert(1)">\'&\u202ea'
    ),
}


@pytest.mark.parametrize("what", NOTEBOOK)
def test_a_notebook_s_frame_moves_as_the_page_does_and_reaches_nothing(what, folder, chromium):
    """The frame stands in a page as strict as any: it runs by its own policy, in a world of its own."""
    cell = folder / f"{what}-cell.html"
    cell.write_text(f"<!doctype html><title>cell</title><div id=output>{gk.show(NOTEBOOK[what]())._repr_html_()}</div>")
    context = chromium.new_context(offline=True, viewport={"width": 900, "height": 800})
    page, said, asked = context.new_page(), [], []
    page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(cell.resolve().as_uri())
    frame = page.frame_locator("iframe")
    frame.locator("#player[data-ready]").wait_for()
    if what != "parts":
        frame.locator("#player[data-frame='0']").wait_for(state="detached")
    assert page.locator("img").count() == frame.locator("img").count() == 0 and page.locator("body > *").count() == 1
    inner = page.frames[1]
    assert inner.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert inner.evaluate("document.querySelector('svg.drawing').getBoundingClientRect().bottom < window.innerHeight")
    assert inner.evaluate("(() => { try { return !parent.document } catch { return true } })()")
    assert not said and set(asked) <= {cell.resolve().as_uri(), "about:srcdoc", "data:,"}
    page.screenshot(path=str(folder / f"{what}.png"))
    context.close()


def test_the_index_is_searched_by_words(chromium, tmp_path):
    for name in ("crank-rocker", "planetary", "geneva"):
        gk.make(RECIPES / f"{name}.toml", tmp_path, only=["assembly-svg"])
    gk.index(tmp_path)
    page = chromium.new_page(offline=True)
    said = []
    page.on("console", lambda message: said.append(message.text))
    page.goto((tmp_path / "index.html").as_uri())
    found = {
        wish: (
            page.fill("#search", wish),
            page.locator("h2:visible").count(),
            page.locator("h3:visible").all_inner_texts(),
        )
        for wish in ("an epicyclic", "something with steps of a maltese cross", "xyzzy", "")
    }
    assert [names for _, _, names in found.values()] == [
        ["planetary"],
        ["geneva"],
        [],
        ["crank-rocker", "planetary", "geneva"],
    ]
    assert [groups for _, groups, _ in found.values()] == [1, 1, 0, 3] and page.is_hidden("#no-match") and not said
    page.close()
