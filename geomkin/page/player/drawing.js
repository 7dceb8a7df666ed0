// A scene as an SVG drawing: a group for each body, whose matrix is set at each frame, and marks in pixels above them.
import { Names } from "./names.js";
import { abs, arrow, axisOf, floor, hypot, make, max, min, niceLength, pointsOf, px, see, spaced, STAND } from "./shapes.js";

// Pixels kept free around the drawing, and below it for its scale; largest zoom, relative to the whole drawing.
export const MARGIN = 26, FOOT = 18;
const CLOSEST = 60, DEG = Math.PI / 180;
// Pixels between a name and its body or point.
const BESIDE = 6;
// Share of the drawing that is shown around a contact that stays in one place.
const NEAR = 0.05;
// Share of the drawing's width or height below which an edited mechanism is enlarged to fit again.
const SMALL = 0.35;
// Number of frames at which is counted whether the ground is covered.
const COVERED = 12;
const LAYERS = ["guides", "plates", "world", "trails", "above", "names", "scaleBar"];
let drawings = 0;

export class Drawing {
  // An empty drawing that fills `stage`; `hidden`: roles that it does not show. Its `overlays` have a method show(frame).
  constructor(stage, hidden = []) {
    Object.assign(this, { by: 1, hidden: new Set(hidden), overlays: [], room: [], id: `hatch${drawings++}` });
    this.svg = make(stage, "svg", { class: "drawing", tabindex: 0, role: "application", "aria-roledescription": "drawing" });
    this.pattern = make(make(this.svg, "defs"), "pattern", { id: this.id, patternUnits: "userSpaceOnUse", width: 6, height: 6 });
    make(this.pattern, "path", { d: "M0 0V6", class: "hatch" });
    for (const layer of LAYERS) this[layer] = make(this.svg, "g", { class: layer });
    this.notice = make(this.svg, "text", { class: "notice", x: 12, y: 24 });
  }

