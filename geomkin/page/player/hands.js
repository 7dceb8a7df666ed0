// Pointers on a drawing: dragging a body turns the driver; dragging a zoomed view moves it; a wheel or two fingers zoom.
import { hypot, max } from "./shapes.js";

// Zoom per unit of a wheel's movement. With a larger value the point of interest is easily lost.
const WHEEL = 0.0015;

// player: play(on), goTo(frame), frame, data; zoomed(drawing): called when its zoom changes.
export function followPointers(drawing, player, zoomed) {
  const { svg } = drawing, fingers = new Map();
  let held = null;
  svg.addEventListener("pointerdown", (event) => {
    fingers.set(event.pointerId, drawing.onStage(event));
    held = fingers.size === 1 ? taken(drawing, event, player.frame) : null;
    svg.setPointerCapture(event.pointerId);
    svg.focus({ preventScroll: true });
    if (!held) return;
    event.preventDefault();
    player.play(false);
    svg.classList.add("held");
  });
  svg.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId), now = drawing.onStage(event);
    if (!before) return;
    fingers.set(event.pointerId, now);
    const [, other] = [...fingers].find(([id]) => id !== event.pointerId) ?? [];
    if (held) {
      player.goTo(drawing.nearestFrame(held, drawing.plane(now), player.frame, player.data.cyclic));
    } else if (other) {
      const [from, to] = [before, now].map(([x, y]) => hypot(x - other[0], y - other[1]));
      drawing.zoom(to / max(from, 1), other);
      zoomed(drawing);
    } else drawing.pan(now[0] - before[0], now[1] - before[1]);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    svg.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      held = null;
      svg.classList.remove("held");
    });
  }
  // Only if the drawing has the focus, so that scrolling the page does not zoom the drawing.
  svg.addEventListener("wheel", (event) => {
    const closer = Math.exp(-WHEEL * event.deltaY * (event.deltaMode ? 20 : 1));
    if ((!event.ctrlKey && document.activeElement !== svg) || (closer < 1 && drawing.by === 1)) return;
    event.preventDefault();
    drawing.zoom(closer, drawing.onStage(event));
    zoomed(drawing);
  }, { passive: false });
}

// The body under the pointer, and the pointer's position on it, (u, v); a pin counts as a body that does not turn.
function taken(drawing, event, k) {
  const group = event.target.closest?.(".body.moving, .mark");
  const mark = drawing.marks.find((other) => other.group === group && other.sort !== "fixed pin");
  const body = drawing.bodies.find((other) => other.group === group)
    ?? (mark && { x: mark.x, y: mark.y, cos: mark.x.map(() => 1), sin: mark.x.map(() => 0) });
  if (!body) return null;
  const [x, y] = drawing.plane(drawing.onStage(event)), [dx, dy] = [x - body.x[k], y - body.y[k]];
  return { body, u: dx * body.cos[k] + dy * body.sin[k], v: dy * body.cos[k] - dx * body.sin[k] };
}
