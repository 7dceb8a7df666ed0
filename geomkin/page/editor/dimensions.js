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
    const { drawing } = this, [unit] = drawing.data.unit ?? ["mm"], stage = drawing.svg.parentNode;
    const [box, around] = [shape, stage].map((element) => element.getBoundingClientRect());
    const field = make(stage, "input", { class: "length", type: "text", spellcheck: "false", "aria-label": `Length, ${unit}`, value: shape.textContent });
    Object.assign(field.style, { left: `${px(box.left - around.left + box.width / 2)}px`, top: `${px(box.top - around.top + box.height / 2)}px` });
    const before = field.value;
    let isOpen = true;
    const close = (isTaken) => {
      if (!isOpen) return;
      isOpen = false;
      const { value } = field, length = amount(value, unit);
      field.remove();
      if (!isTaken || value === before) return;
      if (length > 0) this.editor.setLength(dimension, length);
      else this.editor.announce("This is no length; type one, such as 12.5, 2*15 or 1/4 in");
    };
    field.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter" || event.key === "Escape") close(event.key === "Enter");
    });
    field.addEventListener("blur", () => close(true));
    field.focus();
    field.select();
  }
}
