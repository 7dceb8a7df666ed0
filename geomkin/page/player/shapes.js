// Building blocks of drawings: elements, rows of numbers, and shapes.

export const { abs, floor, hypot, max, min, round } = Math;
const SVG = "http://www.w3.org/2000/svg";
// A pivot on the ground, where no plate shows the ground: a stand with hatches below.
export const STAND = "M-2.6 3.8L-8 13H8L2.6 3.8M-12 13H12M-10 13l-4 5M-4 13l-4 5M2 13l-4 5M8 13l-4 5";

// An element of SVG or HTML with attributes and, if given, a text, as the last child of `parent`.
export function make(parent, name, attributes = {}, text = "") {
  const inSvg = name === "svg" || (parent && parent.namespaceURI === SVG);
  const element = inSvg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text) element.textContent = text;
  if (parent) parent.append(element);
  return element;
}

// A row of numbers as scene_json.py stores it; nan if there is none.
export function unpack(row, frames) {
  // Single precision as base64.
  if (typeof row === "string") return new Float32Array(Uint8Array.from(atob(row), (sign) => sign.charCodeAt(0)).buffer);
  // The same number throughout.
  if (!Array.isArray(row)) return new Float64Array(frames).fill(row ?? NaN);
  // Decimals, then second differences.
  const [decimals, ...differences] = row;
  let value = 0, step = 0;
  return Float64Array.from(differences, (change) => (change === null ? NaN : (value += step += change) / 10 ** decimals));
}

// 1, 2 or 5 times a power of ten, at most `most`.
export function niceLength(most) {
  const power = 10 ** floor(Math.log10(most));
  return [5, 2, 1].find((step) => step * power <= most) * power;
}

// The first outline of a path's text as points [x, y], at most some 64 of them, and its circles [x, y, radius].
export function pointsOf(d) {
  const numbers = (text) => (text.match(/-?\d*\.?\d+/g) ?? []).map(Number);
  const circles = [...d.matchAll(/M([^a-z]+)a([\d.]+) [^a-z]+ 0a/g)].map(([, at, r]) => [numbers(at)[0] + +r, numbers(at)[1], +r]);
  const points = [];
  let x = 0, y = 0;
  for (const [, sign, text] of d.split("z")[0].matchAll(/([Mla])([^Mla]*)/g)) {
    const steps = numbers(text);
    if (sign === "a") {
      // Points of an arc between its ends; `off`: distance of the centre (a, b) from the middle of the chord, over its length.
      const [r, , , , side, u, v] = steps, half = hypot(u, v) / 2, off = (side ? 1 : -1) * Math.sqrt(max(0, r * r - half * half)) / 2 / half;
      const [a, b] = [x + u / 2 - off * v, y + v / 2 + off * u], turn = (side ? 2 : -2) * Math.asin(min(1, half / r));
      for (const share of [0.25, 0.5, 0.75]) {
        const [c, s] = [Math.cos(share * turn), Math.sin(share * turn)];
        points.push([a + (x - a) * c - (y - b) * s, b + (x - a) * s + (y - b) * c]);
      }
      steps.splice(0, 5);
    }
    for (let k = 0; k + 1 < steps.length; k += 2) points.push([x += steps[k], y += steps[k + 1]]);
  }
  const stride = Math.ceil(points.length / 64);
  return { points: points.filter((_, k) => k % stride === 0), circles };
}

// Middle and half the longest axis of points, along which a name is placed.
export function axisOf(points) {
  const n = points.length;
  const [x, y] = points.reduce(([a, b], [c, d]) => [a + c / n, b + d / n], [0, 0]);
  let [xx, xy, yy] = [0, 0, 0];
  for (const [a, b] of points) { xx += (a - x) ** 2; xy += (a - x) * (b - y); yy += (b - y) ** 2; }
  const turn = Math.atan2(2 * xy, xx - yy) / 2, [c, s] = [Math.cos(turn), Math.sin(turn)];
  const along = points.map(([a, b]) => abs((a - x) * c + (b - y) * s)), half = max(...along);
  return { x, y, u: half * c, v: half * s };
}

// Shows or hides an element; an attribute is set only on a change.
export function see(element, there) {
  if (element.isThere === there) return;
  element.isThere = there;
  element.setAttribute("visibility", there ? "inherit" : "hidden");
}

export const px = (value) => value.toFixed(2);
export const spaced = (name) => name.replaceAll("_", " ");

// A line from the origin to (u, v), px, with an open head at its end, at both or at none.
export function arrow(u, v, heads) {
  const long = hypot(u, v), size = min(8, long), [c, s] = long ? [u / long, v / long] : [0, 0];
  const head = (x, y, back) => {
    const at = (off) => `${px(x - back * c - off * s)} ${px(y - back * s + off * c)}`;
    return `M${at(0.4 * size)}L${px(x)} ${px(y)}L${at(-0.4 * size)}`;
  };
  return `M0 0L${px(u)} ${px(v)}${heads > 0 ? head(u, v, size) : ""}${heads > 1 ? head(0, 0, -size) : ""}`;
}
