// Plots of the table's columns over the drive, one to four at a time. uPlot is used here and nowhere else.
/* global uPlot */
import { inPrint, offer, plotFile } from "./pictures.js";
import { abs, make, max, min, round, spaced, unpack } from "./shapes.js";

export const MOST_PLOTS = 4;
// Height of a docked plot, px.
const DOCKED = 150;
// Pixels between two ticks of an axis of values, at least, on a tall plot. The next nice step is at most twice as long, so a
// quarter of the height leaves room for two ticks.
const MOST_SPACE = 30;
// Dashes of the curves of one plot: colour alone never distinguishes them.
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [13, 4], [4, 2, 1, 2]];
const STROKES = ["wanted", "traced", "velocity", "acceleration", "s4", "s5"];
const DEGREES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720];

// A table's rows of numbers, and the headers that a file has.
export function read(data) {
  data.rows = data.series.map((row) => unpack(row, data.frames));
  for (const column of data.columns) {
    column.row = data.rows[column.row];
    const unit = column.unit.replaceAll("/", "_per_").replaceAll(" ", "_");
    column.header = unit ? `${column.name}_${unit}` : column.name;
    column.id = column.name;
    column.name = spaced(column.name);
  }
  return data;
}

// A number with the few digits that a reader compares, and with a typographic minus sign.
export function shown(value) {
  if (!isFinite(value)) return "–";
  const size = abs(value);
  const text = size !== 0 && (size >= 1e7 || size < 1e-4) ? value.toExponential(3) : String(+value.toPrecision(5));
  return text.replace("-", "−");
}

export const unitOf = (unit) => unit.replace(/\bdeg\b/, "°").replace(/([a-z])2/, "$1²");

export const measured = (value, unit) =>
  isFinite(value) ? `${shown(value)}${unit && unit !== "deg" ? " " : ""}${unitOf(unit)}` : "–";

export class Plots {
  // root: their parent element; data.spots: whether values are drawn as points; seek(frame): called when a reader points
  // at another position of the drive. A later `drawn(card)` is called whenever a plot was drawn.
  constructor(root, data, seek) {
    Object.assign(this, { data, seek, frame: 0, cards: [] });
    this.grid = make(root, "div", { class: "plots" });
    this.more = make(root, "button", { type: "button", class: "more" }, "Another plot");
    this.more.addEventListener("click", () => this.add());
    this.resized = new ResizeObserver(() => this.cards.forEach((card) => this.resize(card)));
    this.read(data);
    this.fill();
    this.count();
  }

  // Adds plots up to the number that a page has at first.
  fill() {
    const first = document.documentElement.clientWidth > 900 ? 2 : 1;
    while (this.cards.length < min(first, this.data.plots.length)) this.add();
  }

  read(data) {
    this.data = data;
    // Curves run from left to right; a driver that turns clockwise comes from the right.
    const { row } = data.columns[0];
    this.falls = row[row.length - 1] < row[0];
  }

  // The first plot that no card shows.
  get free() { return this.data.plots.findIndex((_, k) => !this.cards.some(({ chosen }) => chosen === k)); }

  // Plots other data. A card keeps its plot, or shows the first free one if that has no counterpart.
  load(data) {
    const titles = this.data.plots.map(({ title }) => title), wereAllShown = this.cards.length === titles.length;
    const looks = this.cards.map(({ chosen }) => lookOf(this.data, this.data.plots[chosen].columns));
    this.read(data);
    const same = titles.length === data.plots.length && data.plots.every(({ title }, k) => title === titles[k]);
    for (const card of this.cards.splice(data.plots.length)) this.discard(card);
    for (const card of this.cards) card.chosen = data.plots.findIndex(({ title }) => title === titles[card.chosen]);
    for (const card of this.cards) if (card.chosen < 0) card.chosen = this.free;
    this.cards.forEach((card, k) => {
      if (!same) this.offerPlots(card);
      const { columns } = data.plots[card.chosen];
      if (lookOf(data, columns) !== looks[k]) { this.build(card); return; }
      card.columns = columns.map((column) => data.columns[column]);
      card.plot.over.setAttribute("aria-valuemax", data.frames - 1);
      card.plot.setData(this.curves(card));
    });
    if (wereAllShown || !this.cards.length) this.fill();
    this.count();
  }

