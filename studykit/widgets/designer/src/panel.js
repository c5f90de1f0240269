// The dance designer: what is asked for, how close a dance came, and the dance itself.
import { BodyMap } from "../../body_map/src/map.js";
import { button, element, fill, hear } from "../../player/src/dom.js";
import { GoalForm } from "./goal.js";
import { Outcome } from "./outcome.js";

export class DesignerPanel {
  constructor(model, player, signal) {
    this.model = model;
    this.player = player;
    this.signal = signal;
    player.moreKeys.textContent = "Ctrl+Z takes a change back, Ctrl+Shift+Z makes it again.";
    this.form = new GoalForm(model, signal);
    this.outcome = new Outcome(model, player, signal);
    this.map = new BodyMap(model, signal);
    this.map.changes.hidden = true; // one undo for everything
    this.status = element("p", { class: "sk-status", role: "status" });
    this.echo = element("span", { class: "sk-count", "aria-hidden": "true" }); // beside the map, far below the first
    this.obstacle = element("div", { class: "sk-obstacle", role: "alert" });
    hear(model, signal, ["status", "is_searching"], () => this.say());
    hear(model, signal, ["obstacle"], () => this.drawObstacle());
    this.say();
    this.drawObstacle();
  }

  around(picture) {
    const name = element("span", { class: "sk-library" }, this.model.get("library_name"));
    return [
      element("header", { class: "sk-head" }, element("h3", { class: "sk-title" }, "Design a dance"), name),
      element(
        "div",
        { class: "sk-design" },
        element("div", { class: "sk-left" }, this.form.element, this.status, this.obstacle, this.outcome.measures),
        element("div", { class: "sk-right" }, picture, this.outcome.segments),
      ),
      element("div", { class: "sk-head" }, element("h4", { class: "sk-part" }, "Joints to spare"), this.echo),
      this.map.element,
    ];
  }

  say() {
    this.status.textContent = this.model.get("is_searching") ? "Searching …" : this.model.get("status");
    this.echo.textContent = this.status.textContent;
  }

  drawObstacle() {
    const { sentence, has_offer: hasOffer } = this.model.get("obstacle");
    this.obstacle.hidden = !sentence;
    if (!sentence) return;
    const use = button("Use these", { signal: this.signal, onclick: () => this.model.send({ deed: "nearest" }) });
    fill(
      this.obstacle,
      element("p", {}, element("strong", {}, hasOffer ? "Out of reach. " : "Not possible. "), sentence),
      hasOffer ? element("p", {}, "Ask for the nearest values instead: ", use) : [],
    );
  }

  /** The settings and the body map keep their keys for themselves. */
  keeps(target) {
    return !this.player.element.contains(target);
  }

  key(event) {
    if (!event.ctrlKey && !event.metaKey) return false;
    const deed = { z: event.shiftKey ? "redo" : "undo", y: "redo" }[event.key.toLowerCase()];
    if (deed) this.model.send({ deed });
    return deed !== undefined;
  }
}
