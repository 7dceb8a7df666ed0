// The form of a recipe: one input for every value, named by the dotted key of the value.
import { make, niceLength, spaced } from "../player/shapes.js";
import { measured, unitOf } from "../player/plots.js";

const LOCK = "M4 8V5.5a3 3 0 0 1 6 0V8M2.5 8h9v6h-9z", OPEN = "M4 8V5.5a3 3 0 0 1 5.6-1.5M2.5 8h9v6h-9z";
const RESET = "M3 5a5 5 0 1 1-.6 4.500M3 1.500V5h3.500";
// The value of the choice with which a table of values replaces a name.
const OWN = "own";
// Characters of the longest number that is shown with all of them.
const LONG = 9;
let ids = 0;

export class Form {
  // editor has `locks`, a set of keys, `typing`, and the methods set(changes, name), isAwaited(name), close(), reset(key, field),
  // relock().
  constructor(root, editor) {
    Object.assign(this, { root, editor, groups: [], values: {}, saved: {}, fields: new Map(), problems: [] });
    root.addEventListener("input", (event) => this.input(event.target));
    root.addEventListener("change", ({ target }) => {
      const value = valueOf(target);
      // What was typed is shown as the number that it states.
      if (isNumeric(target) && typeof value === "number") target.value = written(target, value);
      this.editor.close();
    });
    root.addEventListener("keydown", (event) => this.step(event));
  }

  // Takes the groups of fields of a kind, as the server's `form` returns them.
  describe(groups) {
    this.groups = groups;
    this.shape = "";
  }

  // Shows values by key. `saved` holds the saved recipe's values for comparison; `text` is the recipe's text;
  // `unavailable` has the keys of tables that the mechanism cannot have.
  show(values, saved, text, unavailable) {
    Object.assign(this, { values, saved, text, unavailable });
    const entries = Object.entries(values).map(([key, value]) => [key, key.endsWith("motor") ? value : shapeOf(value)]);
    // What the text states can be removed.
    const shape = JSON.stringify([entries, unavailable, text.match(/^\s*\[+[^\]]*/gm)]);
    if (shape !== this.shape) this.build(shape);
    else for (const field of this.fields.values()) this.refresh(field);
  }

  build(shape) {
    const focus = this.root.contains(document.activeElement) && document.activeElement.name, { scrollTop } = this.root;
    const closed = new Map([...this.root.querySelectorAll("details")].map((part) => [part.dataset.key, part.open]));
    this.shape = shape;
    this.fields.clear();
    this.root.replaceChildren();
    for (const group of this.groups) for (const [path, index] of this.tables(group)) this.addGroup(group, path, index, closed);
    if (focus) this.root.querySelector(`[name="${CSS.escape(focus)}"]`)?.focus();
    this.root.scrollTop = scrollTop;
    this.showProblems(this.problems);
  }

  below(path) { return Object.keys(this.values).filter((key) => key.startsWith(`${path}.`)); }

  // Path and index of each table of a group. For a list of tables the last entry is for the button that adds one.
  tables(group) {
    const { key, rows } = group;
    if (!rows) return [[key, null]];
    const list = key.slice(0, -2);
    let count = 0;
    while (this.below(`${list}[${count}]`).length) count++;
    return [...Array.from({ length: count }, (_, k) => [`${list}[${k}]`, k]), [list, count]];
  }

