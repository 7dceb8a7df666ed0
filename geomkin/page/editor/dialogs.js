// Dialogs of the editor: the gallery of recipes and kinds, and the name under which a recipe is saved.
import { make } from "../player/shapes.js";
import { get } from "./server.js";

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

// Shows the gallery. A click on a card calls `editor.open(recipe)` or `editor.startNew(kind)`.
export async function showGallery(editor) {
  const dialog = at("gallery-dialog"), { kinds, recipes } = await get("gallery"), load = loader(dialog);
  const card = (list, picture, name, about, act) => {
    const button = make(make(list, "li"), "button", { type: "button", class: "card" });
    load(make(button, "img", { alt: "", "data-address": picture }));
    make(button, "b", {}, name);
    if (about) make(button, "span", {}, about);
    button.addEventListener("click", () => { dialog.close(); act().catch((error) => editor.announce(error.message)); });
  };
  at("folder").replaceChildren();
  at("kinds").replaceChildren();
  at("folder-title").hidden = !recipes.length;
  for (const recipe of recipes) card(at("folder"), `picture?recipe=${encodeURIComponent(recipe)}`, recipe, "", () => editor.open(recipe));
  for (const group of new Set(kinds.map((kind) => kind.group))) {
    make(at("kinds"), "h4", {}, group);
    const list = make(at("kinds"), "ul", { class: "cards" });
    for (const { kind, about } of kinds.filter((other) => other.group === group)) {
      card(list, `picture?kind=${encodeURIComponent(kind)}`, kind, about, () => editor.startNew(kind));
    }
  }
  dialog.showModal();
}

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
