// The joint picker: a body map by itself.
import { BodyMap } from "./map.js";

export class BodyMapPanel {
  constructor(model, _, signal) {
    this.model = model;
    this.map = new BodyMap(model, signal);
  }

  around() {
    return this.map.element;
  }

  /** Ctrl+Z takes back, with Shift (or Ctrl+Y) makes again. */
  key(event) {
    if (!event.ctrlKey && !event.metaKey) return false;
    const deed = { z: event.shiftKey ? "redo" : "undo", y: "redo" }[event.key.toLowerCase()];
    if (deed) this.model.send({ deed });
    return deed !== undefined;
  }
}
