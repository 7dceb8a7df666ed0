// Undo and redo of texts. One drag is one step, and so is all typing in one field.

// Largest number of steps that can be undone.
const MOST = 200;

export class History {
  // changed(canUndo, canRedo) is called after every change of the history.
  constructor(changed) {
    Object.assign(this, { changed, before: [], after: [], begun: null });
  }

  clear() {
    Object.assign(this, { before: [], after: [], begun: null });
    this.changed(false, false);
  }

  // Begins a step at this text, unless a step has already begun.
  begin(text) {
    this.begun ??= text;
    this.changed(true, this.after.length > 0);
  }

  // Ends the step at this text and returns whether the text changed. If `isContinued`, it is merged with the step before it.
  end(text, isContinued = false) {
    const { begun } = this;
    this.begun = null;
    if (begun === null || begun === text) {
      this.changed(this.before.length > 0, this.after.length > 0);
      return false;
    }
    if (!isContinued || !this.before.length) this.before.push(begun);
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
