// Handles: marks on the drawing and on plots. Dragging a handle, or pressing an arrow key on it, edits keys of the recipe.
import { arrow, make, niceLength, px, see } from "../player/shapes.js";

// Radius of the area that responds to the pointer, px; a fingertip needs a larger one.
const GRAB = matchMedia("(pointer: coarse)").matches ? 22 : 14;
// Movement by one press of an arrow key, px. The length is then rounded to a round number; Shift makes it ten times as large.
const NUDGE = 5;
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

export class Handles {
  // editor has the methods startDrag(handle), drag(handle, { to, frame, step, snap }), endDrag(handle), nudge(handle, drag).
  constructor(player, editor) {
    Object.assign(this, { player, editor, elements: new Map(), list: [], held: null, doubled: new Set() });
    const [drawing] = player.drawings;
    drawing.overlays.push(this);
    this.onDrawing = {
      root: make(drawing.svg.parentNode, "svg", { class: "handles" }),
      screen: (x, y) => drawing.screen(x, y),
      plane: (event) => drawing.plane(drawing.onStage(event)),
      get pixel() { return 1 / drawing.s; },
      get width() { return drawing.wide; },
    };
    player.plots.drawn = () => this.show(player.frame);
  }

  // Shows these handles in place of the previous ones. An element whose id remains keeps its focus and its pointer.
  load(handles) {
    this.list = handles;
    const labels = new Set(handles.filter(({ id }) => /^point:(?!wanted)/.test(id)).map(({ label }) => label));
    // Names of the drawing that handles have as well: one of the two is shown.
    this.doubled = new Set();
    for (const { shape } of this.player.drawings[0].named.all) {
      if (!labels.has(shape.textContent)) continue;
      shape.classList.add("doubled");
      this.doubled.add(shape.textContent);
    }
    for (const element of this.elements.values()) if (element !== this.held || !this.editor.isSearch) element.pointer = null;
    const ids = new Set(handles.map(({ id }) => id));
    for (const [id, element] of this.elements) {
      if (ids.has(id)) continue;
      element.root.remove();
      this.elements.delete(id);
    }
    this.box = boxOf(handles);
    this.show(this.player.frame);
  }

  // Shows handles at other positions until the next answer; places: by id, null for the usual one.
  place(places) {
    for (const [id, element] of this.elements) element.pointer = places.get(id) ?? null;
    this.show(this.player.frame);
  }

  // Gives up the drag.
  cancel() {
    const { root } = this.held;
    this.held = null;
    root.classList.remove("held");
    this.editor.cancelDrag();
  }

  show(frame) {
    const { named } = this.player.drawings[0], isBuilding = document.body.classList.contains("building"), taken = [];
    for (const handle of this.list) {
      const surface = handle.shape === "plot" ? this.plotSurface(handle.plot) : this.onDrawing;
      const element = this.elements.get(handle.id) ?? (surface && this.add(handle, surface));
      if (!surface) { element?.root.remove(); continue; }
      Object.assign(element, { handle, surface });
      if (element.root.parentNode !== surface.root) surface.root.append(element.root);
      this.describe(element);
      const [x, y] = surface.screen(...element.pointer ?? placeOf(handle, frame)), isKnown = isFinite(x + y);
      see(element.root, isKnown);
      if (!isKnown) continue;
      element.root.setAttribute("transform", `translate(${px(x)} ${px(y)})`);
      element.root.classList.toggle("named", this.doubled.has(handle.label) && !this.player.drawings[0].hidden.has("names"));
      // Its label is not cut at the top or the right.
      const isFar = x > 0.7 * surface.width, side = isFar ? -12 : 12, down = y < 24 ? 22 : -10;
      Object.entries({ x: side, y: down, "text-anchor": isFar ? "end" : "start" }).forEach(([name, at]) => element.tip.setAttribute(name, at));
      if (isBuilding && /^point:(?!.*wanted\.)/.test(handle.id)) {
        // All these labels are shown, but none on an earlier one; names of bodies make way.
        const half = (element.half ||= element.tip.getBBox().width / 2), label = [x + side + Math.sign(side) * half, y + down - 4, half];
        const isOver = taken.some((other) => named.overlap(label, other));
        element.root.classList.toggle("crowded", isOver);
        if (!isOver) taken.push(label);
      }
      const r = handle.shape === "circle" ? handle.radius / surface.pixel : 0;
      for (const rim of element.rims) rim.setAttribute("r", px(r));
      this.drawArrow(element);
      this.drawLeash(element, frame, [x, y]);
    }
    for (const name of named.shown ?? []) if (taken.some((label) => named.overlap(label, name))) see(name[3], false);
  }

