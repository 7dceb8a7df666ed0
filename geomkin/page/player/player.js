// The player: shows a scene moving, with its plots; mouse, touch and keys move the driver.
import { Drawing, FOOT, MARGIN } from "./drawing.js";
import { film, filmType } from "./film.js";
import { followPointers } from "./hands.js";
import { mountRecipe } from "./links.js";
import { drawingFile, drawingImage, offer } from "./pictures.js";
import { measured, Plots, read, shown, unitOf } from "./plots.js";
import { abs, floor, make, max, min, spaced } from "./shapes.js";

// Seconds of one pass at the first speed, approximately: a faster motion cannot be followed.
const FIRST_PASS = 5;
const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
// Rotation of the driver, deg, of a dash of a trail, and the most dashes of a whole motion.
const DASH_DEG = 5, MOST_DASHES = 72;
// Milliseconds between updates of the values while it plays; faster ones cannot be read.
const READING = 120;
// Zoom of one press of a key or button, and movement of the view by an arrow key, px.
const CLOSER = 1.4, MOVE = 40;
const DRAG = "Drag a link to move the mechanism. ";
const HINT = "Zoom with + and −, or with the wheel after a click on the drawing; 0 shows the whole mechanism.";
// Pixels between two drawings, as the style has it.
const GAP = 12;

export function mount(root, data) {
  const player = new Player(root, read(data));
  root.dataset.ready = "";
  return player;
}

class Player {
  constructor(root, data) {
    Object.assign(this, { root, frame: 0, playing: false, written: 0, spent: 0, drawn: 0, scenes: 0, drawings: [] });
    this.left = make(root, "div", { class: "left" });
    this.stages = make(this.left, "div", { class: "stages" });
    this.controls();
    this.set = make(this.left, "fieldset", { class: "switches" });
    this.hint = make(this.left, "p", { class: "hint" });
    this.live = make(root, "p", { class: "unseen", "aria-live": "polite" });
    this.right = make(root, "div", { class: "right" });
    this.load(data);
    this.plots = new Plots(this.right, data, (frame) => { this.play(false); this.goTo(frame); });
    const save = make(this.right, "button", { type: "button", class: "save" }, "Data as CSV");
    save.addEventListener("click", () => offer(this.csv(), `${this.data.name}.csv`, "text/csv"));
    this.addTable();
    this.fillTable();
    this.wire();
    this.fit();
    this.goTo(0);
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.play(true);
  }

  // Shows another scene in place of this one: view, driver position, speed and the chosen plots stay, and it plays on.
  replace(data) {
    const { drive } = this, at = drive.row[this.frame], drawings = this.drawings.length;
    this.load(read(data));
    const same = this.drive.name === drive.name && isFinite(at);
    const off = same ? [...this.drive.row].map((value) => abs(value - at)) : [];
    this.frame = same ? off.indexOf(min(...off)) : min(this.frame, data.frames - 1);
    this.clock = this.time[this.frame];
    this.plots.load(data);
    this.fillTable();
    for (const drawing of this.drawings) drawing.frame = this.frame;
    if (drawings === this.drawings.length) for (const drawing of this.shownDrawings) drawing.look(drawing.by, drawing.at);
    else this.fit(true);
    this.show(true);
  }

  load(data) {
    const drive = data.columns[0], { row } = drive;
    Object.assign(this, { data, drive, time: data.rows[data.time] });
    const span = abs(row[data.frames - 1] - row[0]), several = data.scenes.length > 1;
    const every = max(drive.unit === "deg" ? DASH_DEG : 0, span / MOST_DASHES) || 1;
    data.scenes.forEach((scene, k) => {
      const drawing = this.drawings[k] ?? this.addDrawing();
      drawing.caption.textContent = k ? spaced(scene.label) : "as designed";
      drawing.caption.hidden = !several;
      drawing.load(scene, data, row, every);
    });
    for (const { svg } of this.drawings.splice(data.scenes.length)) svg.closest("figure").remove();
    // A scene with a single frame cannot be played.
    this.root.classList.toggle("still", data.frames < 2);
    this.hint.textContent = data.frames > 1 ? DRAG + HINT : HINT;
    this.label.textContent = drive.name;
    this.slider.max = data.frames - 1;
    this.shade();
    this.contact.hidden = !this.drawings[0].contacts.length;
    if (!this.speed.value) this.speed.value = this.firstSpeed();
    this.switches();
    this.root.dataset.scenes = this.scenes += 1;
  }

