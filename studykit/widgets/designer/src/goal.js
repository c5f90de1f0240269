// The settings: sliders with words at their places, schedule, seed, and what to do with them.
import { button, choice, element, fill, hear } from "../../player/src/dom.js";

const PAUSE_MS = 120; // a slider that moves is heard when it rests this long

export class GoalForm {
  constructor(model, signal) {
    this.model = model;
    this.signal = signal;
    this.scales = model.get("scales");
    this.pending = {};
    this.sliders = {
      duration_s: this.slider("duration_s", "Duration", this.scales.step_s, (value) => `${value} s`),
      intensity: this.slider("intensity", "Intensity", 1, (value) => `percentile ${value}`),
      variety: this.slider("variety", "Variety", 0.01, (value) => `${Math.round(100 * value)} %`),
    };
    this.transition = element("input", {
      type: "checkbox",
      signal,
      onchange: () => this.set({ transition: this.transition.checked }),
    });
    this.schedule = choice("Schedule", this.scales.schedules, model.get("schedule"), {
      signal,
      onchange: () => this.set({ schedule: this.schedule.value }),
    });
    this.seed = element("output", { class: "sk-number-text" });
    const ask = (label, deed, more = {}) =>
      button(label, { signal, onclick: () => model.send({ deed }), ...more });
    this.search = ask("Find this dance", "search", { class: "sk-button sk-main" });
    this.undoButton = ask("Undo", "undo");
    this.redoButton = ask("Redo", "redo");
    this.folder = element("input", {
      type: "text",
      class: "sk-note",
      value: "dances",
      "aria-label": "Folder for the files",
    });
    this.save = button("Save", { signal, onclick: () => model.send({ deed: "save", folder: this.folder.value }) });
    this.element = element(
      "section",
      { class: "sk-form", "aria-label": "What the dance shall be like" },
      Object.values(this.sliders).map(({ row }) => row),
      element("label", { class: "sk-field" }, this.transition, "smooth joins"),
      element("label", { class: "sk-ask" }, "Schedule", this.schedule),
      element("div", { class: "sk-field" }, "Seed ", this.seed, ask("Another one", "another")),
      element("div", { class: "sk-controls" }, this.search, this.undoButton, this.redoButton),
      element("div", { class: "sk-controls" }, element("label", { class: "sk-field sk-wide" }, "Folder ", this.folder), this.save),
    );
    hear(
      model,
      signal,
      ["duration_s", "intensity", "variety", "transition", "schedule", "seed", "targets", "found", "is_searching", "can_undo", "can_redo"],
      () => this.draw(),
    );
    signal.addEventListener("abort", () => clearTimeout(this.waiting));
    this.draw();
  }

  slider(name, label, step, text) {
    const [least, most] = this.scales[name];
    const value = element("output", { class: "sk-value" });
    const hint = element("p", { class: "sk-hint" });
    const input = element("input", {
      type: "range",
      class: "sk-slider",
      min: least,
      max: most,
      step,
      "aria-label": label,
      signal: this.signal,
      oninput: () => {
        value.textContent = text(Number(input.value));
        this.soon({ [name]: Number(input.value) });
      },
    });
    const places = (this.scales.words[name] ?? []).map(([at, word]) => {
      const place = button(word, {
        class: "sk-plain sk-place",
        signal: this.signal,
        onclick: () => this.set({ [name]: at }),
      });
      place.style.left = `${(100 * (at - least)) / (most - least)}%`;
      return place;
    });
    const row = element(
      "div",
      { class: "sk-ask" },
      element("div", { class: "sk-ask-head" }, element("span", {}, label), value),
      input,
      places.length ? element("div", { class: "sk-places" }, places) : [],
      hint,
    );
    return { row, input, value, text, hint };
  }

  /** Send values at once. */
  set(values) {
    for (const [name, value] of Object.entries(values)) this.model.set(name, value);
    this.model.save_changes();
  }

  /** Send values when the slider rests. */
  soon(values) {
    Object.assign(this.pending, values);
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      const { pending } = this;
      this.pending = {};
      this.set(pending);
    }, PAUSE_MS);
  }

  draw() {
    const { model } = this;
    const targets = model.get("targets");
    const fixed = this.scales.fixed[model.get("schedule")] ?? {};
    for (const [name, { input, value, text, hint }] of Object.entries(this.sliders)) {
      if (name in this.pending) continue; // the hand is still on it
      const now = Number(model.get(name));
      input.disabled = name in fixed;
      if (input.disabled) {
        value.textContent = fixed[name];
        continue;
      }
      input.value = now;
      const words = text(Number(now.toFixed(2)));
      value.textContent = words;
      input.setAttribute("aria-valuetext", words);
      hint.textContent = targets[name] ?? "";
    }
    this.transition.checked = model.get("transition");
    this.schedule.value = model.get("schedule");
    this.seed.textContent = model.get("seed");
    const isSearching = model.get("is_searching");
    fill(this.search, isSearching ? "Searching …" : "Find this dance");
    this.search.disabled = isSearching || model.get("found") === "";
    this.save.disabled = model.get("found") !== "dance";
    this.save.title = this.save.disabled ? "Find the dance first" : "Write it as npz, bvh, glb and json";
    this.undoButton.disabled = !model.get("can_undo");
    this.redoButton.disabled = !model.get("can_redo");
  }
}