  // Draws the line from a handle to what it moves, or removes it.
  drawLeash(element, frame, [x, y]) {
    const { root, handle, surface } = element, [u, v] = handle.anchor && !element.pointer ? surface.screen(...placeOf({ at: handle.anchor }, frame)) : [NaN, NaN];
    if (!isFinite(u + v)) { element.leash?.remove(); element.leash = null; return; }
    if (!element.leash) { element.leash = make(root, "path", { class: "leash" }); root.prepend(element.leash); }
    element.leash.setAttribute("d", `M0 0L${px(u - x)} ${px(v - y)}`);
  }

  // Draws the arrow that ends at a handle, or removes it.
  drawArrow(element) {
    const { root, handle, surface } = element;
    if (!handle.arrow) { element.shaft?.remove(); element.shaft = null; return; }
    const [u, v] = [handle.arrow[0] / surface.pixel, -handle.arrow[1] / surface.pixel];
    element.shaft ??= make(root, "path", { class: "shaft" });
    element.shaft.setAttribute("d", arrow(u, v, 1));
    element.shaft.setAttribute("transform", `translate(${px(-u)} ${px(-v)})`);
  }

  // The surface for handles on the plot that shows a column; undefined if no plot shows it.
  plotSurface(id) {
    const card = this.player.plots.cards.find(({ columns, plot }) => plot && columns.some((column) => column.id === id));
    if (!card) return undefined;
    const { plot } = card, { over } = plot, wrap = over.parentNode;
    // Above the plot, not in it: that is a slider, which may contain no buttons.
    const root = wrap.querySelector(".handles") ?? make(wrap, "svg", { class: "handles" });
    const { offsetLeft: left, offsetTop: top, offsetWidth: width, offsetHeight: height } = over;
    Object.assign(root.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
    return {
      root,
      width,
      screen: (x, y) => [plot.valToPos(x, "x"), plot.valToPos(y, "y")],
      plane: (event) => {
        const { left, top } = over.getBoundingClientRect();
        return [plot.posToVal(event.clientX - left, "x"), plot.posToVal(event.clientY - top, "y")];
      },
      get pixel() { return ["x", "y"].map((axis, k) => Math.abs(plot.posToVal(1, axis) - plot.posToVal(0, axis)) || k); },
    };
  }

  add(handle, surface) {
    const root = make(surface.root, "g", { class: `handle ${handle.shape}`, tabindex: 0, role: "button", "aria-roledescription": "handle" });
    const element = { root, rims: [] };
    if (handle.shape === "circle") {
      element.rims = ["grab", "rim"].map((look) => make(root, "circle", { class: look }));
      element.rims[0].setAttribute("stroke-width", 1.2 * GRAB);
    } else {
      make(root, "circle", { class: "grab", r: GRAB });
      make(root, "path", { class: "knob", d: "M-7 0 0-7 7 0 0 7z" });
    }
    make(root, "title");
    element.tip = make(root, "text", { class: "tip" });
    this.stopAt(root);
    root.addEventListener("keydown", (event) => this.key(element, event));
    this.followPointer(element);
    this.elements.set(handle.id, element);
    return element;
  }

  // A moving mechanism stops while the pointer is on a handle, so that it can be taken.
  stopAt(root) {
    let isStopped = false;
    root.addEventListener("pointerenter", () => {
      if (!this.player.playing) return;
      isStopped = true;
      this.player.play(false);
    });
    root.addEventListener("pointerleave", () => {
      if (isStopped && !this.editor.tools.isActive) this.player.play(true);
      isStopped = false;
    });
  }

  describe(element) {
    const { root, handle } = element, { id, keys, label, locked } = handle, text = `${label}: ${keys.join(", ")}${locked ? " (locked)" : ""}`;
    if (root.dataset.handle === id && root.getAttribute("aria-label") === text) return;
    Object.assign(root.dataset, { handle: id, keys: keys.join("|") });
    root.setAttribute("aria-label", text);
    root.setAttribute("aria-disabled", locked);
    root.querySelector(".tip").textContent = label;
    element.half = 0;
    root.querySelector("title").textContent = `${text}. Drag it, or use the arrow keys; Shift snaps.`;
  }

  followPointer(element) {
    const { root } = element;
    // Otherwise Chromium pans the page under the finger, even with `touch-action: none`, and the drag ends.
    root.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
    root.addEventListener("pointerdown", (event) => this.grab(this.nearest(element, event), event));
    root.addEventListener("pointermove", (event) => {
      if (this.held !== element) return;
      const to = element.surface.plane(event).map((at, k) => at + this.offset[k]);
      // A search answers late: until then its handle is at the pointer.
      if (this.editor.isSearch && element.handle.shape !== "circle") { element.pointer = to; this.show(this.player.frame); this.editor.tools.draw(); }
      this.editor.drag(element.handle, this.change(element, to, event.shiftKey));
    });
    for (const end of ["pointerup", "pointercancel"]) {
      root.addEventListener(end, () => {
        if (this.held !== element) return;
        this.held = null;
        root.classList.remove("held");
        this.editor.endDrag(element.handle);
      });
    }
  }

  // The circle whose rim is nearest to the pointer, since areas of circles may overlap; for other handles the element itself.
  nearest(element, event) {
    if (element.handle.shape !== "circle") return element;
    const at = element.surface.plane(event);
    const distance = ({ handle }) => Math.abs(Math.hypot(...placeOf(handle, this.player.frame).map((x, k) => x - at[k])) - handle.radius);
    const circles = [...this.elements.values()].filter(({ handle }) => handle.shape === "circle");
    return circles.reduce((best, other) => (distance(other) < distance(best) ? other : best), element);
  }

  grab(element, event) {
    const { root, handle, surface } = element;
    event.stopPropagation();
    event.preventDefault();
    root.focus({ preventScroll: true });
    if (handle.locked || this.held || event.button) return;
    this.held = element;
    root.setPointerCapture(event.pointerId);
    root.classList.add("held");
    // The rim of a circle goes to the pointer itself; another handle keeps its distance from the pointer.
    const at = surface.plane(event), place = placeOf(handle, this.player.frame);
    this.offset = handle.shape === "circle" ? [0, 0] : [place[0] - at[0], place[1] - at[1]];
    this.editor.startDrag(handle);
  }

  key(element, event) {
    const { handle, surface } = element, direction = KEYS[event.key], [, pose] = handle.id.match(/^point:wanted\.poses\[(\d+)/) ?? [];
    if (event.key === "Delete" && pose && !handle.locked) { this.editor.tools.own.pose.remove(+pose); return; }
    if (this.editor.tools.takeKey(handle, event.key)) { event.preventDefault(); return; }
    if (!direction || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (handle.locked) return;
    // Before the answer to the previous press arrives, the next press starts from the position that was requested.
    const place = this.editor.pending(handle) ?? placeOf(handle, this.player.frame).map((at, k) => at + (k || handle.shape !== "circle" ? 0 : handle.radius));
    const steps = [surface.pixel].flat().map((pixel) => niceLength(NUDGE * pixel) * (event.shiftKey ? 10 : 1));
    const to = place.map((at, k) => at + direction[k] * (steps[k] ?? steps[0]));
    this.editor.nudge(handle, { ...this.change(element, to, false), step: steps.length > 1 ? steps : steps[0] });
  }

  change({ surface }, to, snap) { return { to, frame: this.player.frame, step: surface.pixel, snap }; }
}

const placeOf = ({ at }, frame) => at.map((row) => (Array.isArray(row) ? row[frame] : row));

// Left, lower, right and upper end, mm, of points that are dragged on the drawing, over all frames; null if there are none.
function boxOf(handles) {
  const points = handles.filter(({ shape }) => shape === "point");
  const [x, y] = [0, 1].map((axis) => points.flatMap(({ at }) => at[axis]).filter((value) => value !== null));
  return x.length ? [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)] : null;
}
