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

  show(frame) {
    if (!this.data) return;
    const { drawing } = this, { s } = drawing, k = Math.min(frame, this.frames - 1);
    for (const { group, x, y, turn } of this.bodies) {
      const [u, v] = drawing.screen(x[k], y[k]), c = s * Math.cos(turn[k] * DEG), n = s * Math.sin(turn[k] * DEG);
      see(group, isFinite(u + c));
      if (isFinite(u + c)) group.setAttribute("transform", `matrix(${c.toFixed(4)} ${(-n).toFixed(4)} ${(-n).toFixed(4)} ${(-c).toFixed(4)} ${px(u)} ${px(v)})`);
    }
    for (const { path, ends: [x, y, u, v] } of this.lines) {
      const from = drawing.screen(x[k], y[k]), to = drawing.screen(x[k] + u[k], y[k] + v[k]);
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
