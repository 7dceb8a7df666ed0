// The ghost: the mechanism as it was saved, drawn behind the edited one by outlines of plates, links and paths of points.
import { make, pointsOf, px, see } from "../player/shapes.js";

const DEG = Math.PI / 180;

export class Ghost {
  constructor(drawing) {
    this.drawing = drawing;
    this.root = make(drawing.svg, "g", { class: "ghost", "aria-hidden": "true" });
    drawing.svg.insertBefore(this.root, drawing.plates);
    drawing.overlays.push(this);
  }

  // Shows the data of a scene, with unpacked rows; hides the ghost if `data` is null.
  load(data) {
    this.root.replaceChildren();
    this.data = data;
    if (!data) return;
    const { scenes: [scene], rows, paths, frames } = data;
    this.frames = frames;
    this.bodies = scene.bodies.filter(({ cut, fixed }) => cut.length && !fixed).map((body) => {
      const group = make(this.root, "g"), [x, y, turn] = [...body.at, body.turn].map((index) => rows[index]);
      for (const index of body.cut) if (pointsOf(paths[index]).points.length) make(group, "path", { d: paths[index] });
      return { group, x, y, turn };
    });
    this.lines = scene.marks.filter(({ sort }) => sort === "line").map(({ at, vector }) => ({
      path: make(this.root, "path"), ends: [...at, ...vector].map((index) => rows[index]),
    }));
    this.trails = scene.marks.filter(({ trail }) => trail).map(({ at: [x, y] }) => ({ path: make(this.root, "path"), x: rows[x], y: rows[y] }));
    this.show(this.drawing.frame ?? 0);
  }

  // The row of the former mechanism, and the share of the way to the next one, with the driver where it is at a frame; rows
  // of a driver that goes forth and back are those nearest in time.
  placeOf(frame) {
    const { drive, frames, data } = this.drawing, [{ row, name }] = this.data.columns, value = drive[frame];
    if (name !== data.columns[0].name) return [-1, 0];
    const wanted = frame * (this.frames - 1) / Math.max(frames - 1, 1), near = 1e-6 * Math.abs(row[this.frames - 1] - row[0]);
    let best = [-1, 0], least = Infinity;
    for (let k = 0; k < this.frames; k++) {
      const step = row[k + 1] - row[k], share = Math.abs(value - row[k]) <= near ? 0 : (value - row[k]) / step;
      if (share >= 0 && share < 1 && Math.abs(k - wanted) < least) [best, least] = [[k, share], Math.abs(k - wanted)];
    }
    return best;
  }

  show(frame) {
    if (!this.data) return;
    const { drawing } = this, { s } = drawing, [k, share] = this.placeOf(frame);
    // Between two rows of another step; unknown, and so not drawn, where the driver was not.
    const at = (row) => (share ? row[k] + share * (row[k + 1] - row[k]) : row[k] ?? NaN);
    for (const { group, x, y, turn } of this.bodies) {
      const [u, v] = drawing.screen(at(x), at(y)), c = s * Math.cos(at(turn) * DEG), n = s * Math.sin(at(turn) * DEG);
      see(group, isFinite(u + c));
      if (isFinite(u + c)) group.setAttribute("transform", `matrix(${c.toFixed(4)} ${(-n).toFixed(4)} ${(-n).toFixed(4)} ${(-c).toFixed(4)} ${px(u)} ${px(v)})`);
    }
    for (const { path, ends: [x, y, u, v] } of this.lines) {
      const from = drawing.screen(at(x), at(y)), to = drawing.screen(at(x) + at(u), at(y) + at(v));
      path.setAttribute("d", isFinite(from[0] + to[0]) ? `M${from.map(px)}L${to.map(px)}` : "");
    }
    const view = [s, drawing.tx, drawing.ty].join();
    if (view === this.view && this.data === this.drawn) return;
    [this.view, this.drawn] = [view, this.data];
    for (const { path, x, y } of this.trails) {
      let d = "";
      for (let row = 0; row < this.frames; row++) {
        const known = isFinite(x[row]);
        if (known) d += `${row && isFinite(x[row - 1]) ? "L" : "M"}${drawing.screen(x[row], y[row]).map(px)}`;
      }
      path.setAttribute("d", d);
    }
  }
}
