// Previews of a linkage: positions of its bodies for other sizes, until the exact answer of the server comes.
//
// Newton's method on the closure of pins and slides, from the exact positions of the last answer; it states no result.

import { make, px } from "../player/shapes.js";
import { measured } from "../player/plots.js";

const { abs, atan2, cos, hypot, max, min, sin } = Math;
const DEG = Math.PI / 180;
// Largest rotation of a body, rad, in one step: a larger one might lead to another assembly mode.
const MOST_TURN = 0.25;
// Halvings of a step, iterations, and residual, in sizes of the linkage, at which it counts as closed.
const HALVINGS = 6, ITERATIONS = 12, CLOSED = 1e-8;
// Positions of a traced point that are computed anew.
const TRACED = 48;
// Weight of the joint at which a linkage that cannot be assembled is open.
const LIGHT = 1e-3;

export class Linkage {
  // data: `preview` of an answer. poses: of all bodies at each frame, [x, y, turn], mm and rad.
  constructor(data, poses) {
    Object.assign(this, data, { poses });
    this.size = max(...this.numbers.slice(3, 3 + 2 * this.points.length).map(abs)) || 1;
    this.numbers = Float64Array.from(this.numbers);
  }

  // The numbers after changes by key.
  changed(changes) {
    const numbers = Float64Array.from(this.numbers);
    for (const [key, change] of Object.entries(changes)) for (const [k, rate] of this.by[key] ?? []) numbers[k] += rate * change;
    return numbers;
  }

  // Position of a point, mm.
  place(index, numbers, poses) {
    const [body] = this.points[index], [x, y, turn] = poses[body], u = numbers[3 + 2 * index], v = numbers[4 + 2 * index];
    return [x + u * cos(turn) - v * sin(turn), y + u * sin(turn) + v * cos(turn)];
  }

  indexOf(name) { return this.points.findIndex(([, other]) => other === name); }

  // Rows of the equations: [residual, [unknown, derivative] ...]; an unknown is 3 * body + (0, 1 or 2), its turn in sizes.
  // `light`: index of the pin that may be open.
  rows(numbers, poses, base, light) {
    const rows = [], { size } = this;
    const moves = (index, u, v, sign) => {
      const [body] = this.points[index], [x, y] = this.place(index, numbers, poses), [px, py] = poses[body];
      return [[3 * body, sign * u], [3 * body + 1, sign * v], [3 * body + 2, sign * ((x - px) * v - (y - py) * u) / size]];
    };
    this.pins.forEach(([first, ...others], k) => {
      const weight = k === light ? LIGHT : 1, at = this.place(first, numbers, poses);
      for (const other of others) this.place(other, numbers, poses).forEach((value, axis) => {
        const [u, v] = axis ? [0, weight] : [weight, 0];
        rows.push([weight * (value - at[axis]), ...moves(other, u, v, 1), ...moves(first, u, v, -1)]);
      });
    });
    for (const { points: [on, through], direction, aligned, driven } of this.slides) {
      const [body, along] = [on, through].map((index) => this.points[index][0]);
      const line = (held, from) => held[along][2] + from[direction] * DEG, turn = line(poses, numbers), [c, s] = [cos(turn), sin(turn)];
      const apart = (from, held) => { const [a, b] = [on, through].map((index) => this.place(index, from, held)); return [a[0] - b[0], a[1] - b[1]]; };
      const [x, y] = apart(numbers, poses);
      rows.push([c * y - s * x, ...moves(on, -s, c, 1), ...moves(through, -s, c, -1), [3 * along + 2, -(c * x + s * y) / size]]);
      if (aligned) rows.push([size * (poses[body][2] - turn - base[body][2] + line(base, this.numbers)), [3 * body + 2, 1], [3 * along + 2, -1]]);
      if (driven) {
        const [u, v] = apart(this.numbers, base), before = line(base, this.numbers);
        const from = cos(before) * u + sin(before) * v + base.shift;
        rows.push([c * x + s * y - from, ...moves(on, c, s, 1), ...moves(through, c, s, -1), [3 * along + 2, (c * y - s * x) / size]]);
      }
    }
    // The driver keeps its angle to the ground.
    const { driver } = this;
    if (driver !== null) rows.push([size * (poses[driver][2] - poses[0][2] - base[driver][2] + base[0][2] - base.shift), [3 * driver + 2, 1], [2, -1]]);
    return rows;
  }

