// Dialogs of the editor: recipes to open, kinds to begin with, the name of a file.
import { make } from "../player/shapes.js";
import { get } from "./server.js";

const at = (id) => document.getElementById(id);

// editor: open(recipe), startNew(kind).
export async function showGallery(editor) {
  const dialog = at("gallery-dialog"), { kinds, recipes } = await get("gallery");
  const card = (list, picture, name, about, act) => {
    const button = make(make(list, "li"), "button", { type: "button", class: "card" });
    make(button, "img", { src: picture, alt: "", loading: "lazy" }).addEventListener("error", (event) => event.target.remove());
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

// The name that the user gives; "" if none.
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