  addGroup(group, path, index, closed) {
    const isNew = group.rows && path === group.key.slice(0, -2);
    const exists = path === "" || this.below(path).length > 0;
    if (group.within && this.values[`${path.replace(/\[\d+\]$/, "").split(".").slice(0, -1).join(".")}.kind`] !== group.within) return;
    if (isNew || !exists || group.named) {
      // A table that a name may replace is added by its field, and one inside a table after that.
      if (group.by_name || this.unavailable.includes(path) || (around(path) && !this.below(around(path)).length)) return;
      // The button for a table inside another one is at its end.
      const place = (around(path) && [...this.root.children].find(({ dataset }) => dataset.key === around(path))) || this.root;
      const add = make(place, "button", { type: "button", class: "add", "data-add": path }, `Add ${group.title}`);
      add.addEventListener("click", () => this.editor.add(path));
      return;
    }
    if (group.named) return;
    const part = make(this.root, "details", { "data-key": path });
    part.open = closed.get(path) ?? !/^$|^files|\.recipe\./.test(path);
    const head = make(part, "summary", {}, group.rows ? `${group.title} ${index + 1}` : group.title);
    if (group.rows || (group.optional && new RegExp(`^\\s*\\[+\\s*${CSS.escape(path)}\\s*[\\].]`, "m").test(this.text))) {
      const remove = make(part, "button", { type: "button", class: "remove", "aria-label": `Remove ${head.textContent}` }, "Remove");
      remove.addEventListener("click", () => { this.editor.set({ [path]: null }, path); this.editor.close(); });
    }
    if (group.help) make(part, "p", { class: "about" }, group.help);
    const kind = this.values[`${path}.kind`];
    let fields = group.kinds ? group.kinds[kind] ?? Object.values(group.kinds)[0] : group.fields;
    if (group.kinds && kind !== undefined) {
      // Kinds that this mechanism refuses are not offered.
      const choices = Object.keys(group.kinds).filter((other) => other === kind || !this.unavailable.includes(`${path}=${other}`));
      this.addField(part, { key: `${path}.kind`, type: "choice", choices, help: "", unit: "", table: path });
      fields = fields.filter(({ key }) => key !== `${group.key}.kind`);
    }
    for (const field of fields) this.addField(part, { ...field, key: path ? path + field.key.slice(group.key.length) : field.key });
    make(part, "p", { class: "problem", "data-of": path, role: "alert" });
  }

  addField(part, field) {
    const { key, help } = field, entry = { ...field, inputs: [], id: `f${ids++}` };
    const keys = field.type === "table" ? this.below(key) : [];
    if (keys.length) {
      const box = make(part, "fieldset", {});
      make(box, "legend", {}, spaced(key.slice(part.dataset.key.length + (part.dataset.key ? 1 : 0))));
      for (const inner of keys) {
        this.addField(box, { key: inner, label: inner.slice(key.length + 1), type: typeOf(this.values[inner]), unit: "", help, optional: true });
      }
      return;
    }
    const isAbsent = this.unavailable.includes(key) && this.values[key] === null;
    if (field.type === "table" || (field.type === "named" && (isAbsent || this.below(key).length))) return;
    entry.row = make(part, "div", { class: "field" });
    const name = field.label ?? key.split(".").at(-1);
    make(entry.row, "label", { for: entry.id }, name.replaceAll("_", " ").replace(/ (deg|rpm|rad per s2?)$/, ""));
    entry.slots = make(entry.row, "div", { class: "slots" });
    this.addInputs(entry);
    make(entry.row, "span", { class: "unit" }, unitOf(field.unit ?? ""));
    entry.lock = this.icon(entry.row, "lock", OPEN, () => this.toggleLock(entry));
    entry.lock.hidden = !["number", "integer", "point"].includes(field.type) && !entry.inputs.some(isNumeric);
    entry.undo = this.icon(entry.row, "reset", RESET, () => this.editor.reset(key, field));
    if (entry.faces?.[this.values[key]]) drawFace(entry.row, entry.faces[this.values[key]]);
    make(entry.row, "p", { class: "help", id: `${entry.id}h` }, help);
    entry.problem = make(entry.row, "p", { class: "problem", id: `${entry.id}p`, "data-of": key, role: "alert" });
    this.fields.set(key, entry);
    this.refresh(entry);
  }

