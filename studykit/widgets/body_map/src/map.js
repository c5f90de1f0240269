// The body map: the figure, and beside it what is asked of the joint that was chosen.
import { button, element, fill, hear } from "../../player/src/dom.js";
import { beyond, speaker, speedText, stateOf, words } from "./body.js";
import { BodyFigure } from "./figure.js";

const STATES = [
  ["free", 1, "Free"],
  ["reduced", 0.5, "Reduced"],
  ["spared", 0, "Spared"],
];

function listed(names) {
  return names.length > 1 ? `${names.slice(0, -1).join(", ")} and ${names.at(-1)}` : names.join("");
}

export class BodyMap {
  constructor(model, signal) {
    this.model = model;
    this.signal = signal;
    this.figure = new BodyFigure(signal, {
      onchoose: (joint) => this.choose(joint),
      oncycle: (joint) => this.cycle(joint),
    });
    this.element = element(
      "section",
      { class: "sk-map", "aria-label": "Joints to spare" },
      element("div", { class: "sk-drawn" }, this.figure.element, this.key()),
      element("div", { class: "sk-asked" }, this.details(), this.summary()),
    );
    hear(model, signal, ["weights", "speed_limits_rad_s", "suggested_speeds_rad_s", "joint_report"], () => this.draw());
    this.joint = "right_elbow";
    this.draw();
  }

  /** What the signs on the joints mean. */
  key() {
    const sign = (state, label) =>
      element("span", { class: "sk-entry" }, element("span", { class: `sk-sign sk-sign-${state}`, "aria-hidden": "true" }), label);
    return element(
      "p",
      { class: "sk-key" },
      sign("free", "free"),
      sign("reduced", "reduced"),
      sign("spared", "spared"),
      sign("limit", "speed limit"),
    );
  }

  details() {
    const { signal } = this;
    this.name = element("legend", { class: "sk-joint-name" });
    this.reaches = element("p", { class: "sk-hint" });
    this.states = STATES.map(([state, weight, label]) =>
      button(label, { signal, "data-state": state, onclick: () => this.weigh(this.joint, weight) }),
    );
    this.weight = element("input", {
      type: "range",
      class: "sk-slider",
      min: 0,
      max: 1,
      step: 0.05,
      "aria-label": "How much the joint may work, from 0, spared, to 1, free",
      signal,
      oninput: () => (this.weightText.textContent = Number(this.weight.value).toFixed(2)),
      onchange: () => this.weigh(this.joint, Number(this.weight.value)),
    });
    this.weightText = element("output", { class: "sk-number-text" });
    this.limit = element("input", {
      type: "number",
      class: "sk-number",
      min: 0.1,
      step: 0.1,
      "aria-label": "Speed limit, rad/s",
      signal,
      onchange: () => this.bound(Number(this.limit.value)),
    });
    this.degrees = element("output");
    this.limitText = element("p", { class: "sk-hint" });
    this.noLimit = button("No limit", { signal, onclick: () => this.bound(0) });
    this.done = element("p", { class: "sk-hint" });
    return element(
      "fieldset",
      { class: "sk-details" },
      this.name,
      this.reaches,
      element("div", { class: "sk-group", role: "group", "aria-label": "How far it is spared" }, this.states),
      element("label", { class: "sk-field sk-scale" }, "may work ", this.weight, this.weightText),
      element(
        "div",
        { class: "sk-controls" },
        element("label", { class: "sk-field" }, "speed limit ", this.limit, " rad/s"),
        this.degrees,
        this.noLimit,
      ),
      this.limitText,
      this.done,
    );
  }

  summary() {
    this.list = element("ul", { class: "sk-chosen", "aria-label": "What is asked for" });
    this.report = element("ul", { class: "sk-chosen", "aria-label": "What the dance asks of the joints" });
    const act = (label, deed) => button(label, { signal: this.signal, onclick: () => this.model.send({ deed }) });
    this.undoButton = act("Undo", "undo");
    this.redoButton = act("Redo", "redo");
    this.resetButton = button("Free all", { signal: this.signal, onclick: () => this.tell({}, {}) });
    this.changes = element("div", { class: "sk-controls" }, this.undoButton, this.redoButton, this.resetButton);
    hear(this.model, this.signal, ["can_undo", "can_redo"], () => this.draw());
    return element("div", {}, this.list, this.changes, this.report);
  }

  get weights() {
    return this.model.get("weights");
  }

  get limits() {
    return this.model.get("speed_limits_rad_s");
  }

  choose(joint) {
    if (joint === this.joint) return;
    this.joint = joint;
    this.draw();
  }

  weightOf(joint, weights = this.weights) {
    const by = speaker(joint, weights);
    return by ? weights[by] : 1;
  }

  /** Free becomes reduced, reduced becomes spared, spared becomes free. */
  cycle(joint) {
    this.figure.choose(joint);
    this.choose(joint);
    const now = STATES.findIndex(([state]) => state === stateOf(this.weightOf(joint)));
    this.weigh(joint, STATES[(now + 1) % STATES.length][1]);
  }