  // Poses near `start` that close the linkage; null if there are none. base: exact poses, whose driver is kept.
  newton(numbers, start, base, light = -1) {
    const poses = start.map((pose) => [...pose]), n = 3 * (poses.length - 1), { size } = this;
    poses[0] = [numbers[0], numbers[1], base[0][2] + (numbers[2] - this.numbers[2]) * DEG];
    let damping = light < 0 ? 1e-12 : 1e-3, before = Infinity;
    for (let k = 0; k < (light < 0 ? ITERATIONS : 60); k++) {
      const rows = this.rows(numbers, poses, base, light), error = max(...rows.map(([residual]) => abs(residual)));
      if (light < 0 && error < CLOSED * size) return poses;
      const cost = rows.reduce((sum, [residual]) => sum + residual * residual, 0);
      if (light >= 0) {
        if (abs(before - cost) < 1e-13 * size * size) return poses;
        damping *= cost < before ? 0.3 : 10;
        before = cost;
      }
      const matrix = Array.from({ length: n }, () => new Float64Array(n + 1));
      for (const [residual, ...terms] of rows) {
        for (const [a, one] of terms) {
          if (a < 3) continue;
          matrix[a - 3][n] -= one * residual;
          for (const [b, other] of terms) if (b >= 3) matrix[a - 3][b - 3] += one * other;
        }
      }
      matrix.forEach((row, a) => { row[a] += damping; });
      const step = solved(matrix), most = max(...step.map(abs)), share = min(1, 0.5 * size / (most || 1));
      step.forEach((change, a) => { poses[1 + (a - a % 3) / 3][a % 3] += share * change / (a % 3 === 2 ? size : 1); });
      if (!isFinite(most)) return null;
    }
    return light < 0 ? null : poses;
  }

  // Poses for other numbers, followed from `start`, those for the numbers `from`; null if it cannot be assembled.
  follow(numbers, start, base, from = this.numbers, depth = 0) {
    const poses = this.newton(numbers, start, base);
    if (poses?.every((pose, k) => abs(pose[2] - start[k][2]) < MOST_TURN)) return poses;
    if (depth === HALVINGS) return null;
    const middle = numbers.map((number, k) => (number + from[k]) / 2), half = this.follow(middle, start, base, from, depth + 1);
    return half && this.follow(numbers, half, base, middle, depth + 1);
  }

  // Poses and numbers with which a point is at `to`, by the smallest changes of the keys, and as near as it gets.
  drag(name, keys, to, frame) {
    const base = this.baseAt(frame), index = this.indexOf(name), { size } = this;
    const known = keys.flatMap((key) => (this.by[key] ? [key] : [0, 1].map((k) => `${key}[${k}]`).filter((item) => this.by[item])));
    if (!base || index < 0 || !known.length) return null;
    let changes = Object.fromEntries(known.map((key) => [key, 0])), held = { numbers: this.numbers, poses: base };
    const tried = (next) => { const numbers = this.changed(next), poses = this.follow(numbers, held.poses, base, held.numbers); return poses && { numbers, poses }; };
    const at = ({ numbers, poses }) => this.place(index, numbers, poses);
    for (let k = 0; k < 8; k++) {
      const [x, y] = at(held), off = [to[0] - x, to[1] - y];
      if (hypot(...off) < 1e-5 * size) break;
      const slopes = known.map((key) => {
        const step = 1e-5 * size / max(...this.by[key].map(([, rate]) => abs(rate))), moved = tried({ ...changes, [key]: changes[key] + step });
        return moved ? at(moved).map((value, axis) => (value - [x, y][axis]) / step) : [0, 0];
      });
      const sum = (a, b) => slopes.reduce((total, slope) => total + slope[a] * slope[b], 0);
      const damping = 1e-6 * (sum(0, 0) + sum(1, 1)) + 1e-12;
      const [p, q] = solved([[sum(0, 0) + damping, sum(0, 1), off[0]], [sum(0, 1), sum(1, 1) + damping, off[1]]]);
      let next = null, share = min(1, 0.3 * size / hypot(...off)), wanted;
      for (let halving = 0; halving < 5 && !next; halving++, share /= 2) {
        wanted = Object.fromEntries(known.map((key, j) => [key, changes[key] + share * (slopes[j][0] * p + slopes[j][1] * q)]));
        next = tried(wanted);
      }
      if (!next) break;
      [held, changes] = [next, wanted];
    }
    return held;
  }