  // Adds one input for a plain value, or one for each item of a list. Each list inside a list has its own line.
  addInputs(entry) {
    const value = this.values[entry.key], { key, type, slots, id } = entry;
    const add = (parent, name, held, label) => {
      const input = this.makeInput(parent, entry, held);
      Object.entries({ name, "aria-describedby": `${id}h ${id}p` }).forEach(([attribute, text]) => input.setAttribute(attribute, text));
      if (label) input.setAttribute("aria-label", label); else input.id = id;
      entry.inputs.push(input);
    };
    const isName = typeof value === "string", list = Array.isArray(value) ? value : type === "point" && !isName ? [0, 0] : null;
    if (!list) { add(slots, key, value); return; }
    list.forEach((item, k) => {
      const line = Array.isArray(item) ? make(slots, "div", { class: "line" }) : slots;
      [item].flat().forEach((held, n) => add(line, `${key}[${k}]${line === slots ? "" : `[${n}]`}`, held, `${key}, item ${k + 1}${line === slots ? "" : `, number ${n + 1}`}`));
      if (line !== slots && type === "list") this.listButton(line, `Remove item ${k + 1}`, "×", entry, list.filter((_, other) => other !== k));
    });
    if (type !== "list" || !list.length) return;
    if (!Array.isArray(list[0]) && list.length > 1) this.listButton(slots, "Remove the last item", "−", entry, list.slice(0, -1));
    this.listButton(slots, "Add an item", "+", entry, [...list, list.at(-1)]);
  }

  listButton(parent, label, sign, { key }, value) {
    const button = make(parent, "button", { type: "button", class: "small-button", "aria-label": `${label} of ${key}`, title: label }, sign);
    button.addEventListener("click", () => { this.editor.set({ [key]: value }, key); this.editor.close(); });
  }

  makeInput(parent, { type, choices, least, most, optional, unit }, held) {
    if (["choice", "named"].includes(type) || (choices?.length && typeof held !== "number" && type !== "list")) {
      const select = make(parent, "select");
      if (held === null || held === undefined || optional) make(select, "option", { value: "null" }, "–");
      for (const choice of choices) make(select, "option", { value: JSON.stringify(choice) }, String(choice));
      if (type === "named") make(select, "option", { value: OWN }, "own values");
      return select;
    }
    if (type === "boolean") return make(parent, "input", { type: "checkbox" });
    // A point given as the name of another point is a text.
    const numeric = typeof held !== "string" && (["number", "integer", "point"].includes(type) || typeof held === "number");
    const limits = { ...(typeof least === "number" ? { "data-least": least } : {}), ...(typeof most === "number" ? { "data-most": most } : {}) };
    return make(parent, "input", { type: "text", spellcheck: "false", ...(numeric ? { class: "numeric", inputmode: "decimal", "data-unit": unit ?? "", ...limits } : {}) });
  }

  icon(parent, look, d, act) {
    const button = make(parent, "button", { type: "button", class: `icon ${look}` });
    make(make(button, "svg", { viewBox: "0 0 14 15", width: 14, height: 15, "aria-hidden": "true" }), "path", { d });
    button.addEventListener("click", act);
    return button;
  }

  // Updates the inputs of a field, except for one in which the user is typing, or whose value is not answered yet.
  refresh(entry) {
    const { key, inputs, type } = entry, value = this.values[key], flat = Array.isArray(value) ? value.flat() : [value];
    inputs.forEach((input, k) => {
      const held = flat[k] ?? null;
      if (isNumeric(input)) input.dataset.step = type === "integer" ? 1 : stepOf(held);
      if ((input === document.activeElement && this.editor.typing === input.name) || this.editor.isAwaited(input.name)) return;
      if (input.type === "checkbox") input.checked = held === true;
      else if (input.tagName === "SELECT") input.value = JSON.stringify(held);
      else if (!isNumeric(input) || held === null || valueOf(input) !== held || !input.value) {
        input.value = held === null ? "" : typeof held === "object" ? JSON.stringify(held) : written(input, held);
      }
    });
    const locked = this.editor.locks.has(key), changed = JSON.stringify(value) !== JSON.stringify(this.saved[key]);
    entry.row.classList.toggle("changed", changed);
    entry.undo.hidden = !changed;
    const was = this.saved[key];
    entry.undo.title = `Reset ${key}${typeof was === "number" ? ` to ${measured(was, entry.unit ?? "")}` : ""}`;
    entry.undo.setAttribute("aria-label", entry.undo.title);
    entry.lock.setAttribute("aria-pressed", locked);
    entry.lock.title = locked ? `Unlock ${key}` : `Lock ${key}: no drag changes it`;
    entry.lock.setAttribute("aria-label", `Lock ${key}`);
    entry.lock.querySelector("path").setAttribute("d", locked ? LOCK : OPEN);
  }

