// The blinded rating: one window at a time, two questions, nothing else to see.
import { button, element, fill, hear } from "../../player/src/dom.js";

export class RaterPanel {
  constructor(model, player, signal) {
    this.model = model;
    this.player = player;
    this.signal = signal;
    this.answers = {};
    player.isSpeedFixed = true;
    player.moreKeys.textContent = "1 to 4 answer, Enter saves. The speed stays as danced.";
    this.progress = element("p", { class: "sk-progress", role: "status" });
    this.bar = element("progress", { class: "sk-progress-bar", "aria-label": "Windows rated" });
    this.questions = element("div", { class: "sk-questions" });
    this.status = element("p", { class: "sk-status", role: "status" });
    this.next = button("Save and go on (Enter)", { class: "sk-button sk-next", signal, onclick: () => this.save() });
    this.undoButton = button("Undo the last answer", {
      signal,
      onclick: () => model.send({ deed: "undo" }),
    });
    this.again = button("Play again from the start", { signal, onclick: () => this.replay() });
    const on = (names, act) => hear(model, signal, names, act);
    on(["turn"], () => {
      this.answers = {};
      this.draw();
    });
    on(["done", "total", "can_undo", "status"], () => this.draw());
    this.draw();
  }

  around(picture) {
    return [
      element("div", { class: "sk-controls" }, this.progress, this.bar),
      picture,
      this.questions,
      element("div", { class: "sk-controls" }, this.next, this.again, this.undoButton),
      this.status,
    ];
  }

  get isOver() {
    return this.model.get("done") >= this.model.get("total");
  }

  draw() {
    const done = this.model.get("done");
    const total = this.model.get("total");
    this.progress.textContent = this.isOver ? `All ${total} are rated. Thank you.` : `${done + 1} of ${total}`;
    this.bar.max = total;
    this.bar.value = done;
    this.undoButton.disabled = !this.model.get("can_undo");
    this.again.disabled = this.isOver;
    this.status.textContent = this.model.get("status");
    this.player.element.hidden = this.isOver;
    const held = this.questions.contains(document.activeElement) ? document.activeElement.dataset.key : undefined;
    let key = 0;
    const questions = this.model.get("questions").map(({ name, words, answers }) =>
      element(
        "fieldset",
        { class: "sk-question" },
        element("legend", {}, words),
        answers.map(([value, label]) => {
          key += 1;
          const shown = key;
          return button(`${label} (${shown})`, {
            class: "sk-button sk-answer",
            "aria-pressed": this.answers[name] === value,
            "data-key": shown,
            signal: this.signal,
            onclick: () => this.answer(name, value),
          });
        }),
      ),
    );
    fill(this.questions, this.isOver ? [] : questions);
    this.next.disabled = this.isOver || !this.isComplete;
    if (held) this.questions.querySelector(`[data-key="${Number(held)}"]`)?.focus();
  }

  get isComplete() {
    return this.model.get("questions").every(({ name }) => this.answers[name]);
  }

  answer(name, value) {
    this.answers[name] = value;
    this.draw();
  }

  replay() {
    this.player.go(0);
    this.player.toggle();
  }

  save() {
    if (this.isOver || !this.isComplete || this.next.disabled) return;
    // The turn goes along, so that an impatient second press cannot answer the next window.
    this.model.send({ deed: "answer", turn: this.model.get("turn"), answers: this.answers });
    this.next.disabled = true;
  }

  /** 1 and 2 answer the first question, 3 and 4 the second; Enter saves. */
  key(event) {
    if (this.isOver || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "Enter" && event.target.tagName !== "BUTTON" && event.target.tagName !== "SUMMARY") {
      this.save();
      return true;
    }
    const pairs = this.model
      .get("questions")
      .flatMap(({ name, answers }) => answers.map(([value]) => [name, value]));
    const pair = /^[1-9]$/.test(event.key) ? pairs[Number(event.key) - 1] : undefined;
    if (pair) this.answer(...pair);
    return pair !== undefined;
  }
}
