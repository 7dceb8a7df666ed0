// Search by words among elements with `data-words`, such as the cards of a gallery.

// Words of a wish that say nothing about a mechanism, and endings that are left out.
const FILLERS = new Set("a an and are as at be by can for from have i in into is it its mechanism motion need of on one or some something someone that the thing this to want which with".split(" "));
const ENDINGS = ["ing", "ed", "es", "s"], STEM = 4;
// The limit of a value, which says nothing about a mechanism either.
const LIMIT = /\b(?:(?:less|more) than|at (?:least|most)|below|under|above|over) [0-9]\S*/g;
// Most elements that half of a wish finds.
const MOST = 8;

const wordsOf = (text) => text.toLowerCase().match(/[\p{L}\p{N}]+/gu) ?? [];

function stem(word) {
  const ending = ENDINGS.find((end) => word.endsWith(end) && word.length - end.length >= STEM) ?? "";
  return word.slice(0, word.length - ending.length);
}

// Shows the elements in `root` that have all words of a wish or, if none has, most of them, or half of them with one in the
// name, if these are few; hides the headings of lists without any; `lists`: what has a heading before it; `said`: the
// element that states that no element has all words. The name is the first word of `data-words`.
export function narrow(root, wish, lists, said) {
  const cards = [...root.querySelectorAll("[data-words]")], all = wordsOf(wish.toLowerCase().replace(LIMIT, "")), telling = all.filter((word) => !FILLERS.has(word));
  const wanted = (telling.length ? telling : all).map(stem);
  const count = (text) => {
    const known = wordsOf(text);
    // A short word is a whole one.
    return wanted.filter((word) => known.some((other) => (word.length < 3 ? other === word : other.startsWith(word)))).length;
  };
  const counts = new Map(cards.map((card) => [card, count(card.dataset.words)])), most = Math.max(0, ...counts.values());
  let best = cards.filter((card) => counts.get(card) === most);
  if (wanted.length && most <= wanted.length / 2) {
    best = best.filter(({ dataset: { words } }) => most === wanted.length / 2 && count(words.split(" ", 1)[0]));
    if (best.length > MOST) best = [];
  }
  for (const card of cards) card.hidden = !best.includes(card);
  for (const list of root.querySelectorAll(lists)) list.previousElementSibling.hidden = !list.querySelector("[data-words]:not([hidden])");
  said.hidden = most === wanted.length;
  said.textContent = `Nothing has all of these words${best.length ? "; these have the most of them" : ""}.`;
}
