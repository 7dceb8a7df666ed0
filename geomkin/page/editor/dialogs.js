// Dialogs of the editor: the gallery of recipes and kinds, and the name under which a recipe is saved; drafts and links.
import { narrow } from "../player/search.js";
import { make } from "../player/shapes.js";
import { get, post } from "./server.js";

const at = (id) => document.getElementById(id);
const TITLES = { start: "Open a recipe", open: "Open a recipe", new: "Start a new recipe", join: "Join a mechanism to a shaft" };
// Counts how often the gallery was asked for: of its lists only those of the last time are shown.
let turn = 0;
const isStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

// Returns a function that loads an image when it comes into view. Only one is loaded at a time, because the server draws it.
function loader(root) {
  const waiting = new Set();
  let busy = false;
  const next = () => {
    const [image] = waiting;
    if (busy || !image) return;
    busy = true;
    waiting.delete(image);
    observer.unobserve(image);
    image.src = image.dataset.address;
  };
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) waiting[isIntersecting ? "add" : "delete"](target);
    next();
  }, { root });
  const done = () => { busy = false; next(); };
  return (image) => {
    image.addEventListener("load", done, { once: true });
    // The server has no picture of a kind that needs a search.
    image.addEventListener("error", () => { image.remove(); done(); });
    observer.observe(image);
  };
}

// Shows the gallery. A click on a card calls `editor.open(recipe)` or `editor.startNew(kind, example)`; if it is to be joined to the
// shown one, `editor.joinTo({ recipe })` or `editor.joinTo({ kind })`.
// what: "start", "open", "new" or "join"; said: why it is shown.
export async function showGallery(editor, what, said = "") {
  const isJoined = what === "join", isNew = what === "new", dialog = at("gallery-dialog"), load = loader(dialog), mine = ++turn;
  const fitting = ({ joins }) => !isJoined || joins, { kinds: allKinds, recipes } = await get("gallery"), kinds = allKinds.filter(fitting);
  if (mine !== turn || document.querySelector("dialog[open]:not(#gallery-dialog)")) return;
  const card = (list, picture, name, about, words, act) => {
    const button = make(make(list, "li", { "data-words": `${name} ${words} ${about}` }), "button", { type: "button", class: "card" });
    if (picture) addPicture(button, picture, load);
    make(button, "b", {}, name);
    if (about) make(button, "span", {}, about);
    button.addEventListener("click", () => { dialog.close(); Promise.resolve(act()).catch((error) => editor.announce(error.message)); });
  };
  for (const id of ["by-hand", "folder", "kinds", "examples"]) at(id).replaceChildren();
  at("gallery-title").textContent = TITLES[what];
  at("gallery-said").textContent = said;
  if (!isJoined) card(at("by-hand"), "", "empty linkage", "built by clicks: pivots, bars, plates, dyads, slides", "build draw empty new linkage", () => editor.startEmpty());
  const search = at("search");
  search.value = "";
  const find = () => narrow(dialog, search.value, ".cards, #kinds", at("no-match"));
  search.oninput = find;
  const drafts = isJoined || isNew ? [] : draftsOf(editor.folder);
  at("drafts-title").hidden = !drafts.length;
  at("drafts").replaceChildren();
  for (const draft of drafts) {
    const item = make(at("drafts"), "li"), name = draft.recipe || `new ${draft.title || draft.kind}`;
    const act = (label, does) => make(item, "button", { type: "button" }, label).addEventListener("click", does);
    act(`${name}, ${new Date(draft.changed ?? +draft.id).toLocaleString()}`, async () => {
      dialog.close();
      const opened = draft.recipe ? await editor.latest(post("open", { recipe: draft.recipe })) : {};
      if (!opened) return;
      if (draft.recipe) editor.load(opened.text, draft.recipe, opened.base);
      editor.restore(draft);
    });
    act("Discard", () => { forget(draft.id); item.remove(); });
  }
  at("folder-title").hidden = isNew || !recipes.length;
  const opened = kept(OPENED).filter(({ folder }) => folder === editor.folder).map(({ recipe }) => recipe);
  const order = ({ name }) => (opened.includes(name) ? opened.indexOf(name) : opened.length);
  at("folder-title").textContent = opened.length ? "In this folder, the last opened first" : "In this folder";
  if (!isNew) for (const { name, kind, title, words } of recipes.filter(fitting).sort((a, b) => order(a) - order(b))) card(at("folder"), `picture?recipe=${encodeURIComponent(name)}`, name, title, `${kind} ${words}`, () => (isJoined ? editor.joinTo({ recipe: name }) : editor.open(name)));
  for (const group of new Set(kinds.map((kind) => kind.group))) {
    make(at("kinds"), "h4", {}, group);
    const list = make(at("kinds"), "ul", { class: "cards" });
    for (const { kind, about, words } of kinds.filter((other) => other.group === group)) {
      card(list, `picture?kind=${encodeURIComponent(kind)}`, kind, about, `${group} ${words}`, () => (isJoined ? editor.joinTo({ kind }) : editor.startNew(kind)));
    }
  }
  find();
  if (!dialog.open) dialog.showModal();
  // A finger would be met by a keyboard.
  (matchMedia("(pointer: coarse)").matches ? at("gallery-title") : search).focus();
  const { examples } = await get("examples");
  if (mine !== turn) return;
  at("examples").replaceChildren();
  for (const { name, kind, title, words } of examples.filter(fitting)) card(at("examples"), `picture?example=${encodeURIComponent(name)}`, name, title, `${kind} ${words}`, () => (isJoined ? editor.joinTo({ example: name }) : editor.startNew(kind, name)));
  find();
}

