// Tools of the stage: a linkage is built, and a wanted path drawn, by clicks and strokes; the server makes each edit.
import { drawFace } from "./form.js";
import { Photo } from "./photo.js";
import { Poses } from "./poses.js";
import { make, px } from "../player/shapes.js";

const { hypot, max, min } = Math;
// Pixels within which a click means a point, and a body or slide.
const NEAR_POINT = matchMedia("(pointer: coarse)").matches ? 22 : 14, NEAR_BODY = 9;
// Pixels that a pointer moves between two clicks by one press.
const PRESSED = 12;
const ANY = ["point", "body"];

// Tools of recipes that are no linkages themselves.
const ALWAYS = ["move", "path", "pose", "photo"];
// Turns of a drawn spring, and its width, px.
const COILS = 8, WIDE = 7;
// Points that are taken of a dropped drawing.
const SAMPLES = 400;

// Each tool: its label, what it says, and of each click what it may mean besides a place. One without clicks is no edit.
const TOOLS = {
  move: ["Move", "Drag a point or a handle; drag a link to turn the driver."],
  pivot: ["Pivot", "Click where a fixed pivot is, or on a point that becomes one.", ["point"]],
  bar: ["Bar", "Click both ends: points, bodies or empty places; or draw it in one stroke.", ANY, ANY],
  plate: ["Plate", "Click three corners: points, bodies or empty places.", ANY, ANY, ANY],
  dyad: ["Dyad", "Click two points, or places of fixed pivots; then where the two bars meet.", ANY, ANY, ["point"]],
  slide: ["Slide", "Click the point that a bar joins to a block, where the block is, and in which direction it slides.", ANY, ["point"], []],
  guide: ["Guide", "Click a pin that runs in a slot of the ground, and the direction of the slot.", ["point"], []],
  lever: ["Lever", "Click a pin that runs in the slot of a lever, and the pivot of the lever.", ["point"], ["point"]],
  trace: ["Traced point", "Click a body, and where its traced point is.", ["body"], []],
  force: ["Force", "Click a point or a body, and the direction of the force.", ANY, []],
  spring: ["Spring", "Click the two ends: points or bodies; an empty place is on the ground.", ANY, ANY],
  driver: ["Driver", "Click the body that is driven.", ["body"]],
  motor: ["Motor", "Click the body that a motor drives, and choose the motor.", ["body"]],
  delete: ["Delete", "Click a point, a slide, a force, a spring or a body.", ["point", "slide", "load", "body"]],
  path: ["Path", "Draw the path that a linkage is to follow, or drop an SVG drawing: known linkages appear, then the search begins."],
  pose: ["Pose", "Click three or more places of a body; draw outwards to turn it. Drag the handles of a pose."],
  photo: ["Picture", "Choose or drop a picture to trace: drag it, or a corner of it; give the true length of something in it; then draw a path over it."],
  rename: ["Name", "Click a point, a slide or a body, and type its name.", ["point", "slide", "body"]],
};

// Distance of a place from the line between two, px.
function apart([u, v], [p, q], [x, y]) {
  const [a, b] = [p - u, q - v], share = max(0, min(1, ((x - u) * a + (y - v) * b) / (a * a + b * b || 1)));
  return hypot(u + share * a - x, v + share * b - y);
}

// Whether a place is inside a polygon.
const isInside = ([x, y], corners) => corners.reduce((inside, [u, v], k) => {
  const [p, q] = corners.at(k - 1);
  return (v > y) !== (q > y) && x < u + (p - u) * (y - v) / (q - v) ? !inside : inside;
}, false);

// The key of the motor in the form.
const MOTOR = "stock.motor";
const NO_PIVOT = "This body turns on no fixed pivot; choose one that does";
// A name of a body, point or slide, as the recipe has it.
const NAME = /^[\p{L}\p{N}]([\p{L}\p{M}\p{N} _-]*[\p{L}\p{M}\p{N}_-])?$/u;
const NAME_RULE = "Give letters, digits, spaces, _ and -, beginning with a letter or digit.";

