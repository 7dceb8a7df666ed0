// The editor of the studio: it connects the player with its handles, the form, and the server that edits the recipe's text.
import { INCOMPLETE, linkOf, recipeIn } from "../player/links.js";
import { make, spaced } from "../player/shapes.js";
import { mount } from "../player/player.js";
import { read } from "../player/plots.js";
import { mountRows, showRows } from "../player/rows.js";
import { chooseName, draftsOf, forget, keep, python, remember, showGallery } from "./dialogs.js";
import { Dimensions } from "./dimensions.js";
import { Form } from "./form.js";
import { Ghost } from "./ghost.js";
import { Handles } from "./handles.js";
import { History } from "./history.js";
import { showPictures } from "./pictures.js";
import { Preview } from "./preview.js";
import { finished, get, post } from "./server.js";
import { TextPane } from "./text.js";
import { Tools } from "./tools.js";

// Time without input after which checks are requested, ms.
const PAUSE = 150;
// Time for which the pointer rests before a search starts, ms.
const REST = 200;
// Free room around a linkage that is built, as a share of its size.
const ROOM = 0.3;
// Largest time between presses of arrow keys on one handle that form one step of undo, ms.
const ONE_STEP = 1000;
const at = (id) => document.getElementById(id);
// Two changes in one; of the same kind the second one replaces the first, except that all values stay that only one of them sets.
const bothOf = (first, second) => (first.set && second.set ? { set: { ...first.set, ...second.set } } : second);
// A key as the headings of the form have it.
const inWords = (key) => spaced(key.replace(/\[(\d+)\]/g, (_, k) => ` ${+k + 1}`)).replaceAll(".", " ");

