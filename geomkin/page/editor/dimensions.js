// Dimensions of the drawing: a click on the number of a length opens a field in which another one is typed.
import { amount } from "./form.js";
import { make, px } from "../player/shapes.js";

export class Dimensions {
  // editor: reply with `dimensions`, setLength(dimension, length), announce(text).
  constructor(drawing, editor) {
    Object.assign(this, { drawing, editor });
    drawing.names.addEventListener("pointerdown", (event) => {
      const { dimension: number } = event.target.dataset, dimension = this.editor.reply.dimensions[number];
      if (!dimension || event.button) return;
      // The drawing would take the pointer.
      event.stopPropagation();
      event.preventDefault();
      this.open(event.target, dimension);
    });
  }

  open(shape, dimension) {
    const { drawing, editor } = this, [box, around] = [shape, drawing.svg.parentNode].map((element) => element.getBoundingClientRect());
    const at = [box.left - around.left + box.width / 2, box.top - around.top + box.height / 2];
    lengthField(drawing, at, shape.textContent, (length, isChanged) => {
      if (!isChanged) return;
      if (length > 0) editor.setLength(dimension, length);
      else editor.announce("This is no length; type one, such as 12.5, 2*15 or 1/4 in");
    });
  }
}

// A field at a place of the stage, px, for a length in the unit of the drawing. take(length, isChanged) is called once; the length
// is undefined if what is typed is none, or after Escape.
export function lengthField(drawing, [x, y], value, take) {
  const [unit] = drawing.data.unit ?? ["mm"];
  const field = make(drawing.svg.parentNode, "input", { class: "length", type: "text", spellcheck: "false", "aria-label": `Length, ${unit}`, value });
  Object.assign(field.style, { left: `${px(x)}px`, top: `${px(y)}px` });
  let isOpen = true;
  const close = (isTaken) => {
    if (!isOpen) return;
    isOpen = false;
    field.remove();
    take(isTaken ? amount(field.value, unit) : undefined, isTaken && field.value !== value);
  };
  field.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter" || event.key === "Escape") close(event.key === "Enter");
  });
  field.addEventListener("blur", () => close(true));
  field.focus();
  field.select();
}
