// Names in a drawing. Each takes the position at which it overlaps the fewest other names and pins, and stays inside.
import { abs, make, max, min, px, round, see } from "./shapes.js";

// Number of frames at which overlaps are counted.
const LOOKS = 24;
// Pixels kept free at either end of a name.
const EDGE = 2;

export class Names {
  // line: height of the tallest name, px, which depends on the reader's font.
  constructor(drawing) { Object.assign(this, { drawing, all: [], line: 0 }); }

  // spots: functions of a frame and half the text's width, px, that return possible positions of its middle, the best
  // first. A text that the edge would cut off is moved inwards. number: of a dimension among all.
  add(text, look, role, spots, number) {
    const shape = make(this.drawing.names, "text", { class: `name ${look}`, ...(number === undefined ? {} : { "data-dimension": number }) }, text);
    const { width, height } = shape.getBBox(), half = EDGE + width / 2;
    this.line = max(this.line, height);
    spots = spots.map((spot) => (k) => {
      const [x, y] = spot(k, half), over = x - max(half, min(this.drawing.wide - half, x));
      return [abs(over) > 2 * half ? x : x - over, y];
    });
    // Until `arrange` is called, a name is at its first position.
    this.all.push({ shape, role, spots, half, spot: spots[0] });
  }

  arrange() {
    const { frames, hidden, marks, wide, tall } = this.drawing, { line } = this, taken = [];
    const looks = Array.from({ length: LOOKS }, (_, k) => round(k * (frames - 1) / LOOKS));
    const pins = marks.filter((mark) => mark.always || mark.trail);
    const pinned = looks.map((k) => pins.map((pin) => this.drawing.screen(pin.x[k], pin.y[k])));
    for (const name of this.all) {
      if (hidden.has(name.role)) continue;
      let { half, spots } = name, low = Infinity;
      spots.forEach((spot, cost) => {
        const places = looks.map(spot);
        places.forEach(([x, y], look) => {
          if (x <= half || x >= wide - half || y < line / 2 || y > tall - line) cost += 2;
          for (const other of taken) {
            const [u, v] = other.places[look];
            if (abs(x - u) < half + other.half && abs(y - v) < line) cost += 3;
          }
          for (const [u, v] of pinned[look]) if (abs(x - u) < half + 2 && abs(y - v) < line / 2 + 4) cost++;
        });
        if (cost < low) { low = cost; Object.assign(name, { spot, places }); }
      });
      taken.push(name);
    }
  }

  // Whether two texts overlap, each [x, y] of its middle and half its width, px.
  overlap([x, y, half], [u, v, other]) { return abs(x - u) < half + other && abs(y - v) < this.line; }

  // Shows frame k. A name is hidden at frames at which it overlaps an earlier one.
  show(k) {
    const shown = this.shown = [];
    for (const { shape, spot, half, role } of this.all) {
      if (this.drawing.hidden.has(role)) continue;
      const [x, y] = spot(k), on = isFinite(x + y) && !shown.some((other) => this.overlap([x, y, half], other));
      see(shape, on);
      if (!on) continue;
      shown.push([x, y, half, shape]);
      shape.setAttribute("transform", `translate(${px(x)} ${px(y + 4)})`);
    }
  }
}
