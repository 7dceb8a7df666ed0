// Plots of rows that do not move: a sweep's, over the key that was varied, or the candidates of a synthesis.
import { Plots } from "./plots.js";

function withSpots(data) {
  for (const column of data.columns) {
    column.row = column.row.map((value) => value ?? NaN);
    // A single value is drawn as a point.
    column.spot = data.spots || column.row.filter((value) => isFinite(value)).length === 1;
  }
  return data;
}

// choose(row, data), if there is one, is called for a row that is clicked, or at which Enter is pressed.
export function mountRows(root, data, choose) {
  const plots = new Plots(root, withSpots(data), (frame) => plots.show(frame, true));
  plots.show(data.chosen ?? 0, true);
  const isPlot = ({ target }) => target.getAttribute("role") === "slider";
  if (choose) root.addEventListener("pointerup", (event) => { if (isPlot(event)) choose(plots.frame, plots.data); });
  root.addEventListener("keydown", (event) => {
    if (choose && event.key === "Enter" && isPlot(event)) choose(plots.frame, plots.data);
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step || !isPlot(event)) return;
    event.preventDefault();
    // Elsewhere these keys turn the mechanism.
    event.stopPropagation();
    plots.show(Math.min(Math.max(plots.frame + step, 0), plots.data.frames - 1), true);
  });
  root.dataset.ready = "";
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.rebuild());
  return plots;
}

// Shows other rows in plots that are mounted.
export function showRows(plots, data) {
  plots.load(withSpots(data));
  plots.show(data.chosen ?? 0, true);
}