// Adds a picture that moves while the pointer or the focus is on its card; under a finger it moves as long as it is seen.
function addPicture(button, address, load) {
  const moving = `${address}&moving=1`, isTouched = matchMedia("(hover: none)").matches;
  const image = make(button, "img", { alt: "", "data-address": isTouched && !isStill() ? moving : address });
  load(image);
  for (const event of ["pointerenter", "focus"]) button.addEventListener(event, () => { if (image.src && !isStill()) image.src = moving; });
  for (const event of ["pointerleave", "blur"]) button.addEventListener(event, () => { if (image.src && !isTouched) image.src = image.dataset.address; });
}

// --- texts that were not saved: the browser keeps the last ones, also those of pages that were closed -----------------

const DRAFTS = ["geomkin-drafts", 12], OPENED = ["geomkin-opened", 100];

// A list that the browser keeps, after a change; none if it keeps nothing, for example in a private window.
function kept([key, most], change = (all) => all) {
  try {
    const list = change(JSON.parse(localStorage.getItem(key) ?? "[]")).slice(0, most);
    localStorage.setItem(key, JSON.stringify(list));
    return list;
  } catch { return []; }
}

// The drafts of a folder, the newest first: { id, folder, recipe, kind, text, base, changed }; changed: the time, ms.
export const draftsOf = (folder) => kept(DRAFTS).filter((draft) => draft.folder === folder);
export const forget = (id) => kept(DRAFTS, (all) => all.filter((draft) => draft.id !== id));

// Keeps a draft: one for a recipe with a file, besides the one whose id is offered, and one for a text, however often a link with
// it is opened.
export function keep(draft, offered) {
  const isSame = ({ id, folder, recipe, text }) => id === draft.id || (folder === draft.folder && recipe === draft.recipe && (recipe !== "" || text === draft.text));
  kept(DRAFTS, (all) => {
    const { changed = Date.now() } = all.find((other) => isSame(other) && other.text === draft.text) ?? {};
    return [{ ...draft, changed }, ...all.filter((other) => other.id === offered || !isSame(other))];
  });
}

// Remembers that a recipe of a folder was opened.
export function remember(folder, recipe) {
  kept(OPENED, (all) => [{ folder, recipe }, ...all.filter((other) => other.folder !== folder || other.recipe !== recipe)]);
}

// Why a text is no name of a file on all systems, as the command has it; "" if it is one.
function flawOfName(name) {
  const [bad] = name.match(/[/\\:*?"<>|\p{C}]/u) ?? [];
  if (!name) return "Type a name.";
  if (bad) return `A name of a file has no ${bad}; leave it out.`;
  return /^[.-]|\.$/.test(name) ? "A name of a file begins with a letter or digit, and does not end with a dot." : "";
}

// Asks for a name and resolves to it, without `.toml`; to "" if the user cancels.
export function chooseName(name) {
  const dialog = at("name-dialog"), input = at("file-name");
  input.value = name;
  input.oninput = () => input.setCustomValidity(flawOfName(input.value.trim()));
  input.oninput();
  dialog.returnValue = "";
  dialog.showModal();
  input.select();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "save" ? input.value.trim().replace(/\.toml$/, "") : ""), { once: true });
  });
}

// --- a recipe's text as Python --------------------------------------------------------------------------

// A script that loads the recipe and makes its files.
export const python = (text) => `import geomkin as gk

recipe = gk.load(
    ${text.trimEnd().split("\n").map((line) => JSON.stringify(`${line}\n`)).join("\n    ")}
)
gk.make(recipe, "out")
`;