  // Shades the range of the driver in which the mechanism cannot be assembled.
  shade() {
    const { bodies, marks, frames } = this.drawings[0], moving = [...bodies.filter(({ fixed }) => !fixed), ...marks.filter(({ always }) => always)];
    const open = Array.from({ length: frames }, (_, k) => moving.some(({ x }) => !isFinite(x[k])));
    const edges = [...open.keys()].filter((k) => k && open[k] !== open[k - 1]), stops = [], part = (k) => `${100 * k / max(frames - 1, 1)}%`;
    [0, ...edges].forEach((from, k) => stops.push(`${open[from] ? "var(--bad)" : "transparent"} ${part(from)} ${part(edges[k] ?? frames - 1)}`));
    const isWhole = !open.includes(true);
    this.slider.classList.toggle("limited", !isWhole);
    this.slider.style.setProperty("--reach", isWhole ? "none" : `linear-gradient(to right, ${stops.join(", ")})`);
  }

  addDrawing() {
    const figure = make(this.stages, "figure", this.drawings.length ? { class: "other" } : {});
    const drawing = new Drawing(make(figure, "div", { class: "stage" }), this.drawings[0]?.hidden);
    drawing.caption = make(figure, "figcaption");
    followPointers(drawing, this, () => this.announceZoom(drawing));
    this.drawings.push(drawing);
    return drawing;
  }

  controls() {
    const bar = make(this.left, "div", { class: "controls" });
    const button = (label, sign, act) => {
      const made = make(bar, "button", { type: "button", "aria-label": label, title: label }, sign);
      made.addEventListener("click", act);
      return made;
    };
    this.button = button("Play", "▶", () => this.play(!this.playing));
    button("One step back", "‹", () => { this.play(false); this.step(-1); });
    button("One step on", "›", () => { this.play(false); this.step(1); });
    button("Zoom out", "−", () => this.zoom(1 / CLOSER));
    button("Zoom in", "+", () => this.zoom(CLOSER));
    button("Show all of it", "⤢", () => this.zoom(0));
    const picture = (label, sign, tail, make) => button(label, sign, async () => {
      for (const [k, drawing] of this.shownDrawings.entries()) {
        offer(await make(drawing), `${this.data.name}-${this.frame}${k ? `-${k + 1}` : ""}.${tail}`, "image/svg+xml");
      }
    });
    picture("Drawing at this frame as SVG", "SVG", "svg", drawingFile);
    picture("Drawing at this frame as PNG", "PNG", "png", drawingImage);
    this.filmed = button("The motion as a film", "Film", () => this.film());
    this.filmed.hidden = !filmType;
    this.contact = button("Zoom on the contact", "contact", () => {
      this.drawings[0].lookAtContact();
      this.announceZoom(this.drawings[0]);
    });
    const pace = make(bar, "label", { class: "speed" });
    make(pace, "span", {}, "Speed ");
    this.speed = make(pace, "select");
    for (const speed of SPEEDS) make(this.speed, "option", { value: speed }, `${speed} × real`);
    this.speed.value = "";
    const label = make(this.left, "label", { class: "drive" });
    this.label = make(label, "span");
    this.slider = make(label, "input", { type: "range", min: 0, step: 1, value: 0 });
    this.value = make(label, "output");
    this.slider.addEventListener("input", () => { this.play(false); this.goTo(+this.slider.value); });
  }

