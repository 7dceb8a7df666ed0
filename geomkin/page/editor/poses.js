// Wanted poses of a body: copies of its outline that are placed by presses, moved and turned by their handles, and taken away.
import { make, px } from "../player/shapes.js";

const { atan2, cos, hypot, PI, sin } = Math;
// Half the size of an outline before there are poses, px; poses that a recipe needs at least.
const SIZE = 44, LEAST = 3;
// Pixels by which a pointer that turns a copy is away from its middle, and between copies that a key places.
const TURNED = 16, BESIDE = 90;
// The outline in its own axes, x to the front, which has a notch; in sizes.
const OUTLINE = [[-0.5, -0.5], [0.7, -0.5], [1, -0.2], [1, 0.5], [-0.5, 0.5]];

export class Poses {
  // tools: editor, drawing, shown, draw().
  constructor(tools) { Object.assign(this, { tools, kept: [], held: null }); }

  load({ kind }) {
    this.isRecipe = kind === "body-guidance";
    Object.assign(this, { kept: [], held: null });
  }

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
    const { drawing } = this.tools, k = this.known.length > LEAST ? this.crosses.findIndex(([x, y]) => hypot(x - at[0], y - at[1]) < TURNED) : -1;
    if (k >= 0) { this.remove(k); return; }
    this.held = { at: drawing.plane(at), arm: this.arm };
  }

  // Drawn outwards, a press turns its copy.
  move(at) {
    const { held, tools: { drawing } } = this;
    this.hover = at;
    if (held) {
      const [x, y] = drawing.screen(...held.at), length = hypot(...held.arm), angle = atan2(y - at[1], at[0] - x);
      if (hypot(x - at[0], y - at[1]) > TURNED) held.arm = [length * cos(angle), length * sin(angle)];
    }
    this.tools.draw();
  }

  release() {
    const { held } = this;
    if (!held) return;
    this.held = null;
    this.place(held);
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
    this.tools.draw();
    const more = LEAST - this.kept.length;
    if (!isEnough) { editor.announce(`${more} more ${more > 1 ? "poses" : "pose"}`); return; }
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
    this.tools.draw();
    return had;
  }

  // Corners of a copy, px.
  corners({ at, arm }) {
    const { drawing } = this.tools;
    return OUTLINE.map(([u, v]) => drawing.screen(at[0] + u * arm[0] - v * arm[1], at[1] + u * arm[1] + v * arm[0]));
  }

  // Where a press takes a pose away, px.
  get crosses() { return this.known.map((pose) => this.corners(pose).at(-1)); }

  draw() {
    const { shown, isActive, tool } = this.tools;
    this.all.forEach((pose, k) => {
      const [x, y] = this.tools.drawing.screen(...pose.at);
      make(shown, "path", { d: `M${this.corners(pose).map((at) => at.map(px)).join("L")}z`, class: "copy" });
      if (k >= this.known.length) make(shown, "text", { x: px(x), y: px(y), "text-anchor": "middle", dy: 5 }, String(k + 1));
    });
    if (!isActive || tool !== "pose" || this.known.length <= LEAST) return;
    for (const [x, y] of this.crosses) {
      make(shown, "circle", { cx: px(x), cy: px(y), r: 9, class: "cross" });
      make(shown, "path", { d: `M${px(x - 4)} ${px(y - 4)}l8 8m0-8l-8 8`, class: "cross" });
    }
  }
}
