// Wanted poses of a body: copies of its outline that are placed by presses, moved and turned by their handles, and taken away.
import { make, px } from "../player/shapes.js";

const { atan2, cos, hypot, PI, sin } = Math;
// Half the size of an outline before there are poses, px; poses that a recipe needs at least.
const SIZE = 44, LEAST = 3;
// Pixels by which a pointer that turns a copy is away from its middle, and between copies that a key places.
const TURNED = 16, BESIDE = 90;
// The outline in its own axes, x to the front, which has a notch, unless another one was drawn; in arms.
const OUTLINE = [[-0.5, -0.5], [0.7, -0.5], [1, -0.2], [1, 0.5], [-0.5, 0.5]], CROSS = [-0.5, 0.5];
// Most corners of an outline that was drawn.
const CORNERS = 120;

export class Poses {
  // tools: editor, drawing, shown, draw().
  constructor(tools, root) {
    Object.assign(this, { tools, kept: [], held: null, stroke: null, outline: null });
    this.buttons = make(root, "div", { class: "buttons" });
    this.button = make(this.buttons, "button", { type: "button" }, "Draw the outline");
    this.button.addEventListener("click", () => { this.stroke = this.stroke ? null : []; this.update(); });
  }

  load({ kind }) {
    this.isRecipe = kind === "body-guidance";
    Object.assign(this, { kept: [], held: null, stroke: null });
    this.update();
  }

  // Shows what can be done now.
  update() {
    this.buttons.hidden = this.tools.tool !== "pose";
    document.body.classList.toggle("posing", Boolean(this.tools.isActive && !this.buttons.hidden && !this.stroke));
    this.button.disabled = !this.tools.drawing || !this.all.length;
    this.button.setAttribute("aria-pressed", Boolean(this.stroke));
    this.tools.draw();
  }

  // Forgets an outline that was drawn.
  forget() { this.outline = null; }