  firstSpeed() {
    const pass = this.time[this.data.frames - 1] - this.time[0] || 1, off = (speed) => abs(Math.log(pass / speed / FIRST_PASS));
    return SPEEDS.reduce((a, b) => (off(b) < off(a) ? b : a));
  }

  // A switch for each role that the drawings use; they stay as they are if the next scene uses the same ones.
  switches() {
    const { drawings } = this, used = new Set(["names", ...drawings.flatMap((drawing) => [...drawing.roles])]);
    const scaleOf = (role) => {
      const scales = new Set(drawings[0].marks.flatMap((mark) => (mark.role === role ? mark.label.match(/1 \w+ is .*/) ?? [] : [])));
      return scales.size === 1 ? ` (${unitOf([...scales][0])})` : "";
    };
    const roles = [{ id: "names", label: "names", shown: true }, ...this.data.roles].filter(({ id }) => used.has(id))
      .map((role) => ({ ...role, label: role.label + scaleOf(role.id) }));
    const key = JSON.stringify([roles, drawings.length > 1]);
    if (key === this.switched) return;
    this.switched = key;
    const before = Object.fromEntries([...this.set.querySelectorAll("input")].map((box) => [box.name, box.checked]));
    this.set.replaceChildren();
    make(this.set, "legend", {}, "Shown");
    const add = (name, key, on, act) => {
      const label = make(this.set, "label", { class: `switch ${key}` });
      const box = make(label, "input", { type: "checkbox", name: key });
      box.checked = before[key] ?? on;
      const sign = make(label, "svg", { width: 18, height: 10, viewBox: "0 0 18 10", "aria-hidden": "true" });
      if (key !== "names") make(sign, "path", { d: "M0 5H18" });
      label.append(name);
      box.addEventListener("change", () => { act(box.checked); this.fit(true); });
      act(box.checked);
    };
    for (const { id, label, shown } of roles) add(label, id, shown, (on) => { for (const drawing of drawings) drawing.toggle(id, on); });
    if (drawings.length > 1) add("other assembly mode", "others", false, (on) => this.stages.classList.toggle("alone", !on));
  }

  // The content of the plots as a table: the current, least and largest value of each quantity, and their positions.
  addTable() {
    // The table is not inside the element that folds it away, so that it prints in either case.
    const section = make(this.root, "section", { class: "values" });
    make(make(section, "details"), "summary", {}, "Every quantity, now and at its least and largest");
    this.table = make(make(section, "div", { class: "wide", tabindex: 0, role: "region", "aria-label": "Values" }), "table");
  }

  fillTable() {
    const { drive, table, data: { columns } } = this;
    table.replaceChildren();
    const head = make(make(table, "thead"), "tr"), body = make(table, "tbody");
    const at = `at ${drive.name}, ${unitOf(drive.unit)}`;
    for (const title of ["Quantity", "Unit", "Now", "Least", at, "Largest", at]) make(head, "th", { scope: "col" }, title);
    this.cells = columns.map(({ row, meaning, unit }) => {
      const line = make(body, "tr");
      make(line, "th", { scope: "row" }, meaning);
      make(line, "td", {}, unitOf(unit));
      const now = make(line, "td"), known = [...row.keys()].filter((k) => isFinite(row[k]));
      for (const sense of [1, -1]) {
        const k = known.reduce((best, other) => (sense * row[other] < sense * row[best] ? other : best), known[0]);
        make(line, "td", {}, shown(row[k]));
        make(line, "td", {}, shown(drive.row[k]));
      }
      return now;
    });
  }