  add() {
    const card = { chosen: this.free, root: make(this.grid, "section", { class: "plot", "aria-label": `Plot ${this.cards.length + 1}` }) };
    const head = make(card.root, "div", { class: "head" });
    card.select = make(head, "select", { "aria-label": "What is plotted" });
    this.offerPlots(card);
    card.select.addEventListener("change", () => { card.chosen = +card.select.value; this.build(card); });
    const picture = make(head, "button", { type: "button", "aria-label": "This plot as SVG", title: "This plot as SVG" }, "SVG");
    picture.addEventListener("click", () => offer(this.picture(card), `${this.data.name ?? "plot"}-${this.titleOf(card)}.svg`, "image/svg+xml"));
    const close = make(head, "button", { type: "button", "aria-label": "Remove this plot", class: "close" }, "×");
    close.addEventListener("click", () => this.remove(card));
    card.chart = make(card.root, "div", { class: "chart" });
    card.legend = make(card.root, "ul", { class: "legend" });
    this.cards.push(card);
    this.build(card);
    this.resized.observe(card.chart);
    this.count();
  }

  offerPlots(card) {
    card.select.replaceChildren();
    this.data.plots.forEach((plot, k) => make(card.select, "option", { value: k }, plot.title));
    card.select.value = card.chosen;
  }

  discard(card) {
    card.plot.destroy();
    this.resized.unobserve(card.chart);
    card.root.remove();
  }

  remove(card) {
    this.discard(card);
    this.cards = this.cards.filter((other) => other !== card);
    this.count();
  }

  count() {
    this.more.hidden = this.cards.length >= min(MOST_PLOTS, this.data.plots.length);
    for (const { root } of this.cards) root.querySelector(".close").hidden = this.cards.length < 2;
  }

  rising(values) { return this.falls ? values.reverse() : values; }

  frameOf(index) { return this.falls ? this.data.frames - 1 - index : index; }

  // Colours are those of the style, which change with the screen's.
  rebuild() { this.cards.forEach((card) => this.build(card)); }

  build(card) {
    card.plot?.destroy();
    const style = getComputedStyle(card.root), colour = (name) => style.getPropertyValue(name).trim();
    const { data } = this, drive = data.columns[0];
    const columns = data.plots[card.chosen].columns.map((k) => data.columns[k]);
    const font = `12px ${style.fontFamily}`, grid = { stroke: colour("--grid"), width: 1 }, stroke = colour("--soft");
    const strokes = columns.map((_, k) => colour(`--${STROKES[k % 6]}`));
    const axis = { stroke, grid, ticks: grid, font, labelFont: font, labelSize: 18 };
    const label = [drive.name, unitOf(drive.unit)].filter(Boolean).join(", ");
    const unit = columns[0].unit === "deg" ? "degrees" : unitOf(columns[0].unit) || (data.spots ? "" : "ratio");
    // The ticks of both axes, for pictures.
    const write = (axis) => (_, ticks) => { card.ticks[axis] = ticks.map((value) => [value, shown(value)]); return ticks.map(shown); };
    Object.assign(card, { columns, ticks: {}, labels: { x: label, y: unit } });
    card.plot = new uPlot({
      ...this.sizeOf(card),
      padding: [10, 18, 0, 0],
      // Curves of whole pixels would have steps.
      pxAlign: 0,
      legend: { show: false },
      cursor: { y: false, drag: { x: false, y: false }, points: { size: 7 } },
      scales: { x: { time: false }, y: { range: (_, low, high) => this.range(card, low, high) } },
      axes: [
        { ...axis, label, size: 34, ...(drive.unit === "deg" ? { incrs: DEGREES } : {}), values: write("x") },
        { ...axis, label: unit, size: 58, values: write("y"), space: (_, axis, low, high, size) => min(MOST_SPACE, size / 4) },
      ],
      series: [{}, ...columns.map((column, k) => ({ label: column.name, stroke: strokes[k], width: 1.75, dash: DASHES[k % 6], points: { show: true, size: 6, filter: ({ data }, k) => (column.spot ? null : alone(data[k], this.data.cyclic)) } }))],
      hooks: { draw: [(plot) => { drawLimits(plot, this.limitsOf(card), colour("--wanted"), colour("--paper"), font); this.show(this.frame); this.drawn?.(card); }], setCursor: [(plot) => this.hover(card, plot)] },
    }, this.curves(card), card.chart);
    this.label(card, strokes);
    this.point(card);
    this.show(this.frame, true);
  }