  /** Say how much a joint and all beyond it may work; a joint that is free again loses its limit. */
  weigh(joint, weight) {
    const weights = { ...this.weights };
    const limits = { ...this.limits };
    for (const each of beyond(joint)) delete weights[each];
    delete weights[joint];
    if (this.weightOf(joint, weights) !== weight) weights[joint] = weight;
    if (weight >= 1) for (const each of [joint, ...beyond(joint)]) delete limits[each];
    this.tell(weights, limits);
  }

  /** Say how fast the chosen joint and all beyond it may turn, rad/s; 0 for as fast as it likes. */
  bound(speed) {
    const limits = { ...this.limits };
    for (const each of [this.joint, ...beyond(this.joint)]) delete limits[each];
    if (speed > 0) limits[this.joint] = speed;
    this.tell(this.weights, limits);
  }

  tell(weights, limits) {
    this.model.set("weights", weights);
    this.model.set("speed_limits_rad_s", limits);
    this.model.save_changes();
    this.draw();
  }

  draw() {
    const { weights, limits, joint } = this;
    const report = new Map(this.model.get("joint_report").map((row) => [row.joint, row]));
    this.figure.draw(weights, limits, report);
    this.drawDetails(joint, report.get(joint));
    const chosen = [...new Set([...Object.keys(weights), ...Object.keys(limits)])];
    fill(this.list, chosen.length ? chosen.map((each) => this.row(each)) : element("li", {}, "Every joint is free. Click one on the body."));
    const limited = [...report.values()].filter((row) => row.limit_rad_s !== null);
    fill(this.report, limited.length ? element("li", {}, element("strong", {}, "Fastest turns in this dance")) : [], limited.map((row) => this.verdict(row)));
    this.undoButton.disabled = !this.model.get("can_undo");
    this.redoButton.disabled = !this.model.get("can_redo");
    this.resetButton.disabled = chosen.length === 0;
  }

  drawDetails(joint, done) {
    const weight = this.weightOf(joint);
    const further = beyond(joint).map(words);
    const limitBy = speaker(joint, this.limits);
    const limit = limitBy ? this.limits[limitBy] : undefined;
    this.name.textContent = words(joint).replace(/^./, (first) => first.toUpperCase());
    this.reaches.textContent = further.length ? `and beyond it: ${further.length > 8 ? `${further.length} joints` : listed(further)}` : "nothing lies beyond it";
    for (const each of this.states) each.setAttribute("aria-pressed", each.dataset.state === stateOf(weight));
    this.weight.value = weight;
    this.weightText.textContent = weight.toFixed(2);
    if (document.activeElement !== this.limit) this.limit.value = limit ? Number(limit.toFixed(2)) : "";
    this.limit.placeholder = "none";
    this.noLimit.disabled = limit === undefined;
    this.degrees.textContent = limit === undefined ? "" : `= ${Math.round((limit * 180) / Math.PI)}°/s`;
    this.limitText.textContent = this.limitWords(joint, weight, limitBy);
    this.done.textContent = done ? `This dance: up to ${speedText(done.peak_rad_s)}.` : "";
  }

  limitWords(joint, weight, limitBy) {
    if (limitBy !== undefined) return limitBy === joint ? "" : `The limit is that of the ${words(limitBy)}.`;
    const usual = this.model.get("suggested_speeds_rad_s")[joint];
    if (usual && weight < 1) return `Not set: ${speedText(usual)}, which half of the library's segments keep to.`;
    return weight < 1 ? "A weight asks for little movement; only a limit forbids." : "";
  }

  /** One chosen joint in words, with a way to free it. */
  row(joint) {
    const weight = this.weightOf(joint);
    const limit = this.limits[joint];
    const state = stateOf(weight) === "reduced" ? `reduced to ${weight.toFixed(2)}` : stateOf(weight);
    const further = beyond(joint).length ? " and beyond" : "";
    return element(
      "li",
      {},
      element("span", {}, element("strong", {}, words(joint)), `${further}: ${state}${limit ? `, at most ${speedText(limit)}` : ""}`),
      button("×", { class: "sk-plain", "aria-label": `Free the ${words(joint)}`, title: "Free it", signal: this.signal, onclick: () => this.release(joint) }),
    );
  }

  /** A joint with a limit: how fast it turns in the dance that was found, beside how fast it may. */
  verdict({ joint, peak_rad_s: peak, limit_rad_s: limit, is_within: isWithin }) {
    const bar = element("span", { class: "sk-gauge", "aria-hidden": "true" }, element("span"));
    bar.firstChild.style.width = `${Math.min(100 * (peak / limit), 100)}%`;
    return element(
      "li",
      { class: isWithin ? "" : "sk-over" },
      element("span", { class: "sk-what" }, words(joint)),
      bar,
      element("span", { class: isWithin ? "sk-hit" : "sk-miss" }, `${isWithin ? "✓" : "▲ too fast:"} ${peak.toFixed(1)} of ${limit.toFixed(1)} rad/s`),
    );
  }

  release(joint) {
    const [weights, limits] = [{ ...this.weights }, { ...this.limits }];
    delete weights[joint];
    delete limits[joint];
    this.tell(weights, limits);
  }
}
