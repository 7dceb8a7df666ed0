// A scene as an SVG drawing: one group a body, of which each frame sets the matrix alone; marks in pixels above them.
import { arrow, axisOf, make, niceLength, pointsOf, px, spaced, STAND } from "./shapes.js";

// Frames at which it is looked where names are in each other's way.
const LOOKS = 24;
// What is off until it is asked for; the drawing makes room for it only then, by so much of its size on each side.
export const OFF = ["centre", "velocity", "acceleration", "centrode", "inflection"];
const ROOM = 0.3;
// Pixels kept free around the drawing.
const MARGIN = 26;
let drawings = 0;

export class Drawing {
  // stage: what the drawing fills; scene, data: as in the page, rows unpacked in data.rows; drive: row of the driver,
  // every: its steps between two dashes of a trail.
  constructor(stage, scene, data, drive, every) {
    this.scene = scene;
    this.data = data;
    this.frames = data.frames;
    this.id = `hatch${drawings++}`;
    this.stage = stage;
    this.hidden = new Set();
    this.open = new Set(scene.open);
    const title = scene.label ? `${data.name}, ${spaced(scene.label)}` : data.name;
    this.svg = make(stage, "svg", { class: "drawing", role: "img", "aria-label": `${title}, drawn at one frame` });
    const pattern = make(make(this.svg, "defs"), "pattern",
      { id: this.id, patternUnits: "userSpaceOnUse", width: 6, height: 6 });
    make(pattern, "path", { d: "M0 0V6", class: "hatch" });
    this.pattern = pattern;
    this.guides = make(this.svg, "g");
    this.plates = make(this.svg, "g");
    this.world = make(this.svg, "g");
    this.trails = make(this.svg, "g");
    this.above = make(this.svg, "g");
    this.names = make(this.svg, "g", { class: "names" });
    this.scaleBar = make(this.svg, "g", { class: "scale" });
    this.notice = make(this.svg, "text", { class: "notice", x: 12, y: 24 });
    this.bodies = scene.bodies.map((body) => this.unpacked(body));
    let tint = 0;
    for (const body of this.bodies) body.tint = body.fixed ? "ground" : `t${tint++ % 8}`;
    for (const body of [...this.bodies].sort((a, b) => a.layer - b.layer)) this.drawBody(body);
    for (const curve of scene.curves) this.drawCurve(curve);
    this.hasGround = this.bodies.some((body) => body.fixed && body.cut.length);
    this.named = new Set();
    this.marks = scene.marks.map((mark) => this.drawMark(mark));
    this.bounds = this.extent();
    // Trails are told in ten-thousandths of the drawing, so that few decimals will do whatever its size.
    this.fine = 1e4 / Math.max(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1], 1e-9);
    for (const mark of this.marks) if (mark.trail) this.drawTrail(mark, drive, every);
    this.sizePins();
    this.anchorNames();
  }

  // A pin fills the hole that it sits in.
  sizePins() {
    const near = 1e-3 * (this.bounds[2] - this.bounds[0] + this.bounds[3] - this.bounds[1]);
    for (const mark of this.marks) {
      const [k] = mark.sort.endsWith("pin") ? this.known(mark) : [];
      if (k === undefined) continue;
      for (const body of this.bodies) for (const { circles } of body.drawn) for (const [u, v, r] of circles) {
        const [x, y] = this.place(body, u, v, k);
        if (Math.hypot(x - mark.x[k], y - mark.y[k]) < near) mark.hole = Math.max(mark.hole ?? 0, r);
      }
    }
  }

  get roles() {
    return new Set([...this.marks.filter((m) => !m.always).map((m) => m.role), ...this.scene.curves.map((c) => c.role)]);
  }

  row(index) { return this.data.rows[index]; }

  unpacked(body) {
    const turn = this.row(body.turn);
    return { ...body, lined: [], x: this.row(body.at[0]), y: this.row(body.at[1]), cos: turn.map(Math.cos), sin: turn.map(Math.sin) };
  }

  drawBody(body) {
    // What of the ground lies over something that moves must not hide it.
    const over = body.fixed && this.bodies.some((other) => !other.fixed && other.layer < body.layer);
    body.group = make(this.plates, "g", { class: `body ${body.fixed ? "fixed" : "moving"}${over ? " over" : ""}` });
    make(body.group, "title", {}, spaced(body.name));
    for (const index of body.cut) {
      const d = this.data.paths[index];
      make(body.group, "path", { d, class: `plate ${body.tint}` });
      if (body.fixed) make(body.group, "path", { d, class: "hatched", fill: `url(#${this.id})` });
    }
    for (const index of body.engraved ?? []) make(body.group, "path", { d: this.data.paths[index], class: "engraved" });
    body.group.dataset.body = body.name;
  }

  drawCurve(curve) {
    const body = this.bodies.find((other) => other.name === curve.body);
    const d = this.data.paths[curve.path];
    const path = make(body ? body.group : this.world, "path", { d, class: `line ${curve.role}`, "data-role": curve.role });
    if (body && !OFF.includes(curve.role)) body.lined.push(...pointsOf(d).points);
    if (curve.label) make(path, "title", {}, spaced(curve.label));
  }

  drawMark(told) {
    const mark = { ...told, x: this.row(told.at[0]), y: this.row(told.at[1]) };
    mark.always = ["pin", "fixed pin", "slide"].includes(mark.sort);
    if (told.vector) [mark.u, mark.v] = told.vector.map((index) => this.row(index));
    if (told.turn !== undefined) mark.turned = this.row(told.turn);
    if (told.radius !== undefined) mark.r = this.row(told.radius);
    const group = make(this.above, "g", { class: `mark ${mark.sort.replace(" ", "-")} ${mark.role}` });
    mark.group = group;
    make(group, "title", {}, spaced(mark.label || mark.sort));
    if (mark.sort === "slide") {
      mark.shape = make(group, "rect", { x: -11, y: -7, width: 22, height: 14, rx: 2 });
      this.drawGuide(mark);
    } else if (mark.sort === "vector" || mark.sort === "line") {
      mark.shape = make(group, "path");
    } else if (mark.sort === "circle") {
      mark.shape = make(group, "circle");
    } else if (mark.role === "centre") {
      mark.shape = make(group, "path", { d: "M-4-4 4 4M-4 4 4-4" });
    } else {
      mark.shape = make(group, "circle", { r: mark.sort === "fixed pin" ? 4.6 : mark.sort === "pin" ? 3.8 : 3.6 });
      if (mark.sort === "fixed pin") make(group, "circle", { r: 1.5, class: "core" });
      if (mark.sort === "fixed pin" && !this.hasGround) make(group, "path", { d: STAND });
    }
    if (mark.sort === "line" && mark.label && !this.named.has(mark.label)) {
      this.named.add(mark.label);
      mark.middle = make(this.names, "text", { class: `name of-body ${mark.role}` }, spaced(mark.label));
    }
    if (!mark.always && mark.sort === "point" && mark.label) {
      const short = spaced(mark.label).replace("instant centre of ", "").replace(" and ", ", ");
      mark.name = make(this.names, "text", { class: `name ${mark.role}`, "data-role": mark.role }, short);
    }
    return mark;
  }

  // A slide that goes along one line of the ground runs on a rail, hatched below, where no plate has a slot for it.
  drawGuide(mark) {
    if (this.hasGround) return;
    const known = this.known(mark);
    if (!known.length) return;
    const [c, s] = [Math.cos(mark.turned[known[0]]), Math.sin(mark.turned[known[0]])];
    const along = known.map((k) => c * mark.x[k] + s * mark.y[k]);
    const beside = known.map((k) => c * mark.y[k] - s * mark.x[k]);
    const [low, high] = [Math.min(...along), Math.max(...along)];
    const still = known.every((k) => Math.abs(Math.sin(mark.turned[k] - mark.turned[known[0]])) < 1e-3);
    if (!still || high - low === 0 || Math.max(...beside) - Math.min(...beside) > 2e-3 * (high - low)) return;
    mark.rail = { c, s, low, high, beside: beside[0], path: make(this.guides, "path", { class: "rail" }) };
  }

  // Every second of the equal steps of the drive: where a dash is long, the point is fast.
  drawTrail(mark, drive, every) {
    let d = "", drawn = false;
    for (let k = 1; k < this.frames; k++) {
      const from = drive[k - 1] - drive[0], to = drive[k] - drive[0];
      if (!Number.isFinite(mark.x[k] + mark.x[k - 1])) { drawn = false; continue; }
      // Steps may end between two frames: the way there is straight.
      for (let at = from; at < to - 1e-9 * every;) {
        const step = Math.floor(at / every + 1e-6), next = Math.min(to, (step + 1) * every);
        if (step % 2 === 0) {
          const [a, b] = [at, next].map((value) => (value - from) / (to - from));
          const between = (row, share) => (this.fine * (row[k - 1] + share * (row[k] - row[k - 1]))).toFixed(1);
          const place = (share) => `${between(mark.x, share)} ${between(mark.y, share)}`;
          d += `${drawn ? "L" : `M${place(a)}L`}${place(b)}`;
        }
        drawn = step % 2 === 0 && next < (step + 1) * every - 1e-9 * every;
        at = next;
      }
    }
    mark.line = make(this.trails, "path", { d, class: `trail ${mark.role}`, "data-role": mark.role });
  }

  known(mark) {
    return [...mark.x.keys()].filter((k) => Number.isFinite(mark.x[k] + mark.y[k]));
  }

  // Left, lower, right and upper end, mm, of all that is always shown, over all frames.
  extent() {
    const ends = [Infinity, Infinity, -Infinity, -Infinity];
    const take = (x, y) => {
      if (!Number.isFinite(x + y)) return;
      ends[0] = Math.min(ends[0], x); ends[1] = Math.min(ends[1], y);
      ends[2] = Math.max(ends[2], x); ends[3] = Math.max(ends[3], y);
    };
    const takeMarks = (marks) => {
      for (const mark of marks) mark.x.forEach((x, k) => {
        const r = mark.r ? mark.r[k] : 0;
        take(x - r, mark.y[k] - r); take(x + r, mark.y[k] + r);
        if (mark.u) take(x + mark.u[k], mark.y[k] + mark.v[k]);
      });
    };
    for (const body of this.bodies) {
      body.drawn = body.cut.map((index) => pointsOf(this.data.paths[index]));
      const points = body.drawn.flatMap((drawn) => drawn.points);
      points.push(...body.lined);
      for (let k = 0; k < this.frames; k++) for (const [u, v] of points) take(...this.place(body, u, v, k));
    }
    takeMarks(this.marks.filter((mark) => !OFF.includes(mark.role)));
    const takeCurves = (wanted) => {
      for (const path of this.world.querySelectorAll("path")) {
        if (!wanted(path.dataset.role)) continue;
        const { x, y, width, height } = path.getBBox();
        take(x, y); take(x + width, y + height);
      }
    };
    takeCurves((role) => !OFF.includes(role));
    if (ends[0] === Infinity) ends.splice(0, 4, -1, -1, 1, 1);
    const always = [...ends], room = [ends[2] - ends[0], ends[3] - ends[1]].map((size) => ROOM * size);
    this.asides = {};
    for (const role of OFF) {
      ends.splice(0, 4, ...always);
      takeMarks(this.marks.filter((mark) => mark.role === role));
      takeCurves((other) => other === role);
      this.asides[role] = ends.map((end, k) => (k < 2 ? Math.max(end, always[k] - room[k]) : Math.min(end, always[k] + room[k - 2])));
    }
    return always;
  }

  // Where a point of a body is, mm.
  place(body, u, v, k) {
    return [body.x[k] + u * body.cos[k] - v * body.sin[k], body.y[k] + u * body.sin[k] + v * body.cos[k]];
  }

  // A name stays at one point of its body: of some along it, that at which it covers the fewest others.
  anchorNames() {
    this.labels = [];
    const [left, low, right, high] = this.bounds, taken = [];
    const unit = Math.max(right - left, high - low) / 560;
    const looks = Array.from({ length: LOOKS }, (_, k) => Math.round(k * (this.frames - 1) / LOOKS));
    const pins = this.marks.filter((mark) => mark.always || mark.trail);
    for (const body of this.bodies) {
      const points = body.drawn.flatMap((drawn) => drawn.points);
      const line = this.marks.some((mark) => mark.sort === "line" && mark.label === body.name);
      if (!points.length && (body.fixed || line || !this.marks.some((mark) => mark.sort === "slide"))) continue;
      const text = spaced(body.name), wide = text.length * 6.6 * unit, tall = 15 * unit;
      // What nothing is cut of is named below its block.
      const axis = points.length ? axisOf(points) : { x: 0, y: -1.8 * tall, u: 0, v: 0 };
      let best = null;
      for (const share of [0, -0.28, 0.28, -0.5, 0.5, -0.72, 0.72]) {
        const [u, v] = [axis.x + share * axis.u, axis.y + share * axis.v];
        let cost = Math.abs(share);
        const places = looks.map((k) => this.place(body, u, v, k));
        places.forEach(([x, y], look) => {
          for (const other of taken) {
            const [ox, oy] = other.places[look];
            if (Math.abs(x - ox) < (wide + other.wide) / 2 && Math.abs(y - oy) < tall) cost += 3;
          }
          for (const pin of pins) {
            const k = looks[look];
            if (Math.abs(x - pin.x[k]) < wide / 2 + 4 * unit && Math.abs(y - pin.y[k]) < tall / 2 + 4 * unit) cost += 1;
          }
        });
        if (!best || cost < best.cost) best = { cost, u, v, places };
      }
      taken.push({ places: best.places, wide });
      this.labels.push({ body, u: best.u, v: best.v, shape: make(this.names, "text", { class: "name of-body" }, text) });
    }
  }

  // Fill the stage, as high as the mechanism asks for within `most` pixels; one scale along and across.
  fit(wide, most) {
    const boxes = [this.bounds, ...OFF.filter((role) => !this.hidden.has(role)).map((role) => this.asides[role])];
    const [left, low, right, high] = this.bounds.map((_, k) => (k < 2 ? Math.min : Math.max)(...boxes.map((box) => box[k])));
    const across = Math.max(right - left, 1e-9), up = Math.max(high - low, 1e-9);
    const free = wide - 2 * MARGIN;
    const tall = Math.max(200, Math.min(most, up * (free / across) + 2 * MARGIN + 18));
    const s = Math.min(free / across, (tall - 2 * MARGIN - 18) / up);
    this.s = s;
    this.tx = wide / 2 - s * (left + right) / 2;
    this.ty = (tall - 18) / 2 + s * (low + high) / 2;
    this.svg.setAttribute("viewBox", `0 0 ${wide} ${tall}`);
    this.svg.setAttribute("width", wide);
    this.svg.setAttribute("height", tall);
    this.pattern.setAttribute("patternTransform", `scale(${1 / s}) rotate(45)`);
    this.world.setAttribute("transform", `matrix(${s} 0 0 ${-s} ${this.tx} ${this.ty})`);
    this.trails.setAttribute("transform", `matrix(${s / this.fine} 0 0 ${-s / this.fine} ${this.tx} ${this.ty})`);
    for (const { rail, hole, shape } of this.marks) {
      if (rail) this.fitRail(rail);
      if (hole) shape.setAttribute("r", px(Math.min(9, Math.max(3.4, hole * s))));
    }
    this.fitScale(wide, tall);
    this.last = undefined;
  }

  fitRail({ c, s, low, high, beside, path }) {
    const at = (along, off) => [this.tx + this.s * (c * along - s * beside) + s * off, this.ty - this.s * (s * along + c * beside) + c * off];
    const over = 18 / this.s, [from, to] = [low - over, high + over];
    let d = `M${at(from, 9).map(px)}L${at(to, 9).map(px)}`;
    for (let along = from + 3 / this.s; along < to; along += 8 / this.s) {
      d += `M${at(along, 9).map(px)}L${at(along - 5 / this.s, 15).map(px)}`;
    }
    path.setAttribute("d", d);
  }

  fitScale(wide, tall) {
    const length = niceLength(Math.min(0.3 * wide, 160) / this.s), end = 12 + length * this.s, y = tall - 12;
    this.scaleBar.replaceChildren();
    make(this.scaleBar, "path", { d: `M12 ${y - 4}V${y + 4}M12 ${y}H${px(end)}M${px(end)} ${y - 4}V${y + 4}` });
    make(this.scaleBar, "text", { x: px(end + 7), y: y + 4 }, `${+length.toPrecision(3)} mm`);
  }

  // Of an on-screen place, mm.
  toWorld(event) {
    const box = this.svg.getBoundingClientRect(), zoom = this.svg.viewBox.baseVal.width / box.width;
    return [(zoom * (event.clientX - box.left) - this.tx) / this.s, (this.ty - zoom * (event.clientY - box.top)) / this.s];
  }

  toggle(role, on) {
    this.svg.classList.toggle(`without-${role}`, !on);
    if (on) this.hidden.delete(role); else this.hidden.add(role);
    this.last = undefined;
  }

  // All of it as it is at frame k.
  show(k) {
    if (k === this.last) return;
    this.last = k;
    const { s, tx, ty } = this;
    for (const body of this.bodies) {
      const x = body.x[k], c = s * body.cos[k], n = s * body.sin[k];
      const there = Number.isFinite(x + c);
      body.group.setAttribute("visibility", there ? "visible" : "hidden");
      if (there) body.group.setAttribute("transform",
        `matrix(${c.toFixed(4)} ${(-n).toFixed(4)} ${(-n).toFixed(4)} ${(-c).toFixed(4)} ${px(tx + s * x)} ${px(ty - s * body.y[k])})`);
    }
    for (const mark of this.marks) if (!this.hidden.has(mark.role) || mark.always) this.showMark(mark, k);
    if (!this.hidden.has("names")) {
      for (const { body, u, v, shape } of this.labels) {
        const [x, y] = this.place(body, u, v, k);
        this.put(shape, tx + s * x, ty - s * y + 4);
      }
    }
    this.notice.textContent = this.open.has(k) ? "It cannot be put together here." : "";
  }

  put(shape, x, y) {
    const there = Number.isFinite(x + y);
    shape.setAttribute("visibility", there ? "inherit" : "hidden");
    if (there) shape.setAttribute("transform", `translate(${px(x)} ${px(y)})`);
  }

  showMark(mark, k) {
    const { s } = this, x = this.tx + s * mark.x[k], y = this.ty - s * mark.y[k];
    const there = Number.isFinite(x + y + (mark.u ? mark.u[k] + mark.v[k] : 0));
    mark.group.setAttribute("visibility", there ? "inherit" : "hidden");
    if (mark.name) this.put(mark.name, x + 8, y - 8);
    if (mark.middle) this.put(mark.middle, x + s * mark.u[k] / 2, y - s * mark.v[k] / 2 + 4);
    if (!there) return;
    const turn = mark.sort === "slide" ? ` rotate(${px(-mark.turned[k] * 180 / Math.PI)})` : "";
    mark.group.setAttribute("transform", `translate(${px(x)} ${px(y)})${turn}`);
    if (mark.r) mark.shape.setAttribute("r", px(s * mark.r[k]));
    if (mark.u) mark.shape.setAttribute("d", mark.sort === "line"
      ? `M0 0L${px(s * mark.u[k])} ${px(-s * mark.v[k])}` : arrow(s * mark.u[k], -s * mark.v[k]));
  }

  // The frame at which a body's own point (u, v) is nearest to a place, rather near frame `from` than across a turn.
  nearestFrame(body, u, v, place, from, cyclic) {
    const reach = Math.max(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1]);
    let best = from, least = Infinity;
    for (let k = 0; k < this.frames; k++) {
      const [x, y] = this.place(body, u, v, k);
      const off = Math.hypot(x - place[0], y - place[1]);
      let away = Math.abs(k - from) / this.frames;
      if (cyclic) away = Math.min(away, 1 - away);
      const cost = off + 0.12 * reach * away;
      if (cost < least) { least = cost; best = k; }
    }
    return best;
  }
}