  toggleLock(entry) {
    const { locks } = this.editor;
    if (!locks.delete(entry.key)) locks.add(entry.key);
    this.refresh(entry);
    this.editor.relock();
  }

  // The arrow keys change a number by a step.
  step(event) {
    const { target: input, key } = event, sign = { ArrowUp: 1, ArrowDown: -1 }[key], value = sign && input.name && isNumeric(input) ? valueOf(input) : null;
    if (typeof value !== "number") return;
    event.preventDefault();
    const { step, least = -Infinity, most = Infinity } = input.dataset, next = value + sign * step;
    input.value = +Math.min(Math.max(next, least), most).toPrecision(12);
    this.input(input);
  }

  input(input) {
    if (!input.name) return;
    const entry = [...this.fields.values()].find(({ inputs }) => inputs.includes(input));
    if (!entry) return;
    // A table of another kind has other values, which the server chooses.
    if (entry.table !== undefined) { this.editor.add(`${entry.table}=${JSON.parse(input.value)}`); return; }
    if (input.value === OWN) { this.editor.add(entry.key); return; }
    const value = valueOf(input);
    if (value === undefined) { this.showProblems([{ key: entry.key, ...noNumber(input.dataset.unit) }]); return; }
    if (value === null && !entry.optional) { this.showProblems([{ key: entry.key, problem: "a value is needed", remedy: entry.help }]); return; }
    const point = entry.type === "point" && isNumeric(input) && !Array.isArray(this.values[entry.key]);
    const changes = point ? { [entry.key]: entry.inputs.map((other) => valueOf(other) ?? 0) } : { [input.name]: value };
    this.editor.set(changes, input.name);
  }

  // Shows each problem at the field of its key, and returns the problems that are not seen there.
  showProblems(problems) {
    this.problems = problems;
    for (const place of this.root.querySelectorAll(".problem")) place.textContent = "";
    for (const { inputs, row } of this.fields.values()) {
      row.classList.remove("wrong");
      for (const input of inputs) input.removeAttribute("aria-invalid");
    }
    return problems.filter(({ key, problem, remedy }) => {
      const at = [...this.root.querySelectorAll(".problem")].filter(({ dataset: { of } }) => of && (key === of || key.startsWith(`${of}.`) || key.startsWith(`${of}[`)))
        .reduce((best, place) => (!best || place.dataset.of.length > best.dataset.of.length ? place : best), null);
      if (!at) return true;
      at.textContent = [problem, remedy].filter(Boolean).join("; ");
      const part = at.closest("details");
      if (part) part.open = true;
      const entry = this.fields.get(at.dataset.of);
      entry?.row.classList.add("wrong");
      if (entry) entry.undo.hidden = false;
      for (const input of entry?.inputs ?? []) if (key === entry.key || input.name === key) input.setAttribute("aria-invalid", "true");
      return !isSeen(at, this.root.parentNode);
    });
  }
}

// The face of a motor: shaft, boss and screws, each [x, y, radius].
export function drawFace(parent, circles) {
  const size = Math.max(...circles.map(([x, y, r]) => Math.hypot(x, y) + r)) + 1;
  const svg = make(parent, "svg", { class: "face", viewBox: `${-size} ${-size} ${2 * size} ${2 * size}`, "aria-hidden": true });
  for (const [cx, y, r] of circles) make(svg, "circle", { cx, cy: -y, r });
}

