// Dialogs of the editor: the gallery of recipes and kinds, and the name under which a recipe is saved; drafts and links.
import { make } from "../player/shapes.js";
import { get, post } from "./server.js";

const at = (id) => document.getElementById(id);

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
    image.addEventListener("load", done);
    // The server has no picture of a kind that needs a search.
    image.addEventListener("error", () => { image.remove(); done(); });
    observer.observe(image);
  };
}

// Shows the gallery. A click on a card calls `editor.open(recipe)` or `editor.startNew(kind, example)`; if it is to be joined to the
// shown one, `editor.joinTo({ recipe })` or `editor.joinTo({ kind })`.
export async function showGallery(editor, isJoined = false) {
  const dialog = at("gallery-dialog"), { kinds, recipes } = await get("gallery"), load = loader(dialog);
  const card = (list, picture, name, about, words, act) => {
    const button = make(make(list, "li"), "button", { type: "button", class: "card" });
    if (picture) load(make(button, "img", { alt: "", "data-address": picture }));
    make(button, "b", {}, name);
    if (about) make(button, "span", {}, about);
    button.dataset.words = `${name} ${words} ${about}`.toLowerCase();
    button.addEventListener("click", () => { dialog.close(); Promise.resolve(act()).catch((error) => editor.announce(error.message)); });
  };
  for (const id of ["by-hand", "folder", "kinds", "examples"]) at(id).replaceChildren();
  at("gallery-title").textContent = isJoined ? "Join a mechanism to a shaft" : "Open a recipe";
  if (!isJoined) card(at("by-hand"), "", "empty linkage", "built by clicks: pivots, bars, plates, dyads, slides", "build draw empty new linkage", () => editor.startEmpty());
  const search = at("search");
  search.value = "";
  search.oninput = () => narrow(dialog, search.value);
  const drafts = isJoined ? [] : draftsOf(editor.folder);
  at("drafts-title").hidden = !drafts.length;
  at("drafts").replaceChildren();
  for (const draft of drafts) {
    const item = make(at("drafts"), "li"), name = draft.recipe || `new ${draft.kind}`;
    const act = (label, does) => make(item, "button", { type: "button" }, label).addEventListener("click", does);
    act(`${name}, ${new Date(+draft.id).toLocaleString()}`, async () => {
      dialog.close();
      const opened = draft.recipe ? await editor.latest(post("open", { recipe: draft.recipe })) : {};
      if (!opened) return;
      if (draft.recipe) editor.load(opened.text, draft.recipe, opened.base);
      editor.restore(draft);
    });
    act("Discard", () => { forget(draft.id); item.remove(); });
  }
  at("folder-title").hidden = !recipes.length;
  for (const { name, kind, title } of recipes) card(at("folder"), `picture?recipe=${encodeURIComponent(name)}`, name, title, kind, () => (isJoined ? editor.joinTo({ recipe: name }) : editor.open(name)));
  for (const group of new Set(kinds.map((kind) => kind.group))) {
    make(at("kinds"), "h4", {}, group);
    const list = make(at("kinds"), "ul", { class: "cards" });
    for (const { kind, about } of kinds.filter((other) => other.group === group)) {
      card(list, `picture?kind=${encodeURIComponent(kind)}`, kind, about, group, () => (isJoined ? editor.joinTo({ kind }) : editor.startNew(kind)));
    }
  }
  narrow(dialog, "");
  dialog.showModal();
  // A mechanism that is joined is a file of the folder, or of a kind.
  const { examples } = isJoined ? { examples: [] } : await get("examples");
  at("examples").replaceChildren();
  for (const { name, kind, title } of examples) card(at("examples"), `picture?example=${encodeURIComponent(name)}`, name, title, kind, () => editor.startNew(kind, name));
  narrow(dialog, search.value);
}

// Shows the cards that have all words, and the headings of lists that are not empty.
function narrow(dialog, text) {
  const wanted = text.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const card of dialog.querySelectorAll(".card")) {
    card.parentNode.hidden = !wanted.every((word) => card.dataset.words.includes(word));
    count += !card.parentNode.hidden;
  }
  for (const list of dialog.querySelectorAll(".cards, #kinds")) list.previousElementSibling.hidden = !list.querySelector("li:not([hidden])");
  at("no-match").hidden = count > 0;
}

// --- texts that were not saved: the browser keeps the last ones, also those of pages that were closed -----------------

const DRAFTS = "geomkin-drafts", MOST_DRAFTS = 12;

function changeDrafts(change) {
  try {
    localStorage.setItem(DRAFTS, JSON.stringify(change(JSON.parse(localStorage.getItem(DRAFTS) ?? "[]")).slice(0, MOST_DRAFTS)));
  } catch { /* A browser may keep nothing, for example in a private window. */ }
}

// The drafts of a folder, the newest first: { id, folder, recipe, kind, text, base }.
export function draftsOf(folder) {
  let drafts = [];
  changeDrafts((all) => { drafts = all.filter((draft) => draft.folder === folder); return all; });
  return drafts;
}

export const forget = (id) => changeDrafts((all) => all.filter((draft) => draft.id !== id));
export const keep = (draft) => changeDrafts((all) => [draft, ...all.filter(({ id }) => id !== draft.id)]);

// Asks for a name and resolves to it, without `.toml`; to "" if the user cancels.
export function chooseName(name) {
  const dialog = at("name-dialog"), input = at("file-name");
  input.value = name;
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
