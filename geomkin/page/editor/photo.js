// A picture under the stage, such as a photograph: it is moved, scaled to a true length, traced by a stroke, or its outline is
// followed. It stays in the browser: no request has it.
import { lengthField } from "./dimensions.js";
import { make, max, min, px } from "../player/shapes.js";

// Pixels of the longer side of the picture that is kept, and of the one whose outline is followed.
const KEPT = 1600, COARSE = 240;
// Share of the stage that a new picture takes; factor of a press of plus, and pixels of one of an arrow key.
const SHARE = 0.8, CLOSER = 1.05, STEP = 10;
// Most points of an outline, before it is smoothed, and least pixels of one.
const MOST_POINTS = 2000, LEAST = 16;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Photo {
  // tools: editor, drawing, shown, draw(), choose(tool).
  constructor(tools, root) {
    Object.assign(this, { tools, canvas: null, line: null });
    this.file = make(root, "input", { type: "file", accept: "image/*", "aria-label": "Picture", hidden: "" });
    this.file.addEventListener("change", () => { this.take(this.file.files[0]); this.file.value = ""; });
    this.buttons = make(root, "div", { class: "buttons", role: "group", "aria-label": "Picture" });
    const acts = {
      "Choose a picture": () => this.file.click(),
      "True length": ({ detail }) => this.measure(detail === 0),
      Outline: () => this.follow(),
      Remove: () => this.remove(),
    };
    for (const [label, act] of Object.entries(acts)) make(this.buttons, "button", { type: "button" }, label).addEventListener("click", act);
  }

  mount() {
    const { drawing } = this.tools;
    this.image = make(drawing.svg, "image", { class: "photo" });
    drawing.svg.insertBefore(this.image, drawing.guides);
    drawing.overlays.push(this);
    this.show();
  }

  // Lays the picture of a file under the middle of the stage.
  async take(file) {
    const { tools: { drawing, editor } } = this;
    let picture;
    try { picture = await createImageBitmap(file); } catch { editor.announce("The browser cannot read a picture in this file"); return; }
    this.remove();
    this.canvas = scaledDown(picture, KEPT);
    const { width, height } = this.canvas, content = await new Promise((resolve) => { this.canvas.toBlob(resolve, "image/jpeg", 0.85); });
    for (const [name, value] of Object.entries({ width, height, href: URL.createObjectURL(content) })) this.image.setAttribute(name, value);
    this.per = SHARE * min(drawing.wide / width, drawing.tall / height) / drawing.s;
    const [x, y] = drawing.plane([drawing.wide / 2, drawing.tall / 2]);
    this.at = [x - this.per * width / 2, y + this.per * height / 2];
    editor.showTools(true);
    this.tools.choose("photo");
    this.show();
  }

  remove() {
    if (!this.canvas) return;
    URL.revokeObjectURL(this.image.getAttribute("href"));
    this.image.removeAttribute("href");
    Object.assign(this, { canvas: null, line: null });
    this.tools.editor.player.refit();
    this.update();
  }

  // Left, lower, right and upper end, mm; null without a picture.
  get box() {
    if (!this.canvas) return null;
    const { at: [x, y], per, canvas: { width, height } } = this;
    return [x, y - per * height, x + per * width, y];
  }

  show() {
    if (!this.canvas) return;
    const { tools: { drawing }, at, per } = this, s = (drawing.s * per).toPrecision(6);
    this.image.setAttribute("transform", `matrix(${s} 0 0 ${s} ${drawing.screen(...at).map(px).join(" ")})`);
  }

  // Shows what can be done with it now.
  update() {
    this.buttons.hidden = this.tools.tool !== "photo";
    for (const [k, button] of [...this.buttons.children].entries()) button.hidden = k > 0 && !this.canvas;
    this.buttons.children[1].setAttribute("aria-pressed", Boolean(this.line));
    this.show();
    this.tools.draw();
  }

  // The corners on the stage, px, in order.
  get corners() {
    const [left, low, right, high] = this.box;
    return [[left, low], [right, low], [right, high], [left, high]].map((at) => this.tools.drawing.screen(...at));
  }

  // Multiplies its size and keeps a place, mm, where it is.
  scale(times, [x, y]) {
    this.per *= times;
    this.at = [x + times * (this.at[0] - x), y + times * (this.at[1] - y)];
  }

  // --- the pointer and keys --------------------------------------------------------------------------------------------

  press(at, near) {
    if (!this.canvas) { this.file.click(); return; }
    const { drawing } = this.tools, place = drawing.plane(at);
    if (this.line) { this.line = [place, place]; return; }
    const k = this.corners.findIndex(([x, y]) => Math.hypot(x - at[0], y - at[1]) < near);
    this.held = { last: place, fixed: k < 0 ? null : drawing.plane(this.corners[(k + 2) % 4]) };
  }

  move(at) {
    const { held, line, tools: { drawing } } = this, place = drawing.plane(at);
    if (line?.length) line[1] = place;
    else if (held?.fixed) {
      const off = (point) => Math.hypot(point[0] - held.fixed[0], point[1] - held.fixed[1]);
      this.scale(max(off(place), 10 / drawing.s) / off(held.last), held.fixed);
    } else if (held) this.at = this.at.map((x, k) => x + place[k] - held.last[k]);
    if (held) held.last = place;
    this.update();
  }

  release() {
    const { line } = this;
    this.held = null;
    if (line?.length) this.ask(...line);
  }

  key({ key }) {
    if (!this.canvas) return false;
    const { drawing } = this.tools, [left, low, right, high] = this.box, direction = ARROWS[key], times = { "+": CLOSER, "-": 1 / CLOSER }[key];
    if (direction) this.at = this.at.map((x, k) => x + direction[k] * STEP / drawing.s);
    else if (times) this.scale(times, [(left + right) / 2, (low + high) / 2]);
    else if (key === "Delete") this.remove();
    else return false;
    this.update();
    return true;
  }

  cancel() {
    const wasDrawn = Boolean(this.line);
    this.line = null;
    this.update();
    return wasDrawn;
  }

  draw() {
    const { tools: { shown, drawing }, line } = this;
    if (!this.canvas) return;
    make(shown, "path", { d: `M${this.corners.map((at) => at.map(px)).join("L")}z`, class: "frame" });
    for (const [cx, cy] of this.corners) make(shown, "circle", { cx: px(cx), cy: px(cy), r: 7 });
    if (line?.length) make(shown, "path", { d: `M${line.map((at) => drawing.screen(...at).map(px)).join("L")}`, class: "stroke" });
  }

  // --- its true size, and its outline ----------------------------------------------------------------------------------

  // Lets a line be drawn whose length is then typed; of the keyboard it is the width of the picture.
  measure(isByKey) {
    const [left, , right, high] = this.box;
    this.line = [];
    this.update();
    if (isByKey) this.ask([left, high], [right, high]);
    else this.tools.editor.announce("Draw a line on the picture along something of known length");
  }

  ask(from, to) {
    const { drawing, editor } = this.tools, drawn = Math.hypot(to[0] - from[0], to[1] - from[1]), [unit, mm] = drawing.data.unit ?? ["mm", 1];
    const middle = [0, 1].map((k) => (from[k] + to[k]) / 2);
    if (drawn * drawing.s < LEAST) { this.cancel(); return; }
    this.line = [from, to];
    lengthField(drawing, drawing.screen(...middle), `${+(drawn / mm).toPrecision(4)}`, (length) => {
      this.line = null;
      if (length > 0) this.scale(length * mm / drawn, middle);
      this.update();
      editor.announce(length > 0 ? `The picture is scaled: this line is ${+length.toPrecision(6)} ${unit} long` : "");
      editor.player.refit();
    });
  }

  // The outline of its largest shape is the wanted path.
  follow() {
    const small = scaledDown(this.canvas, COARSE), corners = outlineOf(small), { editor } = this.tools;
    if (corners.length < LEAST) { editor.announce("The picture has no shape that differs from its border"); return; }
    const every = Math.ceil(corners.length / MOST_POINTS), per = this.per * this.canvas.width / small.width;
    const points = corners.filter((_, k) => k % every === 0).map(([u, v]) => [this.at[0] + per * u, this.at[1] - per * v]);
    this.tools.choose("move");
    editor.drawPath(points);
  }
}

