// Undo and redo of texts: a drag, or a field typed in, is one step.

// Steps that are remembered.
const MOST = 200;

export class History {
  // changed(undo, redo): hears whether there are steps to undo and to redo.
  constructor(changed) {
    Object.assign(this, { changed, before: [], after: [], begun: null });
  }

  clear() {
    Object.assign(this, { before: [], after: [], begun: null });
    this.changed(false, false);
  }

  // A step begins at this text, unless one has begun.
  begin(text) { this.begun ??= text; }

  // The step ends at this text: whether it changed anything. `goesOn`: it belongs to the step before it.
  end(text, goesOn = false) {
    const { begun } = this;
    this.begun = null;
    if (begun === null || begun === text) return false;
    if (!goesOn || !this.before.length) this.before.push(begun);
    this.before.splice(0, this.before.length - MOST);
    this.after = [];
    this.changed(true, false);
    return true;
  }

  undo(text) { return this.travel(text, this.before, this.after); }

  redo(text) { return this.travel(text, this.after, this.before); }

  travel(text, from, to) {
    if (!from.length) return null;
    to.push(text);
    const other = from.pop();
    this.changed(this.before.length > 0, this.after.length > 0);
    return other;
  }
}