  // The exact poses of a frame with its driver; of a frame at which it cannot be assembled those of the nearest one that
  // is, and how far the driver is beyond. drive: positions of the driver at the frames, rad or mm.
  baseAt(frame, drive = null) {
    const isKnown = (k) => this.poses[k]?.every((pose) => pose.every(isFinite)), frames = this.poses.length;
    let known = frame;
    if (!isKnown(frame)) {
      if (!drive) return null;
      for (let off = 1; off < frames; off++) { known = [frame - off, frame + off].find(isKnown); if (known !== undefined) break; }
      if (known === undefined) return null;
    }
    return Object.assign(this.poses[known].map((pose) => [...pose]), { shift: drive ? drive[frame] - drive[known] : 0 });
  }

  // Poses for numbers with which it cannot be assembled: all joints are kept but one, and its two ends, mm.
  opened(numbers, base) {
    const moving = this.pins.map((on, k) => [k, on.map((index) => this.points[index][0])]);
    const inner = moving.filter(([, on]) => !on.includes(0) && !on.includes(this.driver));
    const candidates = (inner.length ? inner : moving.filter(([, on]) => !on.includes(0))).map(([k]) => k);
    let best = null;
    for (const light of candidates) {
      const poses = this.newton(numbers, base, base, light);
      if (!poses) continue;
      const ends = this.ends(light, numbers, poses), length = hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
      const others = max(...this.rows(numbers, poses, base, light).map(([residual]) => abs(residual)));
      if (others < 0.02 * max(length, 1e-3 * this.size) && (!best || length < best.length)) best = { poses, numbers, ends, length };
    }
    return best;
  }

  ends(pin, numbers, poses) {
    const [first, ...others] = this.pins[pin].map((index) => this.place(index, numbers, poses));
    const far = others.reduce((a, b) => (hypot(b[0] - first[0], b[1] - first[1]) > hypot(a[0] - first[0], a[1] - first[1]) ? b : a));
    return [first, far];
  }
}

// The solution of linear equations, each a row with its right side at the end; the rows are overwritten.
function solved(rows) {
  const n = rows.length;
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let row = k + 1; row < n; row++) if (abs(rows[row][k]) > abs(rows[pivot][k])) pivot = row;
    [rows[k], rows[pivot]] = [rows[pivot], rows[k]];
    for (let row = k + 1; row < n; row++) {
      const factor = rows[row][k] / rows[k][k];
      if (factor) for (let column = k; column <= n; column++) rows[row][column] -= factor * rows[k][column];
    }
  }
  const found = new Array(n);
  for (let k = n - 1; k >= 0; k--) {
    found[k] = rows[k][n];
    for (let column = k + 1; column < n; column++) found[k] -= rows[k][column] * found[column];
    found[k] /= rows[k][k];
  }
  return found;
}

const px4 = (value) => value.toFixed(4);

// The affine map [a, b, c, d, e, f] of a plate, as in SVG, that takes the first of its points, the farthest one from it, and
// the one farthest from their line to new places; of points in a line it keeps the width.
function affine(before, now) {
  const [p, q] = [before[0], now[0]], from = before.map(([u, v]) => [u - p[0], v - p[1]]), to = now.map(([u, v]) => [u - q[0], v - q[1]]);
  const best = (measure) => from.reduce((k, _, other) => (measure(from[other]) > measure(from[k]) ? other : k), 0);
  const one = best(([u, v]) => hypot(u, v)), [m, n] = from[one], [r, t] = to[one], long = hypot(m, n) || 1;
  const two = best(([u, v]) => abs(m * v - n * u)), off = (m * from[two][1] - n * from[two][0]) / long;
  const isLine = abs(off) < 1e-3 * long, ratio = hypot(r, t) || 1;
  const [[g, h], [i, j]] = isLine ? [[-n / long, m / long], [-t / ratio, r / ratio]] : [from[two], to[two]], area = m * h - n * g || 1;
  const [a, c, b, d] = [(r * h - i * n) / area, (i * m - r * g) / area, (t * h - j * n) / area, (j * m - t * g) / area];
  return [a, b, c, d, q[0] - a * p[0] - c * p[1], q[1] - b * p[0] - d * p[1]];
}