  wire() {
    document.addEventListener("keydown", (event) => this.key(event));
    const resized = new ResizeObserver(() => this.fit());
    for (const element of [this.left, this.stages]) resized.observe(element);
    const rebuild = () => this.plots.rebuild();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", rebuild);
    addEventListener("beforeprint", () => { this.play(false); document.documentElement.classList.add("print"); rebuild(); });
    addEventListener("afterprint", () => { document.documentElement.classList.remove("print"); rebuild(); });
    for (const button of document.querySelectorAll("button[data-frame]")) {
      button.addEventListener("click", () => {
        this.play(false);
        this.goTo(+button.dataset.frame);
        this.root.scrollIntoView({ block: "start" });
      });
    }
    mountRecipe(this.data.name);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const at = event.target, own = at.closest?.("button, select, summary, a, .wide, pre, textarea, [data-handle], input:not([type=range])");
    const times = { "+": CLOSER, "=": CLOSER, "-": 1 / CLOSER, 0: 0 }[event.key];
    if (times !== undefined && !at.closest?.("select, textarea, input:not([type=checkbox])")) { this.zoom(times); return; }
    if (event.key === " " && !own) { event.preventDefault(); this.play(!this.playing); return; }
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
    const zoomed = this.drawings.find(({ svg, by }) => svg === at && by > 1);
    const move = { ArrowLeft: [MOVE, 0], ArrowRight: [-MOVE, 0], ArrowDown: [0, -MOVE], ArrowUp: [0, MOVE] }[event.key];
    if (zoomed && move) { event.preventDefault(); zoomed.pan(...move); return; }
    const sideways = event.key === "ArrowLeft" || event.key === "ArrowRight";
    if (!step || own || (!sideways && at.getAttribute?.("role") !== "slider") || at === this.slider) return;
    event.preventDefault();
    this.play(false);
    this.step(event.shiftKey ? 10 * step : step);
  }

  get shownDrawings() { return this.stages.classList.contains("alone") ? [this.drawings[0]] : this.drawings; }

  get isFilled() { return this.root.classList.contains("filled") && matchMedia("(min-width: 901px)").matches; }

  // Sizes the drawings to fill the page, all at the same scale.
  fit(changed) {
    // On a stage of a given height the drawings fill it.
    const room = this.stages.clientWidth, height = this.isFilled ? this.stages.clientHeight : 0;
    if (room < 50 || (room === this.room && height === this.height && !changed)) return;
    Object.assign(this, { room, height });
    const drawings = this.shownDrawings;
    const columns = room > 620 || height ? min(2, drawings.length) : 1;
    const sizes = drawings.map((drawing) => drawing.size()), widest = max(...sizes.map(([across]) => across));
    // Two side by side share the width in proportion to their needs; any other number have equal widths.
    const needs = sizes.map(([across]) => (columns === drawings.length ? max(across, widest / 4) : widest));
    const sum = columns === drawings.length ? needs.reduce((a, b) => a + b) : columns * widest;
    const free = room - GAP * (columns - 1) - 2 * MARGIN * columns, foot = 2 * MARGIN + FOOT;
    const tallest = max(...sizes.map(([, up]) => up)), most = (height || max(260, 0.62 * innerHeight)) - foot;
    const scale = min(free / sum, most / tallest), tall = (up) => height || max(150, scale * up + foot);
    drawings.forEach((drawing, k) => drawing.fit(floor(2 * MARGIN + free * needs[k] / sum), tall(columns > 1 ? tallest : sizes[k][1]), scale));
  }

  // Fits them to all that there is now.
  refit() {
    for (const drawing of this.drawings) drawing.room = drawing.roomNow?.() ?? [];
    this.fit(true);
  }

  zoom(times) {
    if (!times) this.refit();
    for (const drawing of this.shownDrawings) drawing.zoom(times);
    this.announceZoom(this.drawings[0]);
  }

  announceZoom({ by }) { this.live.textContent = by > 1 ? `Shown ${by.toPrecision(2)} times as large` : "All of it is shown"; }

  play(on) {
    if (on === this.playing || this.data.frames < 2) return;
    this.playing = on;
    this.button.textContent = on ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", on ? "Pause" : "Play");
    this.button.title = on ? "Pause" : "Play";
    this.root.classList.toggle("playing", on);
    if (!on) { this.show(true); return; }
    if (!this.data.cyclic && this.frame === this.data.frames - 1) this.frame = 0;
    this.clock = this.time[this.frame];
    this.way = 1;
    this.before = undefined;
    requestAnimationFrame((now) => this.tick(now));
  }