// The value of an input: null if it is empty, undefined if it should be a number and is not.
function valueOf(input) {
  if (input.type === "checkbox") return input.checked;
  if (input.tagName === "SELECT") return JSON.parse(input.value);
  if (!isNumeric(input)) return input.value;
  if (input.value === input.dataset.short) return Number(input.dataset.exact);
  return input.value.trim() === "" ? null : amount(input.value, input.dataset.unit);
}

const isNumeric = (input) => input.classList.contains("numeric");

// Units that may be typed after a number: those of lengths, in mm, and those of angles, in deg.
const UNITS = [{ mm: 1, cm: 10, m: 1000, in: 25.4, "\"": 25.4, ft: 304.8 }, { deg: 1, "°": 1, rad: 180 / Math.PI }];
const unitsOf = (unit) => UNITS.find((units) => Object.hasOwn(units, unit)) ?? {};

// The number that a text such as `2*15`, `1/4 in` or `(3 + 5)/2` states, in the unit of its field; undefined if none.
export function amount(text, unit = "") {
  const tokens = text.replaceAll(",", ".").replaceAll("−", "-").match(/(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|[a-z°"]+|\S/gi) ?? [];
  const take = (wanted) => (wanted.includes(tokens[0]) ? tokens.shift() : ""), units = unitsOf(unit);
  // Values with the power of their unit, which is 0 or 1 in the end.
  const part = () => {
    if (take("-")) { const [value, power] = part(); return [-value, power]; }
    if (take("+")) return part();
    if (take("(")) { const inner = sum(); return take(")") ? inner : [NaN, 0]; }
    return [Number(tokens.shift() ?? NaN), 0];
  };
  const product = () => {
    let [value, power] = part();
    for (let sign; (sign = take(["*", "/"]) || (Object.hasOwn(units, tokens[0]) && "unit"));) {
      const [other, more] = sign === "unit" ? [units[tokens.shift()] / units[unit], 1] : part();
      [value, power] = sign === "/" ? [value / other, power - more] : [value * other, power + more];
    }
    return [power === 0 || power === 1 ? value : NaN, power];
  };
  const sum = () => {
    let [value, power] = product();
    for (let sign; (sign = take(["+", "-"]));) {
      const [other, more] = product();
      [value, power] = [value + (sign === "+" ? other : -other), Math.max(power, more)];
    }
    return [value, power];
  };
  const [value] = sum();
  return tokens.length || !isFinite(value) ? undefined : +value.toPrecision(12);
}

// Why a text states no number for a field.
function noNumber(unit) {
  const example = { mm: ", 2*15 or 1/4 in", deg: ", 2*15 or 0.5 rad" }[Object.keys(unitsOf(unit))[0]] ?? " or 2*15";
  return { problem: `this is no number${unit && ` in ${unit}`}`, remedy: `type one, such as 12.5${example}` };
}

// A number as it is shown: a long one is rounded, and its exact value stays with the input until another one is typed.
function written(input, held) {
  const short = typeof held === "number" && String(held).length > LONG ? String(+held.toPrecision(LONG - 2)) : held;
  Object.assign(input.dataset, { short, exact: held });
  return short;
}

const stepOf = (value) => (value ? niceLength(Math.abs(value) / 20) : 1);
const isPair = (value) => value.length === 2 && value.every((item) => typeof item === "number");
const typeOf = (value) => (Array.isArray(value) ? (isPair(value) ? "point" : "list") : { number: "number", boolean: "boolean" }[typeof value] ?? "text");
// Whether an element is in view, inside a part of the page that is scrolled.
function isSeen(element, scrolled) {
  const [{ top, bottom }, around] = [element, scrolled].map((box) => box.getBoundingClientRect());
  return element.checkVisibility() && bottom > Math.max(0, around.top) && top < Math.min(innerHeight, around.bottom);
}

// The key of the table around one.
const around = (path) => path.slice(0, Math.max(0, path.lastIndexOf(".")));
const shapeOf = (value) => (Array.isArray(value) ? value.map(shapeOf) : value === null ? null : 0);