export class Tools {
  // editor: player, handles, build(edit), drawPath(points), known(points), announce(text).
  constructor(root, editor) {
    Object.assign(this, { root, editor, tool: "move", clicks: [], hover: null });
    const bar = make(root, "div", { class: "buttons", role: "toolbar", "aria-label": "Build" });
    this.buttons = Object.entries(TOOLS).map(([name, [label, about]]) => {
      const button = make(bar, "button", { type: "button", title: about, "data-tool": name, "aria-pressed": "false" }, label);
      button.addEventListener("click", () => this.choose(name));
      return button;
    });
    const row = make(root, "div", { class: "buttons said" }), line = make(row, "p", { role: "status" });
    this.stated = make(line, "b");
    this.about = make(line, "span", { id: "tool-about" });
    // Tools that have pointer and keys for themselves.
    this.own = { pose: new Poses(this, row), photo: new Photo(this, row) };
    this.dialog = document.getElementById("rename-dialog");
    this.motors = document.getElementById("motor-dialog");
  }

  // The layer above the drawing that takes the clicks.
  mount() {
    const { handles: { onDrawing: { root: handles } }, player: { drawings: [drawing] } } = this.editor;
    this.drawing = drawing;
    this.layer = make(handles.parentNode, "svg", { class: "tool-layer" });
    this.coils = make(this.layer, "path", { class: "spring" });
    this.shown = make(this.layer, "g");
    const act = { pointerdown: (event) => this.press(event), pointermove: (event) => this.move(event), pointerup: (event) => this.release(event), pointerleave: () => this.leave() };
    for (const [name, does] of Object.entries(act)) this.layer.addEventListener(name, does);
    this.layer.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.own[this.tool]?.key(event)) return;
      event.preventDefault();
      event.stopPropagation();
    });
    this.own.photo.mount();
    drawing.overlays.push(this);
    const stage = handles.parentNode;
    stage.addEventListener("dragover", (event) => event.preventDefault());
    stage.addEventListener("drop", (event) => this.drop(event));
    this.choose(this.tool);
  }

  // Shows the tools of a linkage, with what it still lacks; structure: the names of an answer.
  load(reply) {
    const { structure, unfinished, springs } = reply;
    Object.assign(this, { structure, springs, clicks: [], hover: null, stroke: null });
    this.own.pose.load(reply);
    if (this.shafts) this.choose("move");
    for (const button of this.buttons) button.hidden = !structure && !ALWAYS.includes(button.dataset.tool);
    this.stated.textContent = unfinished || (structure ? "1 degree of freedom: it moves" : "");
    this.say();
    this.draw();
  }

  // Asks for one of the shafts, each { body, at }, and calls act(body, phase): a press on it, drawn outwards, gives the phase.
  pick(shafts, act) {
    this.choose("move");
    this.shafts = { all: shafts, act, held: null, phase: 0 };
    this.setActive();
    this.editor.player.play(false);
    this.editor.announce("Click the shaft that turns it; draw outwards to turn its driver by a phase");
    this.draw();
  }

  choose(tool) {
    Object.assign(this, { tool, clicks: [], hover: null, shafts: null });
    for (const button of this.buttons) button.setAttribute("aria-pressed", button.dataset.tool === tool);
    this.setActive();
    if (this.isActive) this.editor.player?.play(false);
    // Known linkages take a moment at first.
    if (tool === "path") this.editor.known([[0, 0], [3, 1], [5, 4], [2, 6], [0, 0]]).catch(() => {});
    this.say();
    this.draw();
  }

  // Lets the layer take the pointer, and for a tool with keys the focus.
  setActive() {
    const { layer, tool, own } = this, hasKeys = this.isActive && tool in own;
    for (const each of Object.values(own)) each.update();
    if (!layer) return;
    layer.classList.toggle("active", Boolean(this.isActive));
    const attributes = { tabindex: 0, role: "application", "aria-label": TOOLS[tool][0], "aria-describedby": "tool-about" };
    for (const [name, value] of Object.entries(attributes)) if (hasKeys) layer.setAttribute(name, value); else layer.removeAttribute(name);
  }

  get isActive() { return this.shafts || (!this.root.hidden && this.tool !== "move"); }

  // Gives up the clicks so far, or else the tool; returns whether there was one.
  cancel() {
    if (!this.isActive) return false;
    if (this.shafts) { this.choose("move"); return true; }
    if (this.own[this.tool]?.cancel()) return true;
    if (this.clicks.length) { this.clicks = []; this.draw(); } else this.choose("move");
    return true;
  }

  say() { this.about.textContent = ` ${TOOLS[this.tool][1]}`; }

  show() { this.draw(); }

  // Forces and springs as lines at this frame: { load, label, from, to }, px; load: the key.
  get loads() {
    const { handles: { list }, player: { frame } } = this.editor, on = (at) => this.drawing.screen(...at.map((row) => (Array.isArray(row) ? row[frame] : row)));
    const forces = list.filter(({ id, arrow }) => arrow && /^point:loads\.forces/.test(id)).map(({ id, label, at, arrow }) => {
      const to = on(at), { s } = this.drawing;
      return { load: id.slice(6, id.indexOf("]") + 1), label, to, from: [to[0] - s * arrow[0], to[1] + s * arrow[1]] };
    });
    return [...forces, ...(this.springs ?? []).map(({ key, label, at, to }) => ({ load: key, label, from: on(at), to: on(to) }))];
  }

  drawSprings() {
    let d = "";
    for (const { load, from: [x, y], to: [u, v] } of this.loads) {
      const length = hypot(u - x, v - y);
      if (!load.includes("spring") || !length) continue;
      const [a, b] = [(u - x) / length, (v - y) / length], at = (share, side) => `${px(x + share * (u - x) - side * b)} ${px(y + share * (v - y) + side * a)}`;
      d += `M${at(0, 0)}L${at(0.1, 0)}`;
      for (let k = 0; k < 2 * COILS; k++) d += `L${at(0.1 + 0.8 * (k + 0.5) / (2 * COILS), k % 2 ? WIDE : -WIDE)}`;
      d += `L${at(0.9, 0)}L${at(1, 0)}`;
    }
    this.coils.setAttribute("d", d);
  }

  // --- what is under the pointer -------------------------------------------------------------------------------------

  // Positions on the stage, px, of all points that are known at this frame.
  get places() {
    const { handles: { list }, player: { frame } } = this.editor, places = new Map(), { drawing } = this;
    const add = (name, x, y) => { if (isFinite(x + y) && !places.has(name)) places.set(name, drawing.screen(x, y)); };
    // A handle that is shown elsewhere, as where a linkage is open, is where its point is drawn.
    for (const [id, { pointer }] of this.editor.handles.elements) if (pointer && id.startsWith("point:")) add(id.slice(6), ...pointer);
    for (const { sort, label, x, y } of drawing.marks) if (["pin", "fixed pin", "point", "slide"].includes(sort)) add(label, x[frame], y[frame]);
    for (const { id, at } of list) if (id.startsWith("point:")) add(id.slice(6), ...at.map((row) => (Array.isArray(row) ? row[frame] : row)));
    return places;
  }

  nearest(names, places, [x, y], most) {
    let best = null, least = most;
    for (const name of names) {
      const at = places.get(name), off = at ? hypot(at[0] - x, at[1] - y) : Infinity;
      if (off < least) [best, least] = [name, off];
    }
    return best;
  }

  // Distance of a place from the lines between the points of a body, px.
  distance(points, places, at) {
    const known = points.flatMap((name) => (places.has(name) ? [places.get(name)] : []));
    const segments = known.length < 2 ? known.map((end) => [end, end]) : known.flatMap((from, k) => known.slice(k + 1).map((to) => [from, to]));
    return min(Infinity, ...segments.map(([from, to]) => apart(from, to, at)));
  }

  // What a click at an event means: its place, mm, and the point, slide or body there.
  meant(event) {
    const at = this.drawing.onStage(event), wanted = TOOLS[this.tool][2 + this.clicks.length] ?? [], { bodies, ground, slides } = this.structure;
    const click = { at: this.drawing.plane(at) }, { places } = this;
    const point = wanted.includes("point") && this.nearest(new Set(Object.values(bodies).flat()), places, at, NEAR_POINT);
    if (point) return { ...click, point };
    const slide = wanted.includes("slide") && this.nearest(slides, places, at, NEAR_POINT);
    if (slide) return { ...click, slide };
    const load = wanted.includes("load") && this.loads.find(({ from, to }) => apart(from, to, at) < NEAR_BODY);
    if (load) return { ...click, load: load.load, name: load.label, line: [load.from, load.to] };
    if (!wanted.includes("body")) return click;
    const moving = Object.entries(bodies).filter(([name]) => name !== ground), plated = this.bodyOn(event, moving);
    if (plated) return { ...click, body: plated };
    let body = null, least = NEAR_BODY;
    for (const [name, points] of moving) {
      const off = this.distance(points, places, at);
      if (off < least) [body, least] = [name, off];
    }
    body ??= moving.find(([, points]) => isInside(at, points.flatMap((name) => (places.has(name) ? [places.get(name)] : []))))?.[0];
    return body ? { ...click, body } : click;
  }

  // The body whose plate is the uppermost under an event; null if none is drawn there.
  bodyOn({ clientX, clientY }, moving) {
    if (document.body.classList.contains("open")) return null;
    const key = ({ at, turn }) => [...at, turn].join(), { bodies } = this.drawing;
    // Plates of the same body move with the one that has its name.
    const names = new Map(moving.flatMap(([name]) => bodies.filter((body) => body.name === name).map((body) => [key(body), name])));
    const isUnder = ({ group }) => group.isThere && [...group.querySelectorAll(".plate")].some((plate) => plate.isPointInFill(new DOMPoint(clientX, clientY).matrixTransform(plate.getScreenCTM().inverse())));
    const found = bodies.filter((body) => names.has(key(body)) && isUnder(body)).reduce((best, body) => (!best || body.layer >= best.layer ? body : best), null);
    return found && names.get(key(found));
  }

  // --- clicks ----------------------------------------------------------------------------------------------------------

  press(event) {
    const isPath = this.tool === "path", own = this.own[this.tool];
    if (event.button || !(this.structure || isPath || own || this.shafts)) return;
    event.preventDefault();
    this.layer.setPointerCapture(event.pointerId);
    if (this.shafts) { this.shafts.held = this.shaftAt(event); this.draw(); return; }
    if (own) { own.press(this.drawing.onStage(event), 1.5 * NEAR_POINT); return; }
    if (isPath) { this.stroke = []; this.isDrawing = true; this.extend(event); return; }
    this.pressed = [event.clientX, event.clientY];
    this.take(this.meant(event));
  }

  move(event) {
    this.editor.player.play(false);
    if (this.isDrawing) { this.extend(event); return; }
    if (this.shafts) { this.turn(event); return; }
    if (this.own[this.tool]) { this.own[this.tool].move(this.drawing.onStage(event)); return; }
    if (!this.structure || this.tool === "path") return;
    this.hover = this.meant(event);
    this.draw();
  }

  // One stroke is two clicks.
  release(event) {
    const { pressed, stroke } = this;
    if (this.shafts) {
      const { held, phase, act } = this.shafts;
      if (held) { this.choose("move"); this.editor.announce(""); act(held.body, phase); }
      return;
    }
    if (this.own[this.tool]) { this.own[this.tool].release(); return; }
    if (this.isDrawing) {
      this.isDrawing = false;
      if (stroke.length < 3) { this.stroke = null; this.draw(); return; }
      this.choose("move");
      this.editor.drawPath(stroke);
      return;
    }
    this.pressed = null;
    if (pressed && this.clicks.length && hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > PRESSED) this.take(this.meant(event));
  }

  // The nearest shaft; of several on one axis the first.
  shaftAt(event) {
    const [x, y] = this.drawing.onStage(event), off = ({ at }) => { const [u, v] = this.drawing.screen(...at); return hypot(u - x, v - y); };
    return this.shafts.all.reduce((best, shaft) => (off(shaft) < (best ? off(best) - 1 : 2.5 * NEAR_POINT) ? shaft : best), null);
  }

  // The phase is the direction in which the pointer is from the shaft, in steps of 5 deg.
  turn(event) {
    const { shafts } = this, { held } = shafts;
    if (held) {
      const [x, y] = this.drawing.onStage(event), [u, v] = this.drawing.screen(...held.at), isFar = hypot(x - u, y - v) > 2 * NEAR_POINT;
      shafts.phase = isFar ? 5 * Math.round(Math.atan2(v - y, x - u) * 36 / Math.PI) : 0;
    } else shafts.hover = this.shaftAt(event);
    this.draw();
  }

  drawShafts() {
    const { all, held, hover, phase } = this.shafts, [cx0, cy0] = held ? this.drawing.screen(...held.at) : [];
    for (const shaft of all) {
      const [cx, cy] = this.drawing.screen(...shaft.at).map(px), isMeant = shaft === (held ?? hover);
      make(this.shown, "circle", { cx, cy, r: isMeant ? 20 : 14, class: isMeant ? "shaft meant-shaft" : "shaft" });
      if (isMeant) make(this.shown, "text", { x: cx, y: cy, dx: 24, dy: -16 }, `${shaft.body.replaceAll("_", " ")}${phase ? `, phase ${phase}°` : ""}`);
    }
    if (held && phase) make(this.shown, "path", { d: `M${px(cx0)} ${px(cy0)}l${px(70 * Math.cos(phase * Math.PI / 180))} ${px(-70 * Math.sin(phase * Math.PI / 180))}` });
  }

  // Adds the place of an event to the stroke, mm.
  extend(event) {
    const events = event.getCoalescedEvents?.() ?? [];
    for (const each of events.length ? events : [event]) this.stroke.push(this.drawing.plane(this.drawing.onStage(each)));
    this.draw();
  }

  // Takes the first path of a dropped SVG drawing, of which one unit is 1 mm, or lays another picture under the stage.
  async drop(event) {
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    if (!file) return;
    if (!/svg|xml/.test(file.type)) {
      if (document.getElementById("build").hidden) this.editor.announce("A picture is traced on an empty linkage: New");
      else await this.own.photo.take(file);
      return;
    }
    const svg = new DOMParser().parseFromString(await file.text(), "image/svg+xml"), path = svg.querySelector("path, polygon, polyline, ellipse, circle, rect");
    const shape = path && make(make(this.layer, "g", { visibility: "hidden" }), path.localName);
    for (const { name, value } of path?.attributes ?? []) if (/^(d|points|c[xy]|r[xy]?|x|y|width|height)$/.test(name)) shape.setAttribute(name, value);
    const length = shape?.getTotalLength() ?? 0;
    if (!length) { this.editor.announce("This file has no path"); shape?.parentNode.remove(); return; }
    const points = Array.from({ length: SAMPLES }, (_, k) => shape.getPointAtLength(length * k / (SAMPLES - 1))).map(({ x, y }) => [x, -y]);
    shape.parentNode.remove();
    this.editor.drawPath(points);
  }

  leave() { this.hover = null; this.draw(); }

  take(click) {
    const wanted = TOOLS[this.tool].slice(2), only = wanted[this.clicks.length];
    // A click that must mean something, and does not, is none.
    if (only.length && !ANY.every((name) => only.includes(name)) && !["pivot", "dyad", "slide", "lever"].includes(this.tool) && !only.some((name) => click[name])) {
      this.editor.announce(`There is no ${only.join(" or ")} here`);
      return;
    }
    this.clicks.push(click);
    this.draw();
    if (this.clicks.length < wanted.length) return;
    const { tool, clicks: on } = this;
    this.clicks = [];
    this.pressed = null;
    if (tool === "rename") this.rename(click.point ?? click.slide ?? click.body);
    else if (tool === "motor") this.chooseMotor(click.body);
    else if (click.load) { this.editor.set({ [click.load]: null }, click.load); this.editor.close(); }
    else this.editor.build({ do: tool, on });
  }

  // Takes a key on the handle of a point, and returns whether it means something: Enter is a click on the point, Delete removes it.
  takeKey({ id }, key) {
    const point = id.slice(6), isClick = key === "Enter" && this.isActive && TOOLS[this.tool].length > 2;
    if (this.root.hidden || !Object.values(this.structure?.bodies ?? {}).flat().includes(point)) return false;
    if (isClick) this.take({ at: this.drawing.plane(this.places.get(point)), point });
    else if (key === "Delete") this.editor.build({ do: "delete", on: [{ at: [0, 0], point }] });
    return isClick || key === "Delete";
  }

  // Lets a body be driven, and asks for its motor, of the list of the form, by the pictures of their faces.
  // isDriven: whether it was asked for.
  chooseMotor(body, isDriven = false) {
    const { editor, motors, structure } = this, list = motors.querySelector(".faces");
    if (body !== structure?.driver && !isDriven) {
      const { bodies, ground } = structure;
      if (!bodies[body].some((point) => bodies[ground].includes(point))) { editor.announce(NO_PIVOT); return; }
      editor.build({ do: "driver", on: [{ at: [0, 0], body }] });
      editor.whenIdle(() => this.chooseMotor(body, true));
      return;
    }
    const [{ problem, remedy } = {}] = editor.problems, isRefused = isDriven && problem;
    if (isRefused || body !== structure?.driver) {
      const reason = editor.reply.limit?.reason ?? [problem, remedy].filter(Boolean).join("; ");
      if (isRefused) editor.travel("undo");
      editor.whenIdle(() => editor.announce(`No motor on ${body}: ${reason}`));
      return;
    }
    const field = editor.form.fields.get(MOTOR);
    if (!field) { editor.announce(NO_PIVOT); return; }
    const take = (name) => { motors.close(); editor.set({ [MOTOR]: name }, MOTOR); editor.close(); };
    list.replaceChildren();
    for (const name of [null, ...field.choices]) {
      const button = make(list, "button", { type: "button", "aria-pressed": (editor.values[MOTOR] ?? null) === name });
      if (name) drawFace(button, field.faces[name]);
      make(button, "span", {}, name ?? "no motor");
      button.addEventListener("click", () => take(name));
    }
    motors.showModal();
  }

  rename(old) {
    const { dialog } = this, input = dialog.querySelector("input");
    input.value = old;
    input.oninput = () => input.setCustomValidity(NAME.test(input.value) ? "" : NAME_RULE);
    input.oninput();
    dialog.returnValue = "";
    dialog.addEventListener("close", () => {
      if (dialog.returnValue === "name" && input.value !== old) this.editor.build({ do: "rename", old, new: input.value });
    }, { once: true });
    dialog.showModal();
    input.select();
  }

  // --- drawing ---------------------------------------------------------------------------------------------------------

  // Draws what is under the pointer, and the lines from the clicks so far to it.
  draw() {
    if (!this.shown) return;
    this.drawSprings();
    this.shown.replaceChildren();
    if (this.stroke?.length > 1) make(this.shown, "path", { d: `M${this.stroke.map((at) => this.drawing.screen(...at).map(px)).join("L")}`, class: "stroke" });
    if (this.shafts) { this.drawShafts(); return; }
    if (!this.root.hidden) this.own.pose.draw();
    if (this.tool === "photo" && this.isActive) this.own.photo.draw();
    if (!this.isActive || !this.structure || this.tool in this.own) return;
    const { clicks, hover, drawing, places } = this, all = hover ? [...clicks, hover] : clicks;
    const spot = ({ at, point, slide }) => places.get(point ?? slide) ?? drawing.screen(...at);
    const line = all.map(spot).map((at) => at.map(px));
    if (this.tool === "dyad" && line.length === 3) make(this.shown, "path", { d: `M${line[0]}L${line[2]}L${line[1]}` });
    else if (line.length > 1) make(this.shown, "path", { d: `M${line.join("L")}${this.tool === "plate" && line.length > 2 ? "z" : ""}` });
    for (const click of all) {
      const [cx, cy] = spot(click).map(px);
      make(this.shown, "circle", { cx, cy, r: click.point || click.slide ? 9 : 4 });
    }
    if (!hover) return;
    const name = hover.name ?? hover.point ?? hover.slide ?? hover.body, [x, y] = spot(hover).map(px);
    if (name) make(this.shown, "text", { x, y, dx: 12, dy: -12 }, name.replaceAll("_", " "));
    if (hover.line) make(this.shown, "path", { d: `M${hover.line.map((at) => at.map(px)).join("L")}`, class: "meant" });
    if (!hover.body) return;
    const corners = this.structure.bodies[hover.body].flatMap((point) => (places.has(point) ? [places.get(point).map(px)] : []));
    if (corners.length > 1) make(this.shown, "path", { d: `M${corners.join("L")}z`, class: "meant" });
  }
}