  // Advances by the time that has passed; a motion that is not cyclic runs back again.
  tick(now) {
    if (!this.playing) return;
    const start = performance.now();
    const [first, last] = [this.time[0], this.time[this.data.frames - 1]], pass = last - first;
    this.clock += this.way * min(0.1, (now - (this.before ?? now)) / 1000) * this.speed.value;
    this.before = now;
    if (this.data.cyclic) this.clock = first + ((((this.clock - first) % pass) + pass) % pass);
    else if (this.clock > last || this.clock < first) {
      this.way = this.clock > last ? -1 : 1;
      this.clock = min(last, max(first, this.clock));
    }
    this.frame = this.at(this.clock);
    this.show(now - this.written > READING);
    this.spent += performance.now() - start;
    this.drawn += 1;
    // Milliseconds of script per frame, for measurements.
    if (this.drawn % 30 === 0) this.root.dataset.cost = (this.spent / this.drawn).toFixed(3);
    requestAnimationFrame((next) => this.tick(next));
  }

  // The frame that is nearest in time.
  at(time) {
    let low = 0, high = this.data.frames - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= time) low = middle; else high = middle;
    }
    return time - this.time[low] < this.time[high] - time ? low : high;
  }

  step(by) {
    const { frames, cyclic } = this.data, last = frames - 1;
    // The last frame of a turn is the first again.
    this.goTo(cyclic ? (((this.frame + by) % last) + last) % last : min(last, max(0, this.frame + by)));
  }

  goTo(frame) {
    this.frame = min(this.data.frames - 1, max(0, frame));
    this.clock = this.time[this.frame];
    this.show(true);
  }

  show(values) {
    const { frame } = this;
    for (const drawing of this.drawings) drawing.show(frame);
    this.plots.show(frame, values);
    this.slider.value = frame;
    if (!values) return;
    this.written = performance.now();
    this.value.textContent = measured(this.drive.row[frame], this.drive.unit);
    this.root.dataset.frame = frame;
    this.slider.setAttribute("aria-valuetext", `${this.drive.name} ${shown(this.drive.row[frame])} ${this.drive.unit}`);
    if (this.playing) return;
    this.cells.forEach((cell, k) => { cell.textContent = shown(this.data.columns[k].row[frame]); });
    const said = this.plots.cards.flatMap((card) => card.columns).map((c) => `${c.name} ${shown(c.row[frame])} ${c.unit}`);
    this.live.textContent = `${this.drive.name} ${shown(this.drive.row[frame])} ${this.drive.unit}: ${said.join(", ")}`;
  }

  // Saves a pass at the chosen speed as a film, forth and back if it is not cyclic; a second click gives up.
  async film() {
    const { filmed, frame, time, data: { cyclic, frames, name } } = this, [first, last] = [time[0], time[frames - 1]];
    this.filming = !this.filming;
    if (!this.filming || frames < 2) return;
    this.play(false);
    const show = (share) => this.goTo(this.at(first + (last - first) * (cyclic ? share : 1 - abs(1 - 2 * share))));
    const report = (share) => { filmed.textContent = `${floor(100 * share)} %`; return this.filming; };
    try {
      const made = await film(this.drawings[0], (cyclic ? 1 : 2) * (last - first) / this.speed.value, show, report);
      if (made) offer(made, `${name}.${made.type.split("/")[1]}`, made.type);
    } finally {
      this.filming = false;
      filmed.textContent = "Film";
      this.goTo(frame);
    }
  }

  csv() {
    const { columns, frames } = this.data;
    const lines = [columns.map((column) => column.header).join(",")];
    for (let k = 0; k < frames; k++) lines.push(columns.map(({ row }) => (isFinite(row[k]) ? +row[k].toPrecision(7) : "")).join(","));
    return `${lines.join("\n")}\n`;
  }
}
