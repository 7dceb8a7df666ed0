// The plots of a sweep: values over the key that was varied, a line for each choice of the others.
import { Plots } from "./plots.js";

export function mountSweep(root, data) {
  for (const column of data.columns) column.row = column.row.map((value) => value ?? NaN);
  const plots = new Plots(root, { ...data, spots: true }, (frame) => plots.show(frame, true));
  root.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step || event.target.getAttribute("role") !== "slider") return;
    event.preventDefault();
    plots.show(Math.min(Math.max(plots.frame + step, 0), data.frames - 1), true);
  });
  root.dataset.ready = "";
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.rebuild());
}