class Editor {
  constructor() {
    // text: the recipe's text. recipe, base: name of its file, and the mark of the file's content when it was read or written.
    // savedText, saved, savedScene: text, values by key and scene of the saved recipe.
    Object.assign(this, { text: "", recipe: "", base: "", savedText: "", saved: {}, savedScene: null, locks: new Set() });
    Object.assign(this, { kind: "", values: {}, busy: false, waiting: [], texts: 0, typing: "", target: null, problems: [], checked: [] });
    this.history = new History((undo, redo) => { at("undo").disabled = !undo; at("redo").disabled = !redo; });
    this.form = new Form(at("form"), this);
    this.pane = new TextPane(at("text"), this);
    this.tools = new Tools(at("tools"), this);
    const acts = {
      gallery: () => showGallery(this, "open"), new: () => showGallery(this, "new"), join: () => showGallery(this, "join"), save: () => this.save(), "save-as": () => this.saveAs(),
      undo: () => this.travel("undo"), redo: () => this.travel("redo"), make: () => this.make(), stop: () => this.stop(),
      "share-link": () => this.copy((text) => linkOf(text, location.origin), "The link is copied; it holds the whole recipe"),
      "share-zip": () => this.zip(), "share-python": () => this.copy(python, "The recipe as Python is copied"),
    };
    for (const [id, act] of Object.entries(acts)) at(id).addEventListener("click", act);
    for (const button of document.querySelectorAll("[data-panel]")) button.addEventListener("click", () => this.fold(button.dataset.panel));
    for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => this.view(button.dataset.view));
    at("build").addEventListener("click", () => this.showTools(at("tools").hidden));
    at("badge").addEventListener("click", () => {
      this.fold("form", false);
      at("quantities-part").open = true;
      at("quantities-part").scrollIntoView({ block: "nearest" });
    });
    // What was said of one act ends with the next one.
    for (const act of ["pointerdown", "keydown"]) document.addEventListener(act, () => this.announce(""), true);
    document.addEventListener("keydown", (event) => this.key(event));
    addEventListener("hashchange", () => this.loadShared());
    addEventListener("beforeunload", (event) => { if (this.isDirty && !this.isKept) event.preventDefault(); });
  }

  get isDirty() { return this.text !== this.savedText; }

  async start() {
    const { first, text, folder } = await get("start");
    this.folder = folder;
    // Links to the studio on this machine lead here.
    try { localStorage.setItem("geomkin-studio", location.pathname); } catch { /* A browser may keep nothing. */ }
    // A notebook keeps the edited text, and a page that is loaded again continues with it.
    this.isKept = text !== "";
    // A link may have the recipe.
    if (!this.loadShared()) {
      if (first) await this.open(first); else if (text) this.load(text, "", ""); else await showGallery(this, "start");
    }
    if (first && text && this.recipe === first && text !== this.text) this.step({}, { from: () => text });
    this.whenIdle(() => this.announce(""));
    this.watch();
  }

  // Folds a panel away, or shows it again; the drawing takes its room.
  fold(panel, isFolded = !document.body.classList.contains(`no-${panel}`)) {
    document.body.classList.toggle(`no-${panel}`, isFolded);
    document.querySelector(`[data-panel="${panel}"]`).setAttribute("aria-pressed", !isFolded);
    this.player?.fit(true);
  }

  // Shows the recipe as a form or as a text.
  view(name) {
    for (const button of document.querySelectorAll("[data-view]")) {
      const isShown = button.dataset.view === name;
      button.setAttribute("aria-pressed", isShown);
      at(button.dataset.view).hidden = !isShown;
    }
    document.body.classList.toggle("as-text", name === "text");
    this.pane.show(this.text, this.problems);
  }

  // Shows the tools that build a linkage, with room around it, or hides them.
  showTools(isShown) {
    at("tools").hidden = !isShown;
    at("build").setAttribute("aria-pressed", isShown);
    document.body.classList.toggle("building", isShown);
    // A tool that was chosen while they were hidden works from now on.
    if (isShown) this.tools.setActive(); else this.tools.choose("move");
    if (!this.player) return;
    this.fold("plots", isShown);
    this.player.refit();
  }

  // What the drawing shows besides the mechanism: room around it while it is built, the picture under it, and its handles.
  room() {
    // The sheet of an unfinished linkage has room enough, and stays.
    const [left, low, right, high] = this.player.drawings[0].bounds, free = this.reply.unfinished ? 0 : ROOM * Math.max(right - left, high - low);
    return [!at("tools").hidden && [left - free, low - free, right + free, high + free], this.tools.own.photo.box, this.handles.box].filter(Boolean);
  }

  // --- changes of the recipe's text ---------------------------------------------------------------------------------

  async open(recipe) {
    const opened = await this.latest(post("open", { recipe }));
    if (!opened) return;
    this.load(opened.text, recipe, opened.base);
    const [draft] = draftsOf(this.folder).filter((other) => other.recipe === recipe);
    if (!draft) return;
    this.offered = draft.id;
    this.choose(`Changes of ${recipe} that were not saved are kept.`, {
      "Continue with them": () => this.restore(draft),
      "Discard them": () => forget(draft.id),
    });
  }

  // Continues with a text that was not saved; undo restores that of the file.
  restore({ id, text, recipe, base, title }) {
    if (!recipe) { this.load(text, "", "", title); forget(id); return; }
    this.whenIdle(() => { this.base = base; });
    this.step({}, { from: () => text, done: () => forget(id) });
  }

  // Starts with the template of a kind, or with a recipe of the gallery.
  async startNew(kind, example) {
    const started = await this.latest(post("new", example ? { example } : { kind }));
    if (started) this.load(started.text, "", "", example);
    return started;
  }

  // Starts a linkage without links, with the tools that build it.
  async startEmpty() {
    if (!await this.startNew("")) return;
    // A tool that is clicked before the drawing is there stays chosen.
    this.tools.choose("pivot");
    this.whenIdle(() => this.showTools(true));
  }

  // The answer to a request for another text; null if another one was requested since.
  async latest(answer) {
    const turn = this.turn = (this.turn ?? 0) + 1;
    this.isOpening = true;
    this.showBusy();
    try {
      const reply = await answer;
      return turn === this.turn ? reply : null;
    } finally {
      if (turn === this.turn) this.isOpening = false;
      this.showBusy();
    }
  }

  // Loads the recipe that the fragment of the address holds, and returns whether it has one.
  loadShared() {
    const { hash } = location;
    if (!hash) return false;
    history.replaceState(null, "", location.pathname);
    let text;
    try { text = recipeIn(hash); } catch { showGallery(this, "start", INCOMPLETE); return true; }
    if (text === null) return false;
    const { text: former, recipe, base, savedText, title } = this;
    this.load(text, "", "");
    // Unlike a template it is kept from the start.
    Object.assign(this, { firstText: "", before: { text: former, recipe, base, savedText, title } });
    return true;
  }

  // Why the answer to a link shows no recipe; "" if it does.
  flawOfLink({ problems, text }) {
    const has = (...ids) => problems.some(({ key, id }) => ids.includes(id) && (id !== "unknown-kind" || key === "kind"));
    if (has("invalid-toml") || (has("missing-key") && !text.endsWith("\n"))) return INCOMPLETE;
    const [first] = has("unknown-kind") ? problems : [];
    return first ? `This link holds no recipe of this geomkin: ${first.key}: ${first.problem}; ${first.remedy}` : "";
  }

  // Goes back to what was open before a link, with the list of recipes over it.
  refuseLink(said, { text, savedText, recipe, base, title }) {
    this.texts += 1;
    if (text) { this.load(text, recipe, base, title); this.savedText = savedText; } else Object.assign(this, { text: "", firstText: "" });
    return showGallery(this, "start", said);
  }

  // Loads another text. It counts as saved if it has the name of a file.
  // title: the name that is proposed for one without a file.
  load(text, recipe, base, title = "") {
    this.history.clear();
    this.announce("");
    if (recipe) remember(this.folder, recipe);
    Object.assign(this, { text, recipe, base, seen: base, savedText: recipe ? text : "", savedScene: null, kind: "", isJustLoaded: true, checked: [] });
    // A template is not worth keeping before it is changed.
    Object.assign(this, { draft: `${Date.now()}`, firstText: text, drawnText: null, title, before: null });
    this.locks.clear();
    this.tools.choose("move");
    for (const scrolled of [at("form"), document.querySelector("aside")]) scrolled.scrollTop = 0;
    this.tools.own.photo.remove();
    this.tools.own.pose.forget();
    if (this.player) this.player.filming = false;
    for (const id of ["conflict", "candidates", "known", "files-part"]) at(id).hidden = true;
    this.askAnew();
  }

  // Asks for a text that replaces the last one; changes and answers of that one no longer count.
  askAnew() {
    clearTimeout(this.resting);
    this.pane.forget();
    Object.assign(this, { waiting: [], texts: this.texts + 1, typing: "", dragged: null, pendingDrag: null, isUndoing: false, isUndone: false, unsent: null });
    this.ask({});
  }

  // Makes a change as one step of undo, in its turn, then calls done(). A newer change of the same stream replaces it as long as it waits.
  step(change, { from, stream = {}, done = () => {} } = {}) {
    this.close();
    this.whenIdle(() => this.history.begin(this.text), stream);
    this.ask(change, from, stream);
    this.whenIdle(() => { this.history.end(this.text); done(); }, stream);
  }

  // Changes values by key while the user types in a field. The first change begins a step of undo, and `close` ends it.
  set(changes, name) {
    if (this.typing !== name) { this.close(); this.whenIdle(() => this.history.begin(this.text), name); }
    this.typing = name;
    this.ask({ set: changes }, undefined, name);
  }

  // Whether a value that was typed into a field waits for its turn.
  isAwaited(name) {
    return this.waiting.some(({ change }) => Object.keys(change?.set ?? {}).some((key) => key === name || name.startsWith(`${key}[`)));
  }

  // Takes a text that was typed, and calls done() when it is answered.
  type(text, done) { this.step({}, { from: () => text, stream: "#text", done }); }

  // Adds a table or the next item of a list; the server chooses values with which the recipe is valid.
  add(key) {
    this.step({ add: key }, { done: () => document.querySelector(`#form details[data-key^="${CSS.escape(key)}"]`)?.scrollIntoView({ block: "nearest" }) });
  }

  // Makes an edit of the linkage that is built, at the position that is then shown.
  build(edit) {
    this.whenIdle(() => this.step({ build: { frame: this.player.frame, step: this.handles.onDrawing.pixel, ...edit } }, {
      done: () => { if (!this.player.drawings[0].isInside) this.player.fit(true); },
    }));
  }

  // Sets the length of a dimension of the drawing.
  setLength(dimension, length) { this.step({ length: { ...dimension, length } }); }

  // Known linkages whose curves are similar to a stroke.
  async known(points) { return (await post("nearest", { points })).known; }

  // Follows a stroke: first by known linkages, of which a click takes one, then by a search.
  async drawPath(points) {
    this.close();
    const turn = this.strokes = (this.strokes ?? 0) + 1, { texts } = this, isLate = () => turn !== this.strokes || texts !== this.texts;
    this.announce("Looking for known linkages");
    try {
      const known = await this.known(points);
      if (isLate()) return;
      this.showKnown(known);
    } catch (error) { if (!isLate()) this.fail(error); return; }
    this.replaceBy({ draw: { points } });
    this.whenIdle(() => this.announce(""), "#draw");
  }

  // Puts a mechanism of the gallery, source, on the shaft that is clicked.
  joinTo(source) {
    this.tools.pick(this.reply.shafts, (body, phase) => this.replaceBy({ join: { ...source, turned_by: body, phase_deg: phase } }));
  }

  // Makes a change that may lead to another kind of recipe.
  replaceBy(change, text, said = "") {
    const done = () => { this.player.refit(); this.announce(said); };
    this.step(change, { from: text && (() => text), stream: text ? "#text" : change.draw && "#draw", done });
  }

  showKnown(known) {
    at("known").hidden = !known.length;
    showPictures(at("known"), known.map((linkage) => ({ ...linkage, name: linkage.label, act: () => this.takeKnown(linkage) })));
    if (known.length) this.announce(`${known.length} known linkages are similar; the search begins`);
  }

  // Takes a known linkage in the place of the recipe that is open.
  takeKnown({ label, text }) {
    const saves = this.recipe && `; Save writes it to ${this.recipe}.toml`;
    this.replaceBy({}, text, `The recipe is now this linkage, ${label}${saves}; Undo brings back the former one`);
  }

  // Sends what is typed still, and ends its step and that of presses on a handle.
  close() {
    this.pane.send();
    if (this.typing) this.whenIdle(() => this.history.end(this.text), this.typing);
    Object.assign(this, { typing: "", nudged: "" });
  }

  reset(key, field) {
    const value = this.saved[key];
    const isDefault = value === undefined || (field.optional && JSON.stringify(value) === JSON.stringify(field.default));
    this.set({ [key]: isDefault ? null : value }, key);
    this.close();
  }

  // Every request of a drag starts from the text before the drag, so that positions on the way have no effect on the result.
  startDrag() {
    this.close();
    this.wasPlaying = this.player.playing;
    this.player.play(false);
    const held = this.dragged = {};
    this.whenIdle(() => { held.text = this.textOfScene; this.history.begin(this.text); }, held);
  }

  // The text, or if it is refused the last one that was drawn: a drag leads out of sizes that cannot be assembled.
  get textOfScene() { return this.problems.length ? this.drawnText ?? this.text : this.text; }

  drag(handle, change) {
    const { id } = handle, { dragged } = this;
    if (!dragged) return;
    this.previewDrag(handle, change);
    const act = () => this.ask({ drag: { handle: id, ...change } }, () => dragged.text, dragged);
    if (!this.isSearch) { act(); return; }
    // A search starts when the pointer rests.
    clearTimeout(this.resting);
    this.pendingDrag = () => { this.pendingDrag = null; clearTimeout(this.resting); act(); };
    this.resting = setTimeout(() => this.pendingDrag?.(), REST);
  }

  // Until the answer comes; at a limit, and for round values, only the answer shows where the handle goes.
  previewDrag(handle, { to, snap }) {
    if (!this.isSearch && !snap && !this.reply?.limit) this.preview.drag(handle, to, this.locks);
  }

  get isSearch() { return this.reply?.search; }

  cancelDrag() {
    const { dragged } = this;
    if (!dragged) return;
    this.pendingDrag = null;
    clearTimeout(this.resting);
    this.ask({}, () => dragged.text, dragged);
    this.whenIdle(() => {
      this.history.end(this.text);
      if (this.wasPlaying) this.player.play(true);
    }, dragged);
    this.announce("The drag was cancelled");
  }

  endDrag({ label }) {
    const { dragged } = this;
    if (!dragged) return;
    this.pendingDrag?.();
    this.whenIdle(() => { if (this.problems.length) this.ask({}, () => dragged.text, dragged); }, dragged);
    this.whenIdle(() => {
      if (this.history.end(this.text)) this.announceChange(label);
      if (!this.player.shownDrawings.every((drawing) => drawing.isFitting)) this.player.refit();
      if (this.wasPlaying) this.player.play(true);
    }, dragged);
  }

  nudge({ id, label }, change) {
    this.player.play(false);
    const now = performance.now(), stream = `handle ${id}`, isContinued = this.nudged === id && now - this.nudgedAt < ONE_STEP, target = { id, to: change.to };
    if (!isContinued) { this.close(); this.whenIdle(() => this.history.begin(this.text), stream); }
    Object.assign(this, { nudged: id, nudgedAt: now, target });
    this.ask({ drag: { handle: id, ...change } }, () => this.textOfScene, stream);
    this.whenIdle(() => {
      if (this.target === target) this.target = null;
      this.history.end(this.text, isContinued);
      this.announceChange(label);
    }, stream);
  }

  // The requested position of a handle that arrow keys move, until the answer arrives; else null.
  pending({ id }) { return this.target?.id === id ? this.target.to : null; }

  relock() { this.ask({}); }

  // A search that runs is stopped by undo, and counts as undone if that leaves the text as it was before it.
  travel(direction) {
    this.close();
    if (direction === "undo") this.isUndoing = this.busy;
    this.whenIdle(() => {
      const { isUndone } = this;
      Object.assign(this, { isUndoing: false, isUndone: false });
      if (isUndone) { this.announce("Undone"); return; }
      const text = this.history[direction](this.text);
      if (text === null) return;
      this.text = text;
      this.ask({});
      this.whenIdle(() => this.announce(direction === "undo" ? "Undone" : "Done again"));
    });
  }

  // --- requests: one at a time, in turn; one that waits is replaced by the next one of its stream, such as the same drag ---------

  // from: the text that is changed, when its turn comes.
  ask(change, from = () => this.text, stream = {}) {
    const last = this.waiting.findLast((other) => other.change || other.stream !== stream);
    if (last?.change && last.stream === stream) Object.assign(last, { change: bothOf(last.change, change), from });
    else this.waiting.push({ change, from, stream });
    clearTimeout(this.checkTimer);
    this.pump();
  }

  // Calls `act` as soon as all that was asked for before is answered, and not if another recipe is loaded before that.
  // stream: that of the request that it is part of.
  whenIdle(act, stream = null) {
    if (this.busy) this.waiting.push({ act, stream }); else act();
  }

  async pump() {
    if (this.busy) return;
    this.busy = true;
    this.showBusy();
    try {
      while (this.waiting.length) {
        const { texts } = this, next = this.waiting.shift(), later = next.act ? this.waiting.splice(0) : [];
        // What an act asks for is its own turn.
        if (next.act) next.act(); else await this.send(next);
        if (texts === this.texts) this.waiting.push(...later);
      }
    } finally { this.busy = false; }
    this.showBusy();
    this.checkTimer = setTimeout(() => this.check(), PAUSE);
  }

  async send(asked) {
    const { change, from } = asked, { texts } = this;
    try {
      let reply = await this.answer({ text: from(), ...change, lane: "scene" });
      // A search that takes long is a job.
      if (reply.job) reply = (await this.follow(reply.job, () => texts !== this.texts || this.isUndoing || this.followerOf(asked))).result;
      if (texts !== this.texts) return;
      this.isUndone = this.isUndoing && !reply && this.history.begun === this.text;
      const follower = this.followerOf(asked);
      if (reply) await this.show(reply, change.set ?? {});
      else if (follower) follower.change = bothOf(change, follower.change);
      else this.announce("The search was stopped, and the recipe is as before");
    } catch (error) {
      if (texts !== this.texts) return;
      if (error.status === 0) this.unsent = { ...asked, change: bothOf(this.unsent?.change ?? {}, change) };
      this.fail(error);
    }
  }

  // Asks again what the studio did not answer.
  askAgain() {
    const { change = {}, from } = this.unsent ?? {};
    this.unsent = null;
    this.step(change, { from });
  }

  // The next request, if it stops the search of another one: of the same stream, one more change of values, or another text.
  followerOf({ change, stream }) {
    const next = this.waiting.find((other) => other.change || !other.stream);
    return next?.change && ([stream, "#text"].includes(next.stream) || (next.change.set && change.set)) ? next : null;
  }

  showBusy() { document.body.classList.toggle("solving", Boolean(this.busy || this.isOpening)); }

  answer(body) { return post("answer", { recipe: this.recipe, locks: [...this.locks], ...body }); }

  async check() {
    const { text } = this;
    if (!text || this.problems.length) return;
    try {
      let reply = await this.answer({ text, lane: "checks" });
      if (reply.job) reply = (await finished(reply.job, () => {})).result;
      if (reply && text === this.text && !this.busy) this.showChecks(reply);
    } catch (error) { if (text === this.text) this.fail(error); }
  }

  fail(error) {
    if (!error.problems) throw error;
    this.showProblems(error.problems);
  }

  // --- display of an answer -----------------------------------------------------------------------------------------

  // set: values by key that were changed.
  async show(reply, set) {
    const { texts, before } = this, flaw = before ? this.flawOfLink(reply) : "";
    this.before = null;
    if (flaw) { await this.refuseLink(flaw, before); return; }
    Object.assign(this, { text: reply.text, reply, unsent: null });
    document.body.classList.toggle("unchecked", this.text !== this.checkedText);
    // A wrong text that is opened shows the values that it states; of one that is edited the form keeps what was typed.
    const values = Object.keys(reply.values).length ? reply.values : this.isJustLoaded ? reply.written : null;
    if (values) this.values = values;
    await this.describe(reply);
    if (texts !== this.texts) return;
    if (this.text === this.savedText || this.isJustLoaded) this.saved = this.values;
    if (reply.scene) this.showScene(reply); else this.showOpen(reply, set);
    if (values) this.form.show(this.values, this.saved, this.text, reply.unavailable);
    this.showProblems(reply.problems);
    this.showQuantities(reply.quantities);
    at("limit").hidden = !reply.limit;
    at("limit").textContent = reply.limit ? `${reply.limit.reason}${reply.limit.keys.length ? ` (${reply.limit.keys.map(inWords).join(", ")})` : ""}` : "";
    this.showState();
  }

  // Loads the form of the recipe's kind, and again if the recipe has other tables or kinds inside.
  async describe({ kind, problems }) {
    const { values } = this;
    if (problems.some(({ key, id }) => key === "kind" && id === "unknown-kind")) { this.form.describe([]); return; }
    const tables = JSON.stringify(Object.entries(values).map(([key, value]) => (key === "units" || key.endsWith(".kind") ? [key, value] : key)));
    if (!kind || (kind === this.kind && (tables === this.tables || tables === "[]"))) return;
    const { groups } = await post("form", { kind, values });
    this.form.describe(groups);
    Object.assign(this, { kind, tables });
  }

  showScene(reply) {
    const { scene, handles, preview, structure, unfinished } = reply, wasUnfinished = document.body.classList.contains("unfinished");
    document.body.classList.toggle("unfinished", unfinished !== "");
    const canBuild = structure || ["path-generator", "body-guidance"].includes(reply.kind);
    at("build").hidden = !canBuild;
    at("join").hidden = !reply.shafts.length;
    const copy = this.text === this.savedText || this.isJustLoaded ? structuredClone(scene) : null;
    if (!this.player) {
      this.player = mount(at("player"), scene);
      this.player.right.append(this.player.root.querySelector(".values"));
      this.handles = new Handles(this.player, this);
      this.ghost = new Ghost(this.player.drawings[0]);
      this.preview = new Preview(this.player, this.handles);
      this.tools.mount();
      this.dimensions = new Dimensions(this.player.drawings[0], this);
      this.player.drawings[0].roomNow = () => this.room();
    } else this.player.replace(scene);
    if (copy) this.savedScene = read(copy);
    Object.assign(this, { tried: {}, drawnText: this.text });
    this.handles.load(handles);
    if (this.isJustLoaded) this.player.zoom(0);
    this.preview.load(preview);
    // The pointer is already farther on.
    const { drag } = this.waiting.find(({ change }) => change?.drag)?.change ?? {}, handle = drag && handles.find(({ id }) => id === drag.handle);
    if (handle && this.handles.held) this.previewDrag(handle, drag);
    if (this.isJustLoaded) this.showHandlesOfPlots(handles);
    this.isJustLoaded = false;
    this.ghost.load(this.isDirty ? this.savedScene : null);
    this.showChoice(scene.choice);
    this.tools.load(reply);
    if (!canBuild && !at("tools").hidden) this.showTools(false);
    if (wasUnfinished && structure && !unfinished && !this.tools.isActive && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.player.play(true);
  }

  // Shows the gap of a mechanism that cannot be assembled. Its values are those of the last scene and what was set since.
  showOpen({ problems }, set) {
    Object.assign(this.tried ??= {}, set);
    const known = ([key, value]) => {
      const [, name, item] = key.match(/^(.*?)(?:\[(\d+)\])?$/), before = item ? this.values[name]?.[item] : this.values[key];
      return typeof value === "number" && typeof before === "number" ? [[key, value - before]] : [];
    };
    const isOpen = problems.some(({ id }) => id === "does-not-assemble");
    this.preview?.open(isOpen ? Object.fromEntries(Object.entries(this.tried).flatMap(known)) : null);
  }

  // Selects a plot that has handles as the first plot, if there is one.
  showHandlesOfPlots(handles) {
    const { plots } = this.player, ids = new Set(handles.map(({ plot }) => plot)), [card] = plots.cards;
    const k = plots.data.plots.findIndex(({ columns }) => columns.some((column) => ids.has(plots.data.columns[column].id)));
    if (k < 0 || !card || card.chosen === k) return;
    card.select.value = card.chosen = k;
    plots.build(card);
  }

  showChoice(choice) {
    const root = at("choice");
    root.hidden = !choice;
    if (!choice) return;
    at("choice-help").hidden = !choice.key;
    if (this.family) showRows(this.family, read(choice));
    else this.family = mountRows(root, read(choice), (row, data) => this.chooseRow(row, data));
  }

  // Chooses a solution: writes the value in its row, rounded to the fewest decimals that distinguish neighbouring rows.
  chooseRow(row, { key, instead_of, chosen, columns: [{ row: values }] }) {
    if (!key || row === chosen) return;
    const [first, last] = [values[0], values[values.length - 1]];
    const digits = Math.max(0, Math.ceil(-Math.log10((last - first) / values.length)));
    const value = +values[row].toFixed(Math.min(digits, 12));
    this.set({ [key]: value < first || value > last ? values[row] : value, ...Object.fromEntries(instead_of.map((other) => [other, null])) }, key);
    this.close();
  }

  showProblems(problems) {
    this.problems = problems;
    this.pane.show(this.text, problems);
    document.body.classList.toggle("stale", problems.length > 0);
    if (problems.length) at("badge").hidden = true;
    at("problems").replaceChildren();
    for (const { key, problem, remedy } of this.form.showProblems(problems)) {
      make(at("problems"), "li", {}, `${key ? `${key}: ` : ""}${[problem, remedy].filter(Boolean).join("; ")}`);
    }
  }

  // Shows quantities and checks in one table. Quantities arrive with the scene; the checks arrive later and complete their rows.
  showQuantities(quantities) {
    if (!quantities.length && this.problems.length) return;
    const before = new Map(this.checked.map((check) => [check.id, check]));
    at("quantities").replaceChildren();
    for (const { id, label, text } of quantities) this.addQuantity(id, label, text, before.get(id));
    const known = new Set(quantities.map(({ id }) => id));
    for (const check of this.checked) if (!known.has(check.id)) this.addQuantity(check.id, check.label, check.value, check);
  }

  addQuantity(id, label, value, check) {
    const row = make(at("quantities"), "tr", { "data-id": id, class: check?.state ?? "" });
    make(row, "th", { scope: "row" }, spaced(label));
    make(row, "td", id ? {} : { colspan: 2 }, value);
    if (id) make(row, "td", {}, check?.state ?? "");
    if (!check || check.state === "pass") return;
    const advice = make(make(at("quantities"), "tr"), "td", { colspan: 3, class: "advice" }, check.text);
    const about = Object.entries(check.about);
    if (!about.length) return;
    const opened = make(advice, "details", {});
    make(opened, "summary", {}, "What it means");
    for (const [word, text] of about) make(opened, "p", {}, `${word}: ${text}`);
  }

  showChecks({ checks, candidates, problems }) {
    if (problems.length) { this.showProblems(problems); return; }
    this.checkedText = this.text;
    this.checked = checks;
    document.body.classList.remove("unchecked");
    const failed = checks.filter(({ state }) => state === "fail").length;
    const expected = checks.filter(({ state }) => state === "expected").length;
    const passed = `${checks.length - failed - expected} of ${checks.length} checks pass`;
    at("checks-title").textContent = !checks.length ? "No checks" : [passed, failed && `${failed} fail`, expected && `${expected} fail as expected`].filter(Boolean).join(", ");
    Object.assign(at("badge"), { hidden: !checks.length, textContent: failed ? `${failed} ${failed > 1 ? "checks fail" : "check fails"}` : "Checks pass", className: failed ? "fail" : "pass" });
    this.showQuantities(this.reply.quantities);
    this.showCandidates(candidates);
    document.body.dataset.checked = this.player?.scenes ?? 0;
  }

  // Shows the linkages that a synthesis found as small pictures. A click on a picture chooses the linkage.
  showCandidates(candidates) {
    at("candidates").hidden = candidates.length < 2;
    showPictures(at("candidates"), candidates.map(({ key, value, ...other }) => ({
      ...other, name: other.label, isChosen: this.values[key] === value, act: () => this.step({ set: { [key]: value } }, { stream: key, done: () => this.player.refit() }),
    })));
  }

  showState() {
    at("name").textContent = this.recipe || `new ${this.title || this.kind}`;
    at("dirty").hidden = !this.isDirty;
    if (this.isDirty && this.text !== this.firstText) keep({ id: this.draft, folder: this.folder, recipe: this.recipe, kind: this.kind, title: this.title, text: this.text, base: this.base }, this.offered);
    else forget(this.draft);
    document.title = `${this.isDirty ? "• " : ""}${this.suggested || "geomkin"} – studio`;
  }

  // The name under which it is saved or made, unless another one is given.
  get suggested() { return this.recipe || this.title || this.kind; }

  announce(text) { at("status").textContent = text; }

  // Announces the keys of a handle with their new values in the status line.
  announceChange(label) {
    const handle = this.reply?.handles.find((other) => other.label === label);
    const values = (handle?.keys ?? []).map((key) => `${inWords(key)} ${JSON.stringify(this.values[key] ?? "")}`);
    this.announce(`${label}: ${values.join(", ")}`);
  }

  // --- files --------------------------------------------------------------------------------------------------------

  // Waits until all that was typed is answered; for ever if another recipe is loaded before that.
  async settled() {
    this.close();
    if (this.isGone) this.askAgain();
    await new Promise((resolve) => { this.whenIdle(resolve); });
  }

  // Whether there are values that were refused.
  get isWrong() { return this.problems.length > 0 || document.querySelector("#form [aria-invalid]") !== null; }

  // Whether the studio did not answer the last request.
  get isGone() { return this.problems.some(({ id }) => id === "gone"); }

  // What must be done before a recipe that is wrong is used.
  get advice() { return this.isGone ? this.problems.map(({ problem, remedy }) => `${problem}; ${remedy}`).join() : "correct the marked values first, or undo"; }

  async save(wanted, mark) {
    await this.settled();
    const name = wanted ?? this.recipe, base = mark ?? this.base;
    if (!name) { await this.saveAs(); return; }
    if (this.isWrong) { this.announce(`Not saved: ${this.advice}`); return; }
    const { text, draft } = this;
    try {
      const saved = await post("save", { recipe: name, text, base });
      if (draft !== this.draft) return;
      Object.assign(this, { recipe: name, base: saved.base, seen: saved.base, savedText: text });
      remember(this.folder, name);
      at("conflict").hidden = true;
      if (this.text === text) { this.saved = this.values; this.ask({}); }
      this.showState();
      this.announce(`Saved ${name}.toml`);
    } catch (error) {
      // The recipe that is open by now is another one.
      if (draft !== this.draft) { this.announce(`${name}.toml was not saved: ${error.message}`); if (!error.problems) throw error; }
      else if (error.status === 409) this.showConflict(`${name}.toml is not the file that was opened: it was changed or exists already.`, name);
      else { this.announce(`Not saved: ${error.message}`); if (!error.problems) throw error; }
    }
  }

  async saveAs() {
    const { draft } = this, name = await chooseName(this.suggested);
    if (name && draft === this.draft) await this.save(name, name === this.recipe ? this.base : "");
  }

  // Asks the user which version of a file to keep.
  showConflict(reason, name) {
    this.choose(reason, {
      "Overwrite the file": async () => {
        const { draft } = this, { base } = await post("open", { recipe: name });
        if (draft === this.draft) await this.save(name, base);
      },
      "Load the file": () => this.loadFile(name),
      "Save under another name": () => this.saveAs(),
    });
  }

  // Shows a question with its answers, each a function by its label.
  choose(question, answers) {
    const root = at("conflict");
    root.replaceChildren();
    root.hidden = false;
    make(root, "p", {}, question);
    for (const [label, act] of Object.entries(answers)) {
      make(root, "button", { type: "button" }, label).addEventListener("click", () => { root.hidden = true; act(); });
    }
    root.querySelector("button").focus();
  }

  // Replaces the edited text by that of the file. Undo restores the edited text.
  async loadFile(name) {
    const { draft } = this, { text, base } = await post("open", { recipe: name }), before = this.text;
    if (draft !== this.draft) return;
    this.history.begin(before);
    Object.assign(this, { recipe: name, base, seen: base, text, savedText: text });
    this.history.end(text);
    this.askAnew();
  }

  // Loads the file whenever another program changes it. If there are unsaved changes, it asks the user first.
  async watch() {
    for (;;) {
      // seen: the last mark of the file. The base of unsaved changes stays, so that Save asks.
      const { recipe, seen } = this;
      try {
        if (this.isGone) { await get("start"); this.askAgain(); }
        if (!recipe) { await new Promise((resolve) => { setTimeout(resolve, 500); }); continue; }
        const { base: now } = await get("changed", { recipe, base: seen });
        if (recipe !== this.recipe || seen !== this.seen || now === seen) continue;
        this.seen = now;
        if (!now) { this.announce(`${recipe}.toml was deleted; Save writes it again`); this.savedText = ""; this.showState(); continue; }
        if (this.isDirty) this.showConflict(`${recipe}.toml was changed by another program.`, recipe);
        else { await this.loadFile(recipe); if (recipe === this.recipe) this.announce(`${recipe}.toml was changed by another program and is shown anew`); }
      } catch (error) {
        if (!error.problems) throw error;
        await new Promise((resolve) => { setTimeout(resolve, 1000); });
      }
    }
  }

  async make() {
    await this.settled();
    if (this.isWrong) { this.announce(`No files made: ${this.advice}`); return; }
    const { draft } = this;
    try {
      const { job } = await post("make", { text: this.text, recipe: this.suggested });
      const { state, result } = await this.follow(job);
      if (draft !== this.draft) return;
      if (state === "stopped" || !result) { this.announce("Stopped"); return; }
      if (result.problems.length) { this.showProblems(result.problems); return; }
      at("files-part").hidden = false;
      at("files").replaceChildren();
      for (const { name, bytes, url } of result.files) {
        const item = make(at("files"), "li");
        make(item, "a", { href: url, target: "_blank", rel: "noopener" }, name);
        make(item, "span", {}, ` ${(bytes / 1000).toPrecision(3)} kB`);
      }
      for (const remark of result.remarks ?? []) make(at("files"), "li", {}, String(remark));
      this.announce(`${result.files.length} files made`);
      at("files-part").scrollIntoView({ block: "nearest" });
      return result.files;
    } catch (error) { if (draft === this.draft) this.fail(error); }
  }

  // Makes the files and saves them as one zip.
  async zip() {
    const files = await this.make();
    if (!files?.length) return;
    const name = files[0].url.split("/").at(-2);
    make(document.body, "a", { href: `zip/${name}`, download: `${decodeURIComponent(name)}.zip`, hidden: "" }).click();
  }

  // written(text): what is copied of a recipe's text.
  async copy(written, said) {
    await this.settled();
    try { await navigator.clipboard.writeText(written(this.text)); this.announce(said); } catch { this.announce("The browser does not let this page copy"); }
    at("share").open = false;
  }

  // Shows the progress of a job until it ends. The job is stopped as soon as `isObsolete()` is true.
  async follow(id, isObsolete = () => false) {
    const work = at("work");
    this.job = id;
    work.hidden = false;
    try {
      return await finished(id, ({ share, what, state }) => {
        work.querySelector("progress").value = share ?? 0;
        work.querySelector("span").textContent = what ?? "";
        if (state === "running" && isObsolete()) this.stop();
      });
    } finally { work.hidden = true; this.job = ""; }
  }

  stop() { if (this.job) post("stop", { id: this.job }).catch(() => {}); }

  key(event) {
    if (event.key === "Escape" && this.handles?.held) { this.handles.cancel(); return; }
    if (event.key === "Escape" && !document.querySelector("dialog[open]") && this.tools.cancel()) return;
    if (!(event.ctrlKey || event.metaKey) || event.altKey || document.querySelector("dialog[open]")) return;
    const act = { s: () => this.save(), z: () => this.travel(event.shiftKey ? "redo" : "undo"), y: () => this.travel("redo") }[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }
}

const editor = new Editor();
editor.start().catch((error) => editor.announce(error.message));
