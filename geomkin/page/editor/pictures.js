// Small moving pictures of linkages, such as the candidates of a synthesis; a click on one chooses it.
import { make } from "../player/shapes.js";

// Milliseconds between two frames, and free room around a picture, as a share of its size.
const PACE = 50, ROOM = 0.06;
const shown = new Map();
let frame = 0;

setInterval(() => {
  if (document.hidden || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  frame += 1;
  for (const moving of shown.values()) for (const [path, steps] of moving) path.setAttribute("d", steps[frame % steps.length]);
}, PACE);

// Fills a section with pictures: each of strokes `lines`, [xs, ys], or rows of them over the frames of what moves; with `name`
// below and a longer `label`; a click calls `act`.
export function showPictures(section, pictures) {
  const [root] = section.getElementsByClassName("pictures"), focus = root.contains(document.activeElement), moving = [];
  root.replaceChildren();
  shown.set(root, moving);
  for (const { label, name, lines, isChosen = false, act } of pictures) {
    const known = (k) => lines.flatMap((line) => line[k].flat()).filter((value) => value !== null), [xs, ys] = [known(0), known(1)];
    const [left, low] = [Math.min(...xs), Math.min(...ys)], size = Math.max(Math.max(...xs) - left, Math.max(...ys) - low) || 1;
    const button = make(root, "button", { type: "button", title: label, "aria-label": label, "aria-pressed": isChosen });
    const svg = make(button, "svg", { viewBox: [-ROOM, -ROOM, 1 + 2 * ROOM, 1 + 2 * ROOM].join(" "), "aria-hidden": true });
    // Not where it cannot be assembled.
    const stroke = (x, y) => (x.includes(null) ? "" : `M${x.map((u, k) => `${(u - left) / size} ${1 - (y[k] - low) / size}`).join("L")}`);
    for (const [x, y] of lines) {
      const isMoving = Array.isArray(x[0]), steps = isMoving ? x.map((row, k) => stroke(row, y[k])) : [stroke(x, y)];
      const path = make(svg, "path", { d: steps[frame % steps.length], class: isMoving ? "link" : "" });
      if (isMoving) moving.push([path, steps]);
    }
    make(button, "span", {}, name);
    button.addEventListener("click", act);
    if (focus && isChosen) button.focus();
  }
}
