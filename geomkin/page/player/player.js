// The player: takes a scene as data and shows it moving, beside its plots, with what turns it by mouse, touch and keys.
import { Drawing, FOOT, MARGIN } from "./drawing.js";
import { handle } from "./hands.js";
import { measured, Plots, read, shown, unitOf } from "./plots.js";
import { abs, floor, make, max, min, spaced } from "./shapes.js";

// Seconds that one pass takes at first, nearly: what turns faster cannot be followed.
const FIRST_PASS = 5;
const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
// Turn of the driver, deg, between two dashes of a trail; a driver that slides makes so many steps over its stroke.
const DASH_DEG = 5, STROKE_DASHES = 72;
// Milliseconds between two times that values are written while it plays: eyes read no faster.
const READING = 120;
// How much closer a key or a button takes one, and how far the arrows move what is seen, px.
const CLOSER = 1.4, MOVE = 40;
const DRAG = "Drag a link and the rest follows. ";
const HINT = "+ and − look closer, or the wheel once it is clicked; 0 shows all.";
// Pixels between two drawings, as the style has it.
const GAP = 12;

export function mount(root, data) {
  read(data);
  const player = new Player(root, data);
  root.dataset.ready = "";
  return player;
}

class Player {
  constructor(root, data) {
    Object.assign(this, { root, data, frame: 0, playing: false, written: 0, spent: 0, drawn: 0 });
    this.drive = data.columns[0];
    this.time = data.rows[data.time];
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.build();
    this.wire();
    this.fit();
    this.goTo(0);
    if (!calm) this.play(true);
  }

  build() {
    const { root, data, drive } = this;
    const span = abs(drive.row[data.frames - 1] - drive.row[0]);
    const every = drive.unit === "deg" ? DASH_DEG : span / STROKE_DASHES || 1;
    this.left = make(root, "div", { class: "left" });
    this.stages = make(this.left, "div", { class: "stages" });
    this.drawings = data.scenes.map((scene, k) => {
      const figure = make(this.stages, "figure", k ? { class: "other" } : {});
      const stage = make(figure, "div", { class: "stage" });
      if (data.scenes.length > 1) make(figure, "figcaption", {}, k ? spaced(scene.label) : "as asked for");
      return new Drawing(stage, scene, data, drive.row, every);
    });
    this.controls();
    this.switches();
    make(this.left, "p", { class: "hint" }, data.frames > 1 ? DRAG + HINT : HINT);
    this.live = make(root, "p", { class: "unseen", "aria-live": "polite" });
    this.right = make(root, "div", { class: "right" });
    this.plots = new Plots(this.right, data, (frame) => { this.play(false); this.goTo(frame); });
    const save = make(this.right, "button", { type: "button", class: "save" }, "Data as CSV");
    save.addEventListener("click", () => offer(this.csv(), `${data.name}.csv`, "text/csv"));
    this.tabulate();
  }

  controls() {
    const { drive, data } = this, bar = make(this.left, "div", { class: "controls" });
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
    if (this.drawings[0].contacts.length) button("Zoom on the contact", "contact", () => {
      this.drawings[0].lookAtContact();
      this.closer(this.drawings[0]);
    });
    // What stands still has nothing to be played.
    this.root.classList.toggle("still", data.frames < 2);
    const pass = this.time[data.frames - 1] - this.time[0] || 1;
    const first = SPEEDS.reduce((a, b) => (abs(Math.log(pass / b / FIRST_PASS)) < abs(Math.log(pass / a / FIRST_PASS)) ? b : a));
    const pace = make(bar, "label", { class: "speed" });
    make(pace, "span", {}, "Speed ");
    this.speed = make(pace, "select");
    for (const speed of SPEEDS) make(this.speed, "option", { value: speed }, `${speed} × real`);
    this.speed.value = first;
    const label = make(this.left, "label", { class: "drive" });
    make(label, "span", {}, drive.name);
    this.slider = make(label, "input", { type: "range", min: 0, max: data.frames - 1, step: 1, value: 0 });
    this.value = make(label, "output");
    this.slider.addEventListener("input", () => { this.play(false); this.goTo(+this.slider.value); });
  }

  switches() {
    const found = new Set(["names", ...this.drawings.flatMap((drawing) => [...drawing.roles])]);
    const roles = [{ id: "names", label: "names", shown: true }, ...this.data.roles];
    const set = make(this.left, "fieldset", { class: "switches" });
    const scaleOf = (role) => {
      const told = this.drawings[0].marks.flatMap((mark) => (mark.role === role ? mark.label.match(/1 mm is .*/) ?? [] : []));
      return new Set(told).size === 1 ? unitOf(told[0]) : "";
    };
    make(set, "legend", {}, "Shown");
    const add = (name, key, on, act) => {
      const label = make(set, "label", { class: `switch ${key}` });
      const box = make(label, "input", { type: "checkbox" });
      box.checked = on;
      const sign = make(label, "svg", { width: 18, height: 10, viewBox: "0 0 18 10", "aria-hidden": "true" });
      if (key !== "names") make(sign, "path", { d: "M0 5H18" });
      label.append(name);
      box.addEventListener("change", () => { act(box.checked); this.fit(true); });
      act(on);
    };
    for (const { id, label, shown } of roles) {
      const scale = scaleOf(id);
      if (found.has(id)) add(scale ? `${label} (${scale})` : label, id, shown, (on) => {
        for (const drawing of this.drawings) drawing.toggle(id, on);
      });
    }
    if (this.drawings.length > 1) add("others beside", "others", true, (on) => this.stages.classList.toggle("alone", !on));
  }