  // Draws a scene in place of the last one; the view stays until `fit` or `look` is called.
  // scene, data: as in the page, rows unpacked in data.rows; drive: row of the driver, every: its step between two
  // dashes of a trail.
  load(scene, data, drive, every) {
    Object.assign(this, { scene, data, drive, every, frames: data.frames, open: new Set(scene.open) });
    // Roles whose elements may extend far beyond the mechanism; the drawing grows for the visible ones.
    this.far = data.roles.filter(({ room }) => room).map(({ id }) => id);
    const title = scene.label ? `${data.name}, ${spaced(scene.label)}` : data.name;
    this.svg.setAttribute("aria-label", `${title}: plus and minus zoom, 0 shows all, arrows step it or, if zoomed, move the view`);
    for (const layer of LAYERS) this[layer].replaceChildren();
    // Texts that are not displayed have no size.
    this.names.classList.remove("off");
    this.named = new Names(this);
    this.bodies = scene.bodies.map((body) => this.unpacked(body));
    let tint = 0;
    for (const body of this.bodies) body.tint = body.fixed ? "ground" : `t${tint++ % 8}`;
    for (const body of [...this.bodies].sort((a, b) => a.layer - b.layer)) this.drawBody(body);
    this.hasGround = this.bodies.some((body) => body.fixed && body.cut.length);
    this.marks = scene.marks.map((mark) => this.drawMark({ label: "", role: "construction", ...mark, ...this.rows(mark) }));
    this.dimensions = 0;
    for (const curve of scene.curves) this.drawCurve(curve);
    this.bounds = this.extent();
    // Trails are in ten-thousandths of the drawing, so that few decimals suffice for any size.
    this.fine = 1e4 / max(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1], 1e-9);
    for (const mark of this.marks) {
      if (mark.trail) mark.line = make(this.trails, "path", { d: this.trailOf(mark), class: `trail ${mark.role}`, "data-role": mark.role });
    }
    // Points that are this near to each other, mm, are the same.
    this.near = 1e-3 * (this.bounds[2] - this.bounds[0] + this.bounds[3] - this.bounds[1]);
    this.sizePins();
    this.nameAll();
    for (const role of this.hidden) this.toggle(role, false);
  }

  // A pin fills its hole.
  sizePins() {
    for (const mark of this.marks) {
      const [k] = mark.sort.endsWith("pin") ? this.known(mark) : [];
      if (k === undefined) continue;
      for (const body of this.bodies) for (const { circles } of body.drawn) for (const [u, v, r] of circles) {
        const [x, y] = this.place(body, u, v, k);
        if (hypot(x - mark.x[k], y - mark.y[k]) < this.near) mark.hole = max(mark.hole ?? 0, r);
      }
    }
  }

  get roles() {
    return new Set([...this.marks.filter((m) => !m.always).map((m) => m.role), ...this.scene.curves.map((c) => c.role)]);
  }

  unpacked(body) {
    const [x, y, turn] = [...body.at, body.turn].map((index) => this.data.rows[index]);
    return { ...body, lined: {}, x, y, cos: turn.map((deg) => Math.cos(deg * DEG)), sin: turn.map((deg) => Math.sin(deg * DEG)) };
  }

  drawBody(body) {
    // A ground plate that lies over a moving body must not hide it.
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
    if (curve.role === "dimension") { this.drawDimension(curve, body, pointsOf(d).points); return; }
    const path = make(body ? body.group : this.world, "path", { d, class: `line ${curve.role}`, "data-role": curve.role });
    if (body) (body.lined[curve.role] ??= []).push(...pointsOf(d).points);
    if (curve.label) make(path, "title", {}, spaced(curve.label));
  }

  // A length on a body, or on the ground, is a mark from one of its ends to the other.
  drawDimension({ label, role }, body, ends) {
    const mark = { sort: "dimension", role, label, number: this.dimensions++ };
    for (const name of ["x", "y", "u", "v"]) mark[name] = new Float64Array(this.frames);
    for (let k = 0; k < this.frames; k++) {
      const [[x, y], [u, v]] = ends.map((end) => (body ? this.place(body, ...end, k) : end));
      Object.entries({ x, y, u: u - x, v: v - y }).forEach(([name, value]) => { mark[name][k] = value; });
    }
    this.marks.push(this.drawMark(mark));
  }

  // The rows of numbers of a mark.
  rows({ at, vector = [], turn, radius }) {
    const [x, y, turned, r, u, v] = [...at, turn, radius, ...vector].map((index) => this.data.rows[index]);
    return { x, y, turned: turned?.map((deg) => deg * DEG), r, u, v };
  }

  drawMark(mark) {
    const { sort, role } = mark;
    mark.always = ["pin", "fixed pin", "slide"].includes(sort);
    mark.group = make(this.above, "g", { class: `mark ${sort.replace(" ", "-")} ${role}` });
    const add = (name, attributes) => make(mark.group, name, attributes);
    make(mark.group, "title", {}, spaced(mark.label || sort));
    if (["pin", "slide"].includes(sort) || role === "traced") add("circle", { r: 12.5, class: "touch" });
    if (sort === "slide") {
      mark.shape = add("rect", { x: -11, y: -7, width: 22, height: 14, rx: 2 });
      this.drawGuide(mark);
    } else if (mark.u) {
      mark.shape = add("path");
    } else if (mark.r) {
      mark.shape = add("circle");
    } else if (role === "centre") {
      mark.shape = add("path", { d: "M-4-4 4 4M-4 4 4-4" });
    } else {
      mark.shape = add("circle", { r: sort === "fixed pin" ? 4.6 : sort === "pin" ? 3.8 : 3.6 });
      if (sort === "fixed pin") add("circle", { r: 1.5, class: "core" });
      if (sort === "fixed pin" && !this.hasGround) add("path", { d: STAND });
    }
    return mark;
  }

  // A block that moves along one line of the ground has a rail, hatched below, unless a plate has a slot for it.
  drawGuide(mark) {
    if (this.hasGround) return;
    const known = this.known(mark);
    if (!known.length) return;
    const [c, s] = [Math.cos(mark.turned[known[0]]), Math.sin(mark.turned[known[0]])];
    const along = known.map((k) => c * mark.x[k] + s * mark.y[k]);
    const beside = known.map((k) => c * mark.y[k] - s * mark.x[k]);
    const [low, high] = [min(...along), max(...along)];
    const still = known.every((k) => abs(Math.sin(mark.turned[k] - mark.turned[known[0]])) < 1e-3);
    if (!still || high - low === 0 || max(...beside) - min(...beside) > 2e-3 * (high - low)) return;
    mark.rail = { c, s, low, high, beside: beside[0], path: make(this.guides, "path", { class: "rail" }) };
  }

  // Every second one of equal steps of the drive is drawn: a long dash means a fast point.
  trailOf(mark) {
    const { drive, every } = this;
    let d = "", drawn = false;
    for (let k = 1; k < this.frames; k++) {
      const from = abs(drive[k - 1] - drive[0]), to = abs(drive[k] - drive[0]);
      if (!isFinite(mark.x[k] + mark.x[k - 1])) { drawn = false; continue; }
      // A step that ends between two frames is interpolated linearly.
      for (let at = from; at < to - 1e-9 * every;) {
        const step = floor(at / every + 1e-6), next = min(to, (step + 1) * every);
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
    return d;
  }

  known(mark) {
    return [...mark.x.keys()].filter((k) => isFinite(mark.x[k] + mark.y[k]));
  }

  // Left, lower, right and upper end, mm, of everything that is always shown, over all frames.
  extent() {
    const ends = [Infinity, Infinity, -Infinity, -Infinity];
    const take = (x, y) => {
      if (!isFinite(x + y)) return;
      ends[0] = min(ends[0], x); ends[1] = min(ends[1], y);
      ends[2] = max(ends[2], x); ends[3] = max(ends[3], y);
    };
    const takeMarks = (marks) => {
      for (const mark of marks) mark.x.forEach((x, k) => {
        const r = mark.r ? mark.r[k] : 0;
        take(x - r, mark.y[k] - r); take(x + r, mark.y[k] + r);
        if (mark.u) take(x + mark.u[k], mark.y[k] + mark.v[k]);
      });
    };
    const takeMoving = (body, points) => {
      for (let k = 0; k < this.frames; k++) for (const [u, v] of points) take(...this.place(body, u, v, k));
    };
    const takeLined = (wanted) => {
      for (const body of this.bodies) for (const [role, points] of Object.entries(body.lined)) if (wanted(role)) takeMoving(body, points);
    };
    for (const body of this.bodies) {
      body.drawn = body.cut.map((index) => pointsOf(this.data.paths[index]));
      takeMoving(body, body.drawn.flatMap(({ points }) => points));
    }
    takeLined((role) => !this.far.includes(role));
    takeMarks(this.marks.filter((mark) => !this.far.includes(mark.role)));
    const takeCurves = (wanted) => {
      for (const path of this.world.querySelectorAll("path")) {
        if (!wanted(path.dataset.role)) continue;
        const { x, y, width, height } = path.getBBox();
        take(x, y); take(x + width, y + height);
      }
    };
    takeCurves((role) => !this.far.includes(role));
    if (ends[0] === Infinity) ends.splice(0, 4, -1, -1, 1, 1);
    const always = [...ends];
    this.asides = {};
    for (const { id: role, room: share } of this.data.roles.filter(({ room }) => room)) {
      const room = [always[2] - always[0], always[3] - always[1]].map((size) => share * size);
      ends.splice(0, 4, ...always);
      takeMarks(this.marks.filter((mark) => mark.role === role));
      takeCurves((other) => other === role);
      takeLined((other) => other === role);
      this.asides[role] = ends.map((end, k) => (k < 2 ? max(end, always[k] - room[k]) : min(end, always[k] + room[k - 2])));
    }
    return always;
  }

  // Position of a point of a body, mm.
  place(body, u, v, k) {
    return [body.x[k] + u * body.cos[k] - v * body.sin[k], body.y[k] + u * body.sin[k] + v * body.cos[k]];
  }

  // The point of a body that is at a position, mm.
  within(body, x, y, k) {
    const [u, v, c, s] = [x - body.x[k], y - body.y[k], body.cos[k], body.sin[k]];
    return [c * u + s * v, c * v - s * u];
  }

  // Names of bodies and points, each with its possible positions, the best first, in pixels.
  nameAll() {
    const on = (body, u, v) => (k) => this.screen(...this.place(body, u, v, k));
    // At a share of a mark's line: on it, to its left (side -1) or to its right (1).
    const at = (mark, share, side, down = 0) => (k, half) => {
      const [u, v] = mark.u ? [share * mark.u[k], share * mark.v[k]] : [0, 0], [x, y] = this.screen(mark.x[k] + u, mark.y[k] + v);
      return [x + side * (half + BESIDE), y + down];
    };
    const { marks } = this, lines = new Set();
    for (const body of this.bodies) {
      const points = body.drawn.flatMap(({ points }) => points);
      // A body without parts has its name next to its block.
      const block = !points.length && !body.fixed && !marks.some(({ sort, label }) => sort === "line" && label === body.name) && this.blockOf(body);
      const spots = points.length ? this.spotsOn(body, points).map(([u, v]) => on(body, u, v)) : block && [24, -20].map((down) => at(block, 0, 0, down));
      if (spots && !body.unnamed) this.named.add(spaced(body.name), "of-body", "names", spots);
    }
    for (const mark of marks) {
      const { sort, role, label } = mark, text = spaced(label).replace(sort === "dimension" ? /,.*/ : /, 1 \w+ is.*/, "");
      if (!text || mark.always || mark.r || (sort === "vector" && ["velocity", "acceleration", "force"].includes(role))) continue;
      if (mark.u) {
        if (sort === "line" && lines.has(label)) continue;
        lines.add(label);
        const on = sort === "vector" ? [] : [0.5, 0.3, 0.7, 0.4, 0.6].map((share) => at(mark, share, 0));
        const off = [1, 0.7, 0.4, 0.1].flatMap((share) => [at(mark, share, 1), at(mark, share, -1)]);
        this.named.add(text, `of-body ${role}`, role, [...on, ...off], mark.number);
      } else {
        const short = text.replace("instant centre of ", "").replace(" and ", ", ");
        this.named.add(short, role, role, [[1, -8], [1, 8], [-1, -8], [-1, 8], [0, -14], [0, 14], [1, 0], [-1, 0], [0, -28], [0, 28]]
          .map(([side, down]) => at(mark, 0, side, down)));
      }
    }
    // Names that a user has switched on take precedence over those that are always shown.
    const off = this.data.roles.filter(({ shown }) => !shown).map(({ id }) => id);
    this.named.all.sort((a, b) => off.includes(b.role) - off.includes(a.role));
  }

  // The slide whose place on a body is the same at all frames.
  blockOf(body) {
    return this.marks.find((mark) => {
      const [first, ...others] = mark.sort === "slide" ? this.known(mark) : [], place = first !== undefined && this.within(body, mark.x[first], mark.y[first], first);
      return place && others.every((k) => { const [x, y] = this.place(body, ...place, k); return hypot(x - mark.x[k], y - mark.y[k]) < this.near; });
    });
  }

  // Width and height, mm, of the visible elements, and of `room`: what else an editor shows, each with ends as those of `bounds`.
  size() {
    const boxes = [this.bounds, ...this.room, ...this.far.filter((role) => !this.hidden.has(role)).map((role) => this.asides[role])];
    this.box = this.bounds.map((_, k) => (k < 2 ? min : max)(...boxes.map((box) => box[k])));
    const [left, low, right, high] = this.box;
    return [max(right - left, 1e-9), max(high - low, 1e-9)];
  }

  // Resizes it to `wide` by `tall` pixels, `scale` px/mm if not zoomed; a zoom stays.
  fit(wide, tall, scale) {
    Object.assign(this, { wide, tall, scale });
    this.svg.setAttribute("viewBox", `0 0 ${wide} ${tall}`);
    this.svg.setAttribute("width", wide);
    this.svg.setAttribute("height", tall);
    this.look(this.by, this.at);
  }

  // Shows it `by` times as large as the whole, with the position `at`, mm, in the middle.
  look(by, at) {
    const [left, low, right, high] = this.box;
    this.by = min(CLOSEST, max(1, by));
    if (this.by < 1.02) [this.by, at] = [1, undefined];
    const [x, y] = at ?? [(left + right) / 2, (low + high) / 2];
    this.at = at && [min(right, max(left, x)), min(high, max(low, y))];
    const s = this.scale * this.by, [middle, centre] = this.at ?? [x, y];
    [this.s, this.tx, this.ty] = [s, this.wide / 2 - s * middle, (this.tall - FOOT) / 2 + s * centre];
    this.svg.classList.toggle("closer", this.by > 1);
    this.pattern.setAttribute("patternTransform", `scale(${1 / s}) rotate(45)`);
    this.world.setAttribute("transform", `matrix(${s} 0 0 ${-s} ${this.tx} ${this.ty})`);
    this.trails.setAttribute("transform", `matrix(${s / this.fine} 0 0 ${-s / this.fine} ${this.tx} ${this.ty})`);
    for (const { rail, hole, shape } of this.marks) {
      if (rail) this.fitRail(rail);
      if (hole) shape.setAttribute("r", px(min(9 * Math.sqrt(this.by), max(3.4, hole * s))));
    }
    this.fitScale(this.wide, this.tall);
    this.named.arrange();
    this.show(this.frame ?? 0, true);
  }

  // Whether the whole mechanism is in view and not tiny, or the user has zoomed in.
  get isFitting() {
    const [left, low, right, high] = this.bounds, [x, y] = this.screen(left, high), [u, v] = this.screen(right, low);
    return this.isInside && (this.by > 1 || max((u - x) / this.wide, (v - y) / this.tall) > SMALL);
  }

  // Whether the whole mechanism is in view, or the user has zoomed in.
  get isInside() {
    const [left, low, right, high] = this.bounds, [x, y] = this.screen(left, high), [u, v] = this.screen(right, low);
    return this.by > 1 || min(x, y, this.wide - u, this.tall - FOOT - v) > 0;
  }

  // Zooms in `times` about a position on the stage, px.
  zoom(times, [x, y] = [this.wide / 2, (this.tall - FOOT) / 2]) {
    const [u, v] = this.plane([x, y]);
    const by = min(CLOSEST, max(1, this.by * times)), s = this.scale * by;
    this.look(by, [u + (this.wide / 2 - x) / s, v - ((this.tall - FOOT) / 2 - y) / s]);
  }

  // Moves a zoomed view by x, y px.
  pan(x, y) {
    if (this.at) this.look(this.by, [this.at[0] - x / this.s, this.at[1] + y / this.s]);
  }

  // Positions of the contacts of bodies, mm.
  get contacts() {
    return this.marks.filter(({ sort, role }) => sort === "point" && role === "contact")
      .flatMap((mark) => this.known(mark).map((k) => [mark.x[k], mark.y[k]]));
  }

  lookAtContact() {
    const ends = [0, 1].map((axis) => this.contacts.map((place) => place[axis])).map((row) => [min(...row), max(...row)]);
    const sizes = ends.map(([low, high]) => high - low), size = max(...sizes, NEAR * max(...this.size()));
    this.look(0.4 * min(this.wide, this.tall) / (size * this.scale), ends.map(([low, high]) => (low + high) / 2));
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
    const [unit, mm] = this.data.unit ?? ["mm", 1], length = niceLength(min(0.3 * wide, 110) / this.s / mm), end = 12 + length * mm * this.s, y = tall - 12;
    this.scaleBar.replaceChildren();
    make(this.scaleBar, "path", { d: `M12 ${y - 4}V${y + 4}M12 ${y}H${px(end)}M${px(end)} ${y - 4}V${y + 4}` });
    make(this.scaleBar, "text", { x: px(end + 7), y: y + 4 }, `${+length.toPrecision(3)} ${unit}`);
  }

  // Position of an event on the stage, px; of a point, mm, in pixels, and back.
  onStage(event) {
    const box = this.svg.getBoundingClientRect(), zoom = this.wide / box.width;
    return [zoom * (event.clientX - box.left), zoom * (event.clientY - box.top)];
  }

  screen(x, y) { return [this.tx + this.s * x, this.ty - this.s * y]; }

  plane([x, y]) { return [(x - this.tx) / this.s, (this.ty - y) / this.s]; }

  toggle(role, on) {
    for (const shown of this.svg.querySelectorAll(`.${role}:not(.pin, .fixed-pin, .slide)`)) shown.classList.toggle("off", !on);
    if (on) this.hidden.delete(role); else this.hidden.add(role);
  }

  // Shows frame k.
  show(k, anew) {
    if (k === this.frame && !anew) return;
    this.frame = k;
    const { s, tx, ty } = this;
    for (const body of this.bodies) {
      if (body.fixed && !anew) continue;
      const x = body.x[k], c = s * body.cos[k], n = s * body.sin[k];
      const there = isFinite(x + c);
      see(body.group, there);
      if (there) body.group.setAttribute("transform",
        `matrix(${c.toFixed(4)} ${(-n).toFixed(4)} ${(-n).toFixed(4)} ${(-c).toFixed(4)} ${px(tx + s * x)} ${px(ty - s * body.y[k])})`);
    }
    for (const mark of this.marks) {
      if ((!this.hidden.has(mark.role) || mark.always) && (anew || mark.sort !== "fixed pin")) this.showMark(mark, k);
    }
    if (!this.hidden.has("names")) this.named.show(k);
    this.notice.textContent = this.open.has(k) ? "It cannot be assembled here." : "";
    for (const overlay of this.overlays) overlay.show(k);
  }

  showMark(mark, k) {
    const { s } = this, x = this.tx + s * mark.x[k], y = this.ty - s * mark.y[k];
    const there = isFinite(x + y + (mark.u ? mark.u[k] + mark.v[k] : 0));
    see(mark.group, there);
    if (!there) return;
    const turn = mark.sort === "slide" ? ` rotate(${px(-mark.turned[k] / DEG)})` : "";
    mark.group.setAttribute("transform", `translate(${px(x)} ${px(y)})${turn}`);
    if (mark.r) mark.shape.setAttribute("r", px(s * mark.r[k]));
    if (mark.u) mark.shape.setAttribute("d", arrow(s * mark.u[k], -s * mark.v[k], { line: 0, vector: 1, dimension: 2 }[mark.sort]));
  }

  // The frame at which the point (u, v) of a body is nearest to a position. Frames near `from` are preferred, so that the
  // driver does not jump.
  nearestFrame({ body, u, v }, place, from, cyclic) {
    const reach = max(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1]);
    let best = from, least = Infinity;
    for (let k = 0; k < this.frames; k++) {
      const [x, y] = this.place(body, u, v, k);
      const off = hypot(x - place[0], y - place[1]);
      let away = abs(k - from) / this.frames;
      if (cyclic) away = min(away, 1 - away);
      const cost = off + 0.12 * reach * away;
      if (cost < least) { least = cost; best = k; }
    }
    return best;
  }

  // Places along a body, in its own frame: first those on its plate, and of the ground those that are covered least.
  spotsOn(body, points) {
    const { x, y, u, v } = axisOf(points), [plate] = platesOf(body);
    const spots = [0, -0.28, 0.28, -0.5, 0.5, -0.72, 0.72, -0.93, 0.93].map((share) => [x + share * u, y + share * v]);
    const off = (spot) => COVERED * !plate.isPointInFill(new DOMPoint(...spot));
    const cost = new Map(spots.map((spot) => [spot, off(spot) + (body.fixed ? this.covered(body, spot) : 0)]));
    return spots.sort((a, b) => cost.get(a) - cost.get(b));
  }

  // Number of frames, of some, at which bodies above a body cover a point of it.
  covered(body, spot) {
    const above = this.bodies.filter((other) => other !== body && other.layer >= body.layer);
    return Array.from({ length: COVERED }, (_, look) => floor(look * this.frames / COVERED)).filter((k) => {
      const [x, y] = this.place(body, ...spot, k);
      return above.some((other) => platesOf(other).some((plate) => plate.isPointInFill(new DOMPoint(...this.within(other, x, y, k)))));
    }).length;
  }
}

const platesOf = (body) => [...body.group.querySelectorAll(".plate")];