  // The columns of a card as uPlot takes them.
  curves(card) {
    const known = ({ row }) => this.rising(Array.from(row, (y) => (this.isDrawn(card, y) ? y : null)));
    return [this.rising([...this.data.columns[0].row]), ...card.columns.map(known)];
  }

  // Whether a value is known, and not so large that it would flatten all others.
  isDrawn(card, y) { return isFinite(y) && abs(y) <= (this.data.plots[card.chosen].most ?? Infinity); }

  limitsOf(card) { return this.data.plots[card.chosen].limits ?? []; }

  range(card, low, high) {
    let [from, to] = [low ?? 0, high ?? 1];
    for (const [value] of this.limitsOf(card)) [from, to] = [min(from, value), max(to, value)];
    const room = 0.06 * (to - from) || abs(to) || 1;
    return [from - room, to + room];
  }

  label(card, strokes) {
    const { bars } = this.data.plots[card.chosen];
    card.legend.replaceChildren();
    card.legend.classList.toggle("bars", !!bars);
    card.most = max(...card.columns.flatMap(({ row }) => [...row].filter(isFinite)));
    card.values = card.columns.map((column, k) => {
      const item = make(card.legend, "li", { title: column.meaning });
      const key = make(item, "svg", { width: 26, height: 10, viewBox: "0 0 26 10", "aria-hidden": "true" });
      make(key, "path", { d: "M0 5H26", stroke: strokes[k], "stroke-width": 2, "stroke-dasharray": DASHES[k % 6].join(" ") || "none" });
      make(item, "span", {}, column.name);
      if (bars) make(item, "i", {}).style.setProperty("--most", `${100 * max(...[...column.row].filter(isFinite)) / card.most}%`);
      return make(item, "b", {});
    });
  }

  // The line at the current frame, and its control: hovering shows values, dragging and arrow keys move the mechanism.
  point(card) {
    const { over } = card.plot, drive = this.data.columns[0];
    card.now = make(over, "div", { class: "now" });
    Object.entries({
      tabindex: 0, role: "slider", "aria-label": `${this.data.plots[card.chosen].title} over ${drive.name}`,
      "aria-valuemin": 0, "aria-valuemax": this.data.frames - 1,
    }).forEach(([name, value]) => over.setAttribute(name, value));
    const take = (event) => this.seek(this.frameOf(card.plot.posToIdx(event.clientX - over.getBoundingClientRect().left)));
    over.addEventListener("pointerdown", (event) => { over.setPointerCapture(event.pointerId); take(event); });
    over.addEventListener("pointermove", (event) => { if (event.buttons) take(event); });
    over.addEventListener("pointerleave", () => { card.hovered = null; this.write(card); });
  }

  titleOf(card) { return this.data.plots[card.chosen].title.replace(/\W+/g, "-"); }

