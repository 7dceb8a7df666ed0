// Pictures to save: the drawing and a plot as SVG files, and the drawing as PNG, at the current frame.
import { hypot, make, px } from "./shapes.js";

// Properties that the style sheet sets and a file of its own must state.
const KEPT = ["fill", "fill-opacity", "fill-rule", "stroke", "stroke-opacity", "stroke-width", "stroke-dasharray", "stroke-linejoin",
  "opacity", "paint-order", "text-anchor", "font-size", "font-style", "font-weight", "font-family"];
const USUAL = { "fill-opacity": "1", "stroke-opacity": "1", opacity: "1", "fill-rule": "nonzero", "stroke-dasharray": "none", stroke: "none",
  "stroke-linejoin": "miter", "paint-order": "normal", "text-anchor": "start", "font-style": "normal", "font-weight": "400" };
// Pixels of the PNG for each pixel of the drawing, enough for print.
const SHARP = 3;

export function offer(content, name, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Calls `work` while the page has its light colours, which paper needs.
export function inPrint(work) {
  const { classList } = document.documentElement, before = classList.contains("print");
  classList.add("print");
  try { return work(); } finally { classList.toggle("print", before); }
}

// The drawing as the text of an SVG file. Strokes have their own width at the drawing's scale, for programs that know no
// non-scaling strokes.
export function drawingFile({ svg, wide, tall }) {
  const copy = inPrint(() => copied(svg));
  Object.entries({ width: px(wide), height: px(tall), viewBox: `0 0 ${px(wide)} ${px(tall)}` })
    .forEach(([name, value]) => copy.setAttribute(name, value));
  for (const name of ["class", "tabindex", "role", "aria-roledescription", "aria-label"]) copy.removeAttribute(name);
  return fileOf(copy);
}

function copied(element) {
  const style = getComputedStyle(element), isShape = element instanceof SVGGeometryElement || element instanceof SVGTextElement;
  const isHidden = style.display === "none" || (isShape && style.visibility === "hidden");
  if (isHidden || element.matches("title:empty, .ghost, .touch, .photo")) return null;
  const copy = element.cloneNode(false);
  for (const name of ["class", "visibility", "data-role", "data-body"]) copy.removeAttribute(name);
  if (isShape) {
    const { a, b } = element.getCTM() ?? { a: 1, b: 0 }, still = style.vectorEffect === "non-scaling-stroke" ? hypot(a, b) || 1 : 1;
    for (const name of KEPT) {
      if (element.tagName !== "text" && /^(font|text)-/.test(name)) continue;
      let value = style.getPropertyValue(name);
      if (name === "stroke-width" || name === "stroke-dasharray") value = value.replace(/[\d.]+(px)?/g, (length) => +(parseFloat(length) / still).toPrecision(4));
      if (value !== USUAL[name] && !(style.stroke === "none" && name.startsWith("stroke"))) copy.setAttribute(name, value);
    }
  }
  for (const child of element.childNodes) {
    const inner = child.nodeType === Node.TEXT_NODE ? child.cloneNode() : child.nodeType === Node.ELEMENT_NODE ? copied(child) : null;
    if (inner) copy.append(inner);
  }
  return copy.tagName === "g" && !copy.childNodes.length ? null : copy;
}

// White behind the drawing. It is added to the text, since the page's policy allows no style attribute.
function fileOf(svg) {
  const text = new XMLSerializer().serializeToString(svg);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${text.replace("<svg ", '<svg style="background:#fff" ')}\n`;
}

// The drawing as an image, white behind it; sharp: pixels of it for each of the drawing.
export async function drawingImage(drawing, sharp = SHARP, type = "image/png") {
  const image = new Image(), canvas = document.createElement("canvas");
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(drawingFile(drawing))}`;
  await image.decode();
  [canvas.width, canvas.height] = [sharp * drawing.wide, sharp * drawing.tall].map(Math.round);
  const paper = canvas.getContext("2d");
  paper.fillStyle = "#fff";
  paper.fillRect(0, 0, canvas.width, canvas.height);
  paper.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve) => { canvas.toBlob(resolve, type); });
}

// A plot as the text of an SVG file: axes with units, curves, limits, and the frame shown.
// about: width, height and bounds [left, top, width, height] of the plot, px; ticks, labels: of x and y; x(value),
// y(value): px; curves: [{ name, points, stroke, dash, isSpot }]; limits: [[value, label]]; now: x of the frame shown.
export function plotFile({ width, height, bounds: [left, top, across, up], ticks, labels, x, y, curves, limits, now, colours }) {
  const foot = 20 * curves.length, svg = make(null, "svg", { width, height: height + foot, viewBox: `0 0 ${width} ${height + foot}`,
    "font-family": "DejaVu Sans, Verdana, sans-serif", "font-size": 12, fill: colours.ink });
  const line = (d, attributes) => make(svg, "path", { d, fill: "none", ...attributes });
  for (const [value, text] of ticks.x) {
    line(`M${px(x(value))} ${px(top)}v${px(up)}`, { stroke: colours.grid });
    make(svg, "text", { x: px(x(value)), y: px(top + up + 15), "text-anchor": "middle" }, text);
  }
  for (const [value, text] of ticks.y) {
    line(`M${px(left)} ${px(y(value))}h${px(across)}`, { stroke: colours.grid });
    make(svg, "text", { x: px(left - 6), y: px(y(value) + 4), "text-anchor": "end" }, text);
  }
  make(svg, "text", { x: px(left + across / 2), y: px(top + up + 32), "text-anchor": "middle" }, labels.x);
  make(svg, "text", { transform: `translate(14 ${px(top + up / 2)}) rotate(-90)`, "text-anchor": "middle" }, labels.y);
  for (const [value, label] of limits) {
    line(`M${px(left)} ${px(y(value))}h${px(across)}`, { stroke: colours.limit, "stroke-width": 1.5, "stroke-dasharray": "8 4" });
    make(svg, "text", { x: px(left + across - 6), y: px(y(value) - 5), "text-anchor": "end", fill: colours.limit }, label);
  }
  line(`M${px(x(now))} ${px(top)}v${px(up)}`, { stroke: colours.ink, "stroke-width": 1.5, "stroke-opacity": 0.7 });
  curves.forEach(({ name, points, stroke, dash, isSpot }, k) => {
    let d = "", joined = false;
    for (const [u, v] of points) {
      const known = isFinite(u + v);
      if (known && isSpot) d += `M${px(x(u) - 3)} ${px(y(v))}a3 3 0 1 0 6 0a3 3 0 1 0-6 0z`;
      else if (known) d += `${joined ? "L" : "M"}${px(x(u))} ${px(y(v))}`;
      joined = known;
    }
    const look = { stroke, "stroke-width": 1.75, "stroke-linejoin": "round", ...(dash.length ? { "stroke-dasharray": dash.join(" ") } : {}) };
    line(d, look);
    const at = height + 20 * k + 8;
    line(`M${px(left)} ${at}h26`, look);
    make(svg, "text", { x: px(left + 34), y: at + 4 }, name);
  });
  return fileOf(svg);
}