// The linkage in the drawing as it is previewed.
export class Preview {
  constructor(player, handles) {
    const [drawing] = player.drawings;
    Object.assign(this, { player, handles, drawing });
    this.root = make(drawing.svg, "g", { class: "gap", "aria-hidden": "true" });
    drawing.overlays.push(this);
  }

  // Takes the linkage of an answer, whose scene is drawn; data: `preview` of the answer, or null.
  load(data) {
    const { drawing, player: { data: { frames }, drive } } = this;
    // An answer to a drag has the numbers alone.
    if (data && !Object.keys(data.by).length) data = { ...data, by: this.linkage?.by ?? {} };
    const bodies = (data?.bodies ?? []).map((name) => drawing.bodies.find((body) => body.name === name));
    this.linkage = null;
    this.close();
    if (!data || bodies.includes(undefined)) return;
    const poses = Array.from({ length: frames }, (_, k) => bodies.map(({ x, y, cos: c, sin: s }) => [x[k], y[k], atan2(s[k], c[k])]));
    this.linkage = new Linkage(data, poses);
    // Plates of the same body move with it, and so do marks of its points and slides.
    const key = ({ at, turn }) => [...at, turn].join();
    this.bodies = bodies.map((body) => drawing.bodies.filter((other) => key(other) === key(body)));
    const { slides } = data, sorts = ["pin", "fixed pin", "point"];
    this.marks = drawing.marks.filter(({ sort }) => sorts.includes(sort)).map((mark) => [mark, this.linkage.indexOf(mark.label)]);
    this.marks.push(...drawing.marks.filter(({ sort }) => sort === "slide").map((mark) => [mark, slides.find(({ name }) => name === mark.label)?.points[0] ?? -1]));
    this.marks = this.marks.filter(([, index]) => index >= 0);
    // Rows that are equal are the same array.
    for (const row of new Set([...this.bodies.flat(), ...this.marks.map(([mark]) => mark)])) {
      for (const name of ["x", "y", "cos", "sin"]) if (row[name]) row[name] = Float64Array.from(row[name]);
    }
    // Traced points with their indices and exact rows.
    this.exact = this.marks.filter(([{ trail }]) => trail).map(([mark, index]) => [mark, index, mark.x.slice(), mark.y.slice()]);
    const unit = drive.unit === "deg" ? DEG : data.unit?.[1] ?? 1;
    this.drive = Array.from(drive.row, (value) => value * unit);
    this.show(drawing.frame ?? 0);
  }

  // Moves the drawing so that a handle is at `to`; the exact answer replaces it.
  drag({ id, keys }, to, locks) {
    const [sort, name] = id.split(":"), { frame } = this.player;
    if (!this.linkage || sort !== "point") return;
    const moved = this.linkage.drag(name, keys.filter((key) => !locks.has(key)), to, frame);
    if (moved) this.move(moved, frame);
  }

  // Draws poses at a frame, also those of traced points at all others.
  move({ numbers, poses }, frame) {
    const { linkage, drawing } = this;
    poses.forEach(([x, y, turn], k) => {
      for (const body of this.bodies[k]) [body.x[frame], body.y[frame], body.cos[frame], body.sin[frame]] = [x, y, cos(turn), sin(turn)];
    });
    this.trace(numbers);
    for (const [mark, index] of this.marks) [mark.x[frame], mark.y[frame]] = linkage.place(index, numbers, poses);
    this.handles.place(this.places(numbers, poses));
    drawing.show(frame, true);
    poses.forEach((pose, k) => this.stretch(k, numbers, pose));
  }