function scaledDown(picture, most) {
  const share = min(1, most / max(picture.width, picture.height)), canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height].map((size) => max(1, Math.round(share * size)));
  const paper = canvas.getContext("2d", { willReadFrequently: true });
  paper.fillStyle = "#fff";
  paper.fillRect(0, 0, canvas.width, canvas.height);
  paper.drawImage(picture, 0, 0, canvas.width, canvas.height);
  return canvas;
}

// The boundary of the largest area that is darker or lighter than most of the border, as corners of pixels in order.
function outlineOf(canvas) {
  const { width, height } = canvas, { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  const grey = Uint8Array.from({ length: width * height }, (_, k) => (3 * data[4 * k] + 6 * data[4 * k + 1] + data[4 * k + 2]) / 10);
  const cut = threshold(grey), isBorder = (k) => k < width || k >= width * (height - 1) || k % width === 0 || (k + 1) % width === 0;
  let light = 0;
  for (const [k, value] of grey.entries()) if (isBorder(k)) light += value > cut ? 1 : -1;
  // Each area is filled from one of its pixels; area: its number by pixel, 0 outside of all.
  const area = new Uint16Array(grey.length), isShape = (k) => !area[k] && (grey[k] > cut) !== (light > 0);
  let count = 0, largest = 0, most = 0, first = 0;
  for (let start = 0; start < grey.length; start++) {
    if (!isShape(start)) continue;
    let size = 0;
    area[start] = ++count;
    for (const waiting = [start]; waiting.length; size++) {
      const k = waiting.pop();
      for (const next of [k % width ? k - 1 : k, (k + 1) % width ? k + 1 : k, k - width, k + width]) {
        if (next >= 0 && next < grey.length && isShape(next)) { area[next] = count; waiting.push(next); }
      }
    }
    if (size > most) [largest, most, first] = [count, size, start];
  }
  if (!most) return [];
  // Along the edges of pixels, the area at the right.
  const has = (x, y) => x >= 0 && y >= 0 && x < width && y < height && area[x + width * y] === largest;
  const corners = [], [left, top] = [first % width, Math.floor(first / width)];
  let [x, y, u, v] = [left, top, 1, 0];
  do {
    corners.push([x, y]);
    [x, y] = [x + u, y + v];
    // The pixels ahead, at the left and at the right.
    const [a, b] = [x + (u - 1) / 2, y + (v - 1) / 2], isLeft = has(a + v / 2, b - u / 2), isRight = has(a - v / 2, b + u / 2);
    if (!isRight) [u, v] = [-v, u]; else if (isLeft) [u, v] = [v, -u];
  } while (x !== left || y !== top);
  return corners;
}

// The grey between the two classes that differ most (Otsu's threshold).
function threshold(grey) {
  const counts = new Float64Array(256);
  for (const value of grey) counts[value]++;
  const total = counts.reduce((sum, count, value) => sum + count * value, 0);
  let best = 0, cut = 0, below = 0, sum = 0;
  for (let value = 0; value < 255; value++) {
    below += counts[value];
    sum += counts[value] * value;
    const above = grey.length - below, apart = below && above ? sum / below - (total - sum) / above : 0;
    if (below * above * apart * apart > best) [best, cut] = [below * above * apart * apart, value];
  }
  return cut;
}