  // The poses of the recipe as their handles are: { at, arm }, mm, arm from the origin to the handle of its angle.
  get known() {
    if (!this.isRecipe) return [];
    const { elements } = this.tools.editor.handles, placed = new Map();
    for (const { handle: { id, at }, pointer } of elements.values()) if (/^point:wanted\.poses\[/.test(id)) placed.set(id.slice(19, -1), pointer ?? at);
    const poses = [];
    for (let k = 0; placed.has(`${k}][0`); k++) {
      const at = placed.get(`${k}][0`), end = placed.get(`${k}][2`);
      poses.push({ at, arm: [end[0] - at[0], end[1] - at[1]] });
    }
    return poses;
  }

  // Copies are kept until there are enough for a recipe: { at, arm }.
  get all() { return [...this.known, ...this.kept, ...this.held ? [this.held] : []]; }

  // An arm of the length of the others in the direction of the last one.
  get arm() { return this.all.at(-1)?.arm ?? [SIZE / this.tools.drawing.s, 0]; }

  press(at) {
    if (this.stroke) { this.isDrawing = true; this.move(at); return; }
    const { drawing } = this.tools, k = this.known.length > LEAST ? this.crosses.findIndex(([x, y]) => hypot(x - at[0], y - at[1]) < TURNED) : -1;
    if (k >= 0) { this.remove(k); return; }
    this.held = { at: drawing.plane(at), arm: this.arm };
  }

  // Drawn outwards, a press turns its copy.
  move(at) {
    const { held, tools: { drawing } } = this;
    if (this.isDrawing) this.stroke.push(drawing.plane(at));
    if (held) {
      const [x, y] = drawing.screen(...held.at), length = hypot(...held.arm), angle = atan2(y - at[1], at[0] - x);
      if (hypot(x - at[0], y - at[1]) > TURNED) held.arm = [length * cos(angle), length * sin(angle)];
    }
    this.tools.draw();
  }

  release() {
    const { held } = this;
    if (this.isDrawing) this.takeOutline();
    if (!held) return;
    this.held = null;
    this.place(held);
  }

  // The stroke is the outline of the body in the pose that is nearest to its start.
  takeOutline() {
    const { stroke } = this, away = ({ at: [x, y] }) => hypot(x - stroke[0][0], y - stroke[0][1]), every = Math.ceil(stroke.length / CORNERS);
    const { at: [x, y], arm: [a, b] } = this.all.reduce((best, pose) => (away(pose) < away(best) ? pose : best)), square = a * a + b * b;
    if (stroke.length > 2) {
      this.outline = stroke.filter((_, k) => k % every === 0).map(([u, v]) => [((u - x) * a + (v - y) * b) / square, ((v - y) * a - (u - x) * b) / square]);
      this.length = hypot(a, b);
    }
    Object.assign(this, { stroke: null, isDrawing: false });
    this.update();
  }

  // Enter places a copy beside the last one.
  key({ key }) {
    if (key !== "Enter") return false;
    const { drawing } = this.tools, at = this.all.at(-1)?.at ?? drawing.plane([0.3 * drawing.wide, drawing.tall / 2]);
    this.place({ at: [at[0] + BESIDE / drawing.s, at[1]], arm: this.arm });
    return true;
  }

  place(pose) {
    const { editor, drawing } = this.tools, isEnough = this.isRecipe || this.kept.length + 1 >= LEAST;
    this.kept.push(pose);
    this.update();
    const more = LEAST - this.kept.length;
    if (!isEnough) { editor.announce(`${more} more ${more > 1 ? "poses" : "pose"}`); return; }
    editor.announce("");
    editor.replaceBy({ draw: { poses: this.kept.map(({ at, arm }) => [...at, atan2(arm[1], arm[0]) * 180 / PI]), step: 1 / drawing.s } });
  }

  // Takes a pose of the recipe away.
  remove(k) {
    const { editor } = this.tools;
    if (this.known.length <= LEAST) { editor.announce("A body is guided through three poses or more"); return; }
    editor.replaceBy({ set: { [`wanted.poses[${k}]`]: null } });
  }

  cancel() {
    const had = this.kept.length > 0;
    this.load({ kind: this.isRecipe ? "body-guidance" : "" });
    return had;
  }

  // A place on a copy, in arms, on the stage, px; an outline that was drawn keeps its size.
  spot({ at, arm }, [u, v], size = 1) {
    const [a, b] = arm.map((x) => size * x);
    return this.tools.drawing.screen(at[0] + u * a - v * b, at[1] + u * b + v * a);
  }

  drawCopy(pose, look = "copy") {
    const size = this.outline ? this.length / hypot(...pose.arm) : 1, corners = (this.outline ?? OUTLINE).map((place) => this.spot(pose, place, size).map(px));
    make(this.tools.shown, "path", { d: `M${corners.join("L")}z`, class: look });
  }

  // Where a press takes a pose away, px.
  get crosses() { return this.known.map((pose) => this.spot(pose, CROSS)); }

  // The body as the linkage carries it now; null if there is none.
  get carried() {
    const { drawing: { marks }, editor: { player: { frame, data: { columns } } } } = this.tools;
    const angle = columns.find(({ id }) => id === "body_angle")?.row[frame] * PI / 180, point = marks.find(({ role, trail }) => role === "traced" && trail);
    if (!this.known.length || !point || !isFinite(angle + point.x[frame])) return null;
    const length = hypot(...this.arm);
    return { at: [point.x[frame], point.y[frame]], arm: [length * cos(angle), length * sin(angle)] };
  }

  draw() {
    const { shown, isActive, tool } = this.tools;
    this.all.forEach((pose, k) => {
      const [x, y] = this.tools.drawing.screen(...pose.at);
      this.drawCopy(pose);
      if (k >= this.known.length) make(shown, "text", { x: px(x), y: px(y), "text-anchor": "middle", dy: 5 }, String(k + 1));
    });
    if (this.carried) this.drawCopy(this.carried, "copy carried");
    if (this.stroke?.length > 1) make(shown, "path", { d: `M${this.stroke.map((at) => this.tools.drawing.screen(...at).map(px)).join("L")}`, class: "stroke" });
    if (!isActive || tool !== "pose" || this.known.length <= LEAST) return;
    for (const [x, y] of this.crosses) {
      make(shown, "circle", { cx: px(x), cy: px(y), r: 9, class: "cross" });
      make(shown, "path", { d: `M${px(x - 4)} ${px(y - 4)}l8 8m0-8l-8 8`, class: "cross" });
    }
  }
}
