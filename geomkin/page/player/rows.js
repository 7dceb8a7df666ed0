// Plots of rows that do not move: a sweep's, over the key that was varied, or the candidates of a synthesis.
import { Plots } from "./plots.js";

export function mountRows(root, data) {
  for (const column of data.columns) {
    column.row = column.row.map((value) => value ?? NaN);
    // A single value is drawn as a point.
    column.spot = data.spots || column.row.filter((value) => isFinite(value)).length === 1;
  }
  const plots = new Plots(root, data, (frame) => plots.show(frame, true));
  plots.show(data.chosen ?? 0, true);
  root.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step || event.target.getAttribute("role") !== "slider") return;
    event.preventDefault();
    // Elsewhere these keys turn the mechanism.
    event.stopPropagation();
    plots.show(Math.min(Math.max(plots.frame + step, 0), data.frames - 1), true);
  });
  root.dataset.ready = "";
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.rebuild());
  return plots;
}