  // What the plots show for readers who see none: every quantity now, its least and its largest value and where.
  tabulate() {
    const { data, drive } = this, { columns } = data;
    // The table stands after what folds it away, so that it prints in either case.
    const section = make(this.root, "section", { class: "values" });
    make(make(section, "details"), "summary", {}, "Every quantity, now and at its least and largest");
    const table = make(make(section, "div", { class: "wide", tabindex: 0, role: "region", "aria-label": "Values" }), "table");
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
    this.drawings.forEach((drawing) => handle(drawing, this, () => this.closer(drawing)));
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.fit()).observe(this.left);
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
    const recipe = document.getElementById("save-recipe");
    recipe?.addEventListener("click", () => offer(`${document.getElementById("recipe-text").textContent}\n`, `${this.data.name}.toml`, "text/plain"));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const at = event.target, own = at.closest?.("button, select, summary, a, .wide, pre, input[type=checkbox]");
    const times = { "+": CLOSER, "=": CLOSER, "-": 1 / CLOSER, 0: 0 }[event.key];
    if (times !== undefined && !at.closest?.("select, input[type=range]")) { this.zoom(times); return; }
    if (event.key === " " && !own) { event.preventDefault(); this.play(!this.playing); return; }
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
    const seen = this.drawings.find(({ svg, by }) => svg === at && by > 1);
    const move = { ArrowLeft: [MOVE, 0], ArrowRight: [-MOVE, 0], ArrowDown: [0, -MOVE], ArrowUp: [0, MOVE] }[event.key];
    if (seen && move) { event.preventDefault(); seen.pan(...move); return; }
    const sideways = event.key === "ArrowLeft" || event.key === "ArrowRight";
    if (!step || own || (!sideways && at.getAttribute?.("role") !== "slider") || at === this.slider) return;
    event.preventDefault();
    this.play(false);
    this.step(event.shiftKey ? 10 * step : step);
  }

  // Drawings as large as there is room for, all at one scale; at once where they changed.
  fit(changed) {
    const room = this.stages.clientWidth;
    if (room < 50 || (room === this.room && !changed)) return;
    this.room = room;
    const drawings = this.stages.classList.contains("alone") ? [this.drawings[0]] : this.drawings;
    const columns = room > 620 ? min(2, drawings.length) : 1;
    const sizes = drawings.map((drawing) => drawing.size()), widest = max(...sizes.map(([across]) => across));
    // Two side by side share the width by what they need; of any other number all are as wide.
    const needs = sizes.map(([across]) => (columns === drawings.length ? max(across, widest / 4) : widest));
    const sum = columns === drawings.length ? needs.reduce((a, b) => a + b) : columns * widest;
    const free = room - GAP * (columns - 1) - 2 * MARGIN * columns, foot = 2 * MARGIN + FOOT;
    const tallest = max(...sizes.map(([, up]) => up)), most = max(260, 0.62 * innerHeight) - foot;
    const scale = min(free / sum, most / tallest), tall = (up) => max(150, scale * up + foot);
    drawings.forEach((drawing, k) => drawing.fit(floor(2 * MARGIN + free * needs[k] / sum), tall(columns > 1 ? tallest : sizes[k][1]), scale));
  }

  zoom(times) {
    for (const drawing of this.drawings) drawing.zoom(times);
    this.closer(this.drawings[0]);
  }

  closer({ by }) { this.live.textContent = by > 1 ? `Shown ${by.toPrecision(2)} times as large` : "All of it is shown"; }

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

  // On by the time that has passed; what cannot go round goes back again.
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
    // Milliseconds of script that a frame takes, for whoever measures it.
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

  show(told) {
    const { frame } = this;
    for (const drawing of this.drawings) drawing.show(frame);
    this.plots.show(frame, told);
    this.slider.value = frame;
    if (!told) return;
    this.written = performance.now();
    this.value.textContent = measured(this.drive.row[frame], this.drive.unit);
    this.root.dataset.frame = frame;
    this.slider.setAttribute("aria-valuetext", `${this.drive.name} ${shown(this.drive.row[frame])} ${this.drive.unit}`);
    if (this.playing) return;
    this.cells.forEach((cell, k) => { cell.textContent = shown(this.data.columns[k].row[frame]); });
    const said = this.plots.cards.flatMap((card) => card.columns).map((c) => `${c.name} ${shown(c.row[frame])} ${c.unit}`);
    this.live.textContent = `${this.drive.name} ${shown(this.drive.row[frame])} ${this.drive.unit}: ${said.join(", ")}`;
  }

  csv() {
    const { columns, frames } = this.data;
    const lines = [columns.map((column) => column.header).join(",")];
    for (let k = 0; k < frames; k++) lines.push(columns.map(({ row }) => (isFinite(row[k]) ? +row[k].toPrecision(7) : "")).join(","));
    return `${lines.join("\n")}\n`;
  }
}

function offer(text, name, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
