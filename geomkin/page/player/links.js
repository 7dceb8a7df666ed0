// Links that hold a whole recipe: `#recipe=` and base64 of its UTF-8, as addresses have it. Any page and any studio opens one.
import { make } from "./shapes.js";
import { offer } from "./pictures.js";

// Where a studio on this machine opens a link, unless it says where it is.
const STUDIO = "http://127.0.0.1:8017", SIGN = "#recipe=";

export function linkOf(text, studio = STUDIO) {
  const bytes = Array.from(new TextEncoder().encode(text), (byte) => String.fromCharCode(byte)).join("");
  return `${studio}/open${SIGN}${btoa(bytes).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

// What is said of a link that holds a part of a recipe.
export const INCOMPLETE = "This link is incomplete: copy all of it";

// The recipe in the part of an address from # on; null if there is none, and an error if it is damaged.
export function recipeIn(hash) {
  if (!hash.startsWith(SIGN)) return null;
  const bytes = Uint8Array.from(atob(hash.slice(SIGN.length).replaceAll("-", "+").replaceAll("_", "/")), (sign) => sign.charCodeAt(0));
  const text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  if (!/^\s*["']?kind["']?\s*=/m.test(text)) throw new Error(INCOMPLETE);
  return text;
}

// Opens a recipe in the studio: in another tab, or in this one where no other may be opened.
function openInStudio(text) {
  const link = linkOf(text);
  if (!window.open(link, "_blank")) location.assign(link);
}

// Gives the buttons of a page's recipe what they do, and offers the recipe of the link that led to the page.
export function mountRecipe(name) {
  const shown = document.getElementById("recipe-text"), text = () => `${shown.textContent}\n`, page = document.getElementById("embed");
  const on = (id, act) => document.getElementById(id)?.addEventListener("click", act);
  on("save-recipe", () => offer(text(), `${name}.toml`, "text/plain"));
  on("open-recipe", () => openInStudio(text()));
  const greet = () => {
    let recipe = null, isWhole = true;
    try { recipe = recipeIn(location.hash); } catch { isWhole = false; }
    document.getElementById("linked")?.remove();
    if ((recipe === null && isWhole) || !page) return;
    const line = make(page, "p", { id: "linked", role: "status" }, isWhole ? "" : `${INCOMPLETE}.`);
    if (!isWhole) return;
    make(line, "span", {}, "The link that you opened holds another recipe: ");
    const button = (label, act) => {
      make(line, "button", { type: "button" }, label).addEventListener("click", act);
      line.append(" ");
    };
    button("Open it in the studio", () => openInStudio(recipe));
    button("Save it", () => offer(recipe, "recipe.toml", "text/plain"));
  };
  addEventListener("hashchange", greet);
  greet();
}
