// The recipe as text, beside its form: what is typed in one is shown in the other, and each problem is marked at its line.
import { make } from "../player/shapes.js";

// Milliseconds after the last key before a text is read, and the number of keys that are offered at once.
const PAUSE = 350, MOST = 10;

// Of each line of a TOML text the dotted key of its table, and, if it begins a table or a value, its own key.
export function keysOf(text) {
  const rows = new Map();
  let table = "";
  // The last row of each list of tables on the way.
  const resolved = (names) => names.reduce((path, name) => {
    const inner = path ? `${path}.${name}` : name;
    return rows.has(inner) ? `${inner}[${rows.get(inner)}]` : inner;
  }, "");
  return text.split("\n").map((line) => {
    const [, brackets, inside] = line.match(/^\s*(\[\[?)\s*([^\]#]+?)\s*\]/) ?? [], [, name] = line.match(/^\s*([\w.-]+)\s*=/) ?? [];
    if (!brackets) return { table, name, key: name && (table ? `${table}.${name}` : name) };
    const names = inside.split(".").map((part) => part.trim().replace(/^["']|["']$/g, ""));
    if (brackets === "[[") {
      const list = [resolved(names.slice(0, -1)), names.at(-1)].filter(Boolean).join(".");
      rows.set(list, (rows.get(list) ?? -1) + 1);
    }
    table = resolved(names);
    return { table, key: table };
  });
}

// The line of a key: that of the longest key which begins it; -1 if there is none.
export function lineOf(key, keys) {
  let best = -1;
  keys.forEach(({ key: other }, k) => {
    const isIt = other && (key === other || key.startsWith(`${other}.`) || key.startsWith(`${other}[`));
    if (isIt && other.length > (keys[best]?.key.length ?? 0)) best = k;
  });
  return best;
}

export class TextPane {
  // editor has `form`, with the groups of fields, and type(text), which takes another text.
  constructor(root, editor) {
    Object.assign(this, { root, editor, typed: null, problems: [] });
    const box = make(root, "div", { class: "code" });
    this.gutter = make(box, "pre", { "aria-hidden": true });
    this.area = make(box, "textarea", { "aria-label": "The recipe as text", wrap: "off", spellcheck: "false", autocomplete: "off", autocapitalize: "off" });
    this.offers = make(root, "div", { class: "offers" });
    this.about = make(root, "p", { class: "about" });
    this.list = make(make(root, "div", { role: "alert" }), "ul", { class: "problems" });
    this.area.addEventListener("input", () => this.input());
    this.area.addEventListener("blur", () => this.send());
    this.area.addEventListener("scroll", () => { this.gutter.style.transform = `translateY(${-this.area.scrollTop}px)`; });
    this.area.addEventListener("keydown", (event) => this.key(event));
    for (const event of ["keyup", "pointerup"]) this.area.addEventListener(event, () => this.offer());
  }

  // Shows a text, unless another one is being typed, and its problems.
  show(text, problems) {
    const { area } = this, { selectionStart: at, scrollTop } = area;
    if (this.root.hidden) return;
    Object.assign(this, { problems, ending: text.includes("\r\n") ? "\r\n" : "\n" });
    if (this.typed === null && this.written !== text) {
      area.value = text;
      if (document.activeElement === area) area.setSelectionRange(at, at);
      area.scrollTop = scrollTop;
    }
    this.mark();
  }

  get written() { return this.area.value.replaceAll("\n", this.ending ?? "\n"); }

  input() {
    this.typed = this.written;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.send(), PAUSE);
    this.mark();
  }

  // Sends what was typed since the last time.
  send() {
    const { typed, timer } = this;
    clearTimeout(timer);
    this.timer = 0;
    if (timer) this.editor.type(typed, () => { if (this.typed === typed) this.typed = null; });
  }

  // Gives up what was typed and has no answer yet.
  forget() {
    clearTimeout(this.timer);
    Object.assign(this, { typed: null, timer: 0 });
  }

  // Numbers the lines, and marks those with problems.
  mark() {
    const keys = keysOf(this.area.value), lines = this.problems.map(({ key, line }) => (line ? line - 1 : lineOf(key, keys))), wrong = new Set(lines);
    this.gutter.replaceChildren();
    for (const k of keys.keys()) make(this.gutter, "span", wrong.has(k) ? { class: "wrong" } : {}, `${k + 1}`);
    this.list.replaceChildren();
    this.problems.forEach(({ key, problem, remedy }, k) => {
      const place = [lines[k] >= 0 && `line ${lines[k] + 1}`, key].filter(Boolean).join(", ");
      make(this.list, "li", {}, `${place ? `${place}: ` : ""}${[problem, remedy].filter(Boolean).join("; ")}`);
    });
  }

  // --- completion --------------------------------------------------------------------------------------------------------

  // Offers what can be written at the caret: keys of the table, or values of the key; and says what the key means.
  offer() {
    const { area, editor: { form: { groups = [] } } } = this, { value, selectionStart: at } = area;
    const start = value.lastIndexOf("\n", at - 1) + 1, before = value.slice(start, at), keys = keysOf(value);
    const { table, name } = keys[value.slice(0, at).split("\n").length - 1], plain = table.replace(/\[\d+\]/g, "[]");
    const group = groups.find(({ key }) => key === plain), kinds = group?.kinds ? Object.values(group.kinds).flat() : [];
    const fields = new Map([...group?.fields ?? [], ...kinds].map((field) => [field.key.slice(plain.length + (plain ? 1 : 0)), field]));
    const field = fields.get(name), used = new Set(keys.filter((other) => other.table === table).map((other) => other.name));
    const [, word] = before.match(/^\s*([\w.-]*)$/) ?? [], [, chosen] = before.match(/=\s*"?([\w-]*)$/) ?? [], [, head] = before.match(/^\s*\[+\s*([\w.-]*)$/) ?? [];
    let found = [];
    if (word !== undefined && !name) found = [...fields].filter(([other]) => !used.has(other)).map(([other, { help }]) => [other, `${other} = `, help]);
    else if (head !== undefined) found = groups.filter(({ key, named }) => key && !named).map(({ key, help }) => [key.replaceAll("[]", ""), `${key.replaceAll("[]", "")}${before.includes("[[") ? "]]" : "]"}`, help]);
    else if (chosen !== undefined && field) found = field.choices.map((choice) => [String(choice), JSON.stringify(choice), ""]);
    const typed = word ?? head ?? chosen ?? "", quote = chosen !== undefined && before.endsWith(`"${typed}`) ? 1 : 0;
    found = found.filter(([label]) => label.startsWith(typed) && label !== typed).slice(0, MOST);
    this.first = null;
    this.offers.replaceChildren();
    for (const [label, text, help] of found) {
      const take = () => { area.focus(); area.setRangeText(text, at - typed.length - quote, at, "end"); this.input(); this.offer(); };
      if (typed) this.first ??= take;
      make(this.offers, "button", { type: "button", title: help, tabindex: -1 }, label).addEventListener("click", take);
    }
    const { help, unit, default: usual } = field ?? {}, most = [unit, usual !== null && usual !== undefined && `${JSON.stringify(usual)} if left out`].filter(Boolean).join(", ");
    this.about.textContent = field ? `${name}: ${help}${most ? ` (${most})` : ""}` : found.length && typed ? "Tab takes the first." : "";
  }

  // Tab takes the first offer of a word that is begun; otherwise it leads on, as everywhere.
  key(event) {
    if (event.key !== "Tab" || event.shiftKey || !this.first) return;
    event.preventDefault();
    this.first();
  }
}
