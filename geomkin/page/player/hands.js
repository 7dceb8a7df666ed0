// What hands do on a drawing: drag a body, which turns the driver; move what is seen; look closer by wheel or two fingers.
import { hypot, max } from "./shapes.js";

// How much closer a wheel's step takes one: more, and what was looked at is lost.
const WHEEL = 0.0015;

// player: play(on), goTo(frame), frame, data; said(drawing): called where it is looked at more or less closely.
export function handle(drawing, player, said) {
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
      player.goTo(drawing.nearestFrame(held, worldOf(drawing, now), player.frame, player.data.cyclic));
    } else if (other) {
      const [from, to] = [before, now].map(([x, y]) => hypot(x - other[0], y - other[1]));
      drawing.zoom(to / max(from, 1), other);
      said(drawing);
    } else drawing.pan(now[0] - before[0], now[1] - before[1]);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    svg.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      held = null;
      svg.classList.remove("held");
    });
  }
  // Only where the drawing was taken up before, so that whoever scrolls past it is not held up.
  svg.addEventListener("wheel", (event) => {
    const closer = Math.exp(-WHEEL * event.deltaY * (event.deltaMode ? 20 : 1));
    if ((!event.ctrlKey && document.activeElement !== svg) || (closer < 1 && drawing.by === 1)) return;
    event.preventDefault();
    drawing.zoom(closer, drawing.onStage(event));
    said(drawing);
  }, { passive: false });
}

const worldOf = (drawing, [x, y]) => [(x - drawing.tx) / drawing.s, (drawing.ty - y) / drawing.s];

// The body that is under the pointer, and where on it that is, (u, v); a pin moves along, as a body that does not turn.
function taken(drawing, event, k) {
  const group = event.target.closest?.(".body.moving, .mark");
  const mark = drawing.marks.find((other) => other.group === group && other.sort !== "fixed pin");
  const body = drawing.bodies.find((other) => other.group === group)
    ?? (mark && { x: mark.x, y: mark.y, cos: mark.x.map(() => 1), sin: mark.x.map(() => 0) });
  if (!body) return null;
  const [x, y] = worldOf(drawing, drawing.onStage(event)), [dx, dy] = [x - body.x[k], y - body.y[k]];
  return { body, u: dx * body.cos[k] + dy * body.sin[k], v: dy * body.cos[k] - dx * body.sin[k] };
}
