// Pictures of recipes whose moving page is in the site, by `moving.js`: the first of a page is live, others on a click.
document.addEventListener("DOMContentLoaded", () => {
  const root = document.documentElement.dataset.content_root ?? "./";
  const pictures = [...document.querySelectorAll(".bd-article img:not(.card-picture)")];
  const found = pictures.map((picture) => [picture, recipeOf(picture.getAttribute("src"))]).filter(([, name]) => name);
  found.forEach(([picture, name], k) => (k ? offer(picture, name) : start(picture, name)));
  // Names of the theme's controls for those who hear them: what is written on them, or the page that they open.
  document.querySelector(".navbar-persistent--container > .search-button__button")?.removeAttribute("aria-label");
  for (const summary of document.querySelectorAll(".bd-sidebar summary")) {
    const link = summary.closest("li")?.querySelector("a");
    if (link && !summary.textContent.trim()) summary.setAttribute("aria-label", `Pages below ${link.textContent}`);
  }

  function recipeOf(address) {
    const file = address.split("/").pop();
    return MOVING.filter((name) => file.startsWith(`${name}.`) || file.startsWith(`${name}-`)).sort((a, b) => b.length - a.length)[0];
  }

  function start(element, name) {
    const frame = document.createElement("iframe");
    Object.assign(frame, { src: `${root}moving/${name}.html#embed`, title: `${name}, moving`, className: "moving" });
    element.replaceWith(frame);
  }

  function offer(picture, name) {
    const button = document.createElement("button");
    Object.assign(button, { className: "play", title: "move it", onclick: () => start(button, name) });
    picture.replaceWith(button);
    button.append(picture);
  }
});