  // Stretches the plates of a body so that its points are where they are now.
  stretch(body, numbers, [x, y, turn]) {
    const { linkage, drawing: { s, tx, ty } } = this, on = [...linkage.points.keys()].filter((index) => linkage.points[index][0] === body && linkage.points[index][1]);
    const [before, now] = [linkage.numbers, numbers].map((from) => on.map((index) => [from[3 + 2 * index], from[4 + 2 * index]]));
    if (now.every(([u, v], k) => u === before[k][0] && v === before[k][1])) return;
    const [a, b, c, d, e, f] = affine(before, now), [p, q] = [cos(turn), sin(turn)];
    const across = (u, v) => px4(s * (p * u - q * v)), up = (u, v) => px4(-s * (q * u + p * v));
    const moved = [across(a, b), up(a, b), across(c, d), up(c, d), px(tx + s * (x + p * e - q * f)), px(ty - s * (y + q * e + p * f))];
    for (const { group } of this.bodies[body]) group.setAttribute("transform", `matrix(${moved.join(" ")})`);
  }

  // Draws the paths of traced points for other numbers. Between some frames the change of a path is nearly linear.
  trace(numbers) {
    const { linkage, drawing, exact } = this, stride = Math.ceil(drawing.frames / TRACED);
    const changeAt = (k) => {
      const base = linkage.baseAt(k), poses = base && linkage.follow(numbers, base, base);
      return exact.map(([, index, x, y]) => (poses ? linkage.place(index, numbers, poses).map((value, axis) => value - [x, y][axis][k]) : [NaN, NaN]));
    };
    if (!exact.length) return;
    let from = changeAt(0);
    for (let k = 0; k < drawing.frames - 1; k += stride) {
      const last = min(k + stride, drawing.frames - 1), to = changeAt(last);
      exact.forEach(([mark, , ...rows], n) => ["x", "y"].forEach((name, axis) => {
        for (let at = k; at <= last; at++) mark[name][at] = rows[axis][at] + from[n][axis] + (to[n][axis] - from[n][axis]) * (at - k) / (last - k);
      }));
      from = to;
    }
    for (const [mark] of exact) mark.line.setAttribute("d", drawing.trailOf(mark));
  }

  // Positions of the handles of points, by id.
  places(numbers, poses) {
    const { linkage } = this;
    return new Map(this.handles.list.flatMap(({ id }) => {
      const [sort, name] = id.split(":"), index = sort === "point" ? linkage.indexOf(name) : -1;
      return index < 0 ? [] : [[id, linkage.place(index, numbers, poses)]];
    }));
  }

  // Shows sizes with which the linkage cannot be assembled: its links, and the gap. changes: of keys since the last scene.
  open(changes) {
    this.changes = changes;
    this.show(this.drawing.frame);
  }

  close() {
    this.changes = null;
    this.root.replaceChildren();
    document.body.classList.remove("open");
  }

  // Draws the gap of a frame, if there is one, as it is seen now.
  show(frame) {
    const { linkage, drawing, changes } = this, isOpen = linkage && (changes || drawing.open.has(frame));
    this.root.replaceChildren();
    if (this.isPlaced) { this.isPlaced = false; this.handles.place(new Map()); }
    document.body.classList.toggle("open", Boolean(changes && linkage));
    if (!isOpen) return;
    const base = linkage.baseAt(frame, this.drive), gap = base && linkage.opened(linkage.changed(changes ?? {}), base);
    if (!gap) return;
    const { numbers, poses } = gap, at = (index) => drawing.screen(...linkage.place(index, numbers, poses));
    poses.forEach((_, body) => {
      const points = linkage.points.flatMap(([on, name], index) => (on === body && name ? [at(index).map(px)] : []));
      if (body && points.length > 1) make(this.root, "path", { d: `M${points.join("L")}${points.length > 2 ? "z" : ""}`, class: "link" });
    });
    for (const [index] of linkage.pins) { const [cx, cy] = at(index).map(px); make(this.root, "circle", { cx, cy, r: 4 }); }
    const [from, to] = gap.ends.map((place) => drawing.screen(...place)), [unit, mm] = drawing.data.unit ?? ["mm", 1];
    make(this.root, "path", { d: `M${from.map(px)}L${to.map(px)}`, class: "missing" });
    const [x, y] = from.map((value, k) => px((value + to[k]) / 2));
    make(this.root, "text", { x, y, dx: 8, dy: -6 }, measured(gap.length / mm, unit));
    this.isPlaced = true;
    this.handles.place(this.places(numbers, poses));
  }
}