  // The plot as the text of an SVG file.
  picture(card) {
    const { plot, ticks, labels, columns } = card, dpr = devicePixelRatio || 1, drive = this.data.columns[0];
    const { left, top, width, height } = plot.bbox, bounds = [left, top, width, height].map((length) => length / dpr);
    const at = (axis, start) => (value) => start + plot.valToPos(value, axis);
    const style = getComputedStyle(document.documentElement);
    return inPrint(() => plotFile({
      width: plot.width, height: plot.height, bounds, ticks, labels, x: at("x", bounds[0]), y: at("y", bounds[1]), now: drive.row[this.frame],
      limits: this.limitsOf(card).map(([value, label]) => [value, unitOf(label).replace(" °", "°")]),
      curves: columns.map((column, k) => ({ name: column.name, points: [...column.row].map((value, row) => [drive.row[row], this.isDrawn(card, value) ? value : NaN]), isSpot: column.spot,
        stroke: style.getPropertyValue(`--${STROKES[k % 6]}`), dash: DASHES[k % 6] })),
      colours: { ink: style.getPropertyValue("--ink"), grid: style.getPropertyValue("--grid"), limit: style.getPropertyValue("--wanted") },
    }));
  }

  hover(card, plot) {
    card.hovered = plot.cursor.left >= 0 ? this.frameOf(plot.cursor.idx) : null;
    if (card.values) this.write(card);
  }

  sizeOf(card) {
    const width = max(200, card.chart.clientWidth);
    // Docked below a stage of a given height they are low.
    return { width, height: card.root.closest(".filled") ? DOCKED : round(min(260, max(180, 0.5 * width))) };
  }

  resize(card) {
    const size = this.sizeOf(card);
    if (size.width === card.plot.width && size.height === card.plot.height) return;
    card.plot.setSize(size);
    this.show(this.frame, true);
  }

  write(card) {
    const frame = card.hovered ?? this.frame;
    card.columns.forEach((column, k) => {
      const value = card.values[k], bar = value.parentNode.querySelector("i");
      value.textContent = measured(column.row[frame], column.unit);
      bar?.style.setProperty("--now", `${100 * (column.row[frame] || 0) / card.most}%`);
    });
  }

  // Moves the cursors to a frame, and writes its values if `values`.
  show(frame, values) {
    this.frame = frame;
    const at = this.data.columns[0];
    for (const card of this.cards) {
      if (!card.now) continue;
      card.now.style.transform = `translateX(${card.plot.valToPos(at.row[frame], "x").toFixed(1)}px)`;
      if (!values) continue;
      card.plot.over.setAttribute("aria-valuenow", frame);
      card.plot.over.setAttribute("aria-valuetext", `${shown(at.row[frame])} ${at.unit}: ${card.columns.map((c) => `${c.name} ${shown(c.row[frame])} ${c.unit}`).join(", ")}`);
      this.write(card);
    }
  }
}

// Indices of known values between unknown ones, which no curve shows. The last value of a turn is the first one again.
const alone = (row, cyclic) => [...row.keys()].filter((k) => {
  const last = row.length - 1, before = cyclic && k === 0 ? last - 1 : k - 1, after = cyclic && k === last ? 1 : k + 1;
  return row[k] !== null && (row[before] ?? null) === null && (row[after] ?? null) === null;
});

// A key of the axes and curves of a plot, which is built again if they change.
const lookOf = (data, columns) => JSON.stringify([0, ...columns].map((k) => [data.columns[k].name, data.columns[k].unit]));

// Dashed lines of limits with their labels.
function drawLimits(plot, limits, stroke, paper, font) {
  const { ctx, bbox } = plot, dpr = devicePixelRatio || 1;
  ctx.save();
  ctx.font = font.replace("12px", `${12 * dpr}px`);
  ctx.lineWidth = 1.5 * dpr;
  for (const [value, label] of limits) {
    const y = plot.valToPos(value, "y", true);
    ctx.strokeStyle = stroke;
    ctx.setLineDash([8 * dpr, 4 * dpr]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.strokeStyle = paper;
    ctx.fillStyle = stroke;
    ctx.lineWidth = 4 * dpr;
    ctx.textAlign = "right";
    const words = unitOf(label).replace(" °", "°");
    ctx.strokeText(words, bbox.left + bbox.width - 6 * dpr, y - 5 * dpr);
    ctx.fillText(words, bbox.left + bbox.width - 6 * dpr, y - 5 * dpr);
    ctx.lineWidth = 1.5 * dpr;
  }
  ctx.restore();
}
