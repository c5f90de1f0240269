// The review: the takes, the stretches of one take, and what was decided.
import { button, choice, clockText, element, fill, hear } from "../../player/src/dom.js";

const WORDS = { "": "open", keep: "kept", cut: "cut" };

export class ReviewerPanel {
  constructor(model, player, signal) {
    this.model = model;
    this.player = player;
    this.signal = signal;
    this.from = null;
    this.to = null;
    player.moreKeys.textContent = "N and P go to the next and previous stretch, K keeps it, C cuts it.";
    this.head = element("div", { class: "sk-controls", role: "group", "aria-label": "Take" });
    this.list = element("ol", { class: "sk-stretches", "aria-label": "Flagged stretches of this take" });
    this.decided = element("ol", { class: "sk-stretches", "aria-label": "Decisions so far" });
    this.decidedCount = element("summary");
    this.status = element("p", { class: "sk-status", role: "status" });
    this.remark = element("input", {
      type: "text",
      class: "sk-note",
      maxlength: 500,
      placeholder: "why (optional)",
      "aria-label": "Note to the decision",
    });
    this.own = element("div", { class: "sk-controls", role: "group", "aria-label": "Cut a stretch of your own" });
    this.undoButton = this.act("Undo", () => this.ask({ deed: "undo" }));
    const on = (names, act) => hear(model, signal, names, act);
    on(["takes", "take"], () => this.drawHead());
    on(["take"], () => {
      this.from = this.to = null;
      this.drawOwn();
    });
    on(["stretches", "chosen"], () => this.drawStretches());
    on(["decisions", "can_undo"], () => this.drawDecisions());
    on(["status"], () => (this.status.textContent = model.get("status")));
    this.drawHead();
    this.drawStretches();
    this.drawDecisions();
    this.drawOwn();
    this.status.textContent = model.get("status");
  }

  act(words, onclick, more = {}) {
    return button(words, { signal: this.signal, onclick, ...more });
  }

  ask(message) {
    this.model.send(message);
  }

  around(picture) {
    const note = element("label", { class: "sk-field sk-wide" }, "Note ", this.remark);
    return [
      this.head,
      picture,
      this.own,
      element("div", { class: "sk-controls" }, note, this.undoButton),
      this.status,
      this.list,
      element("details", { class: "sk-decided" }, this.decidedCount, this.decided),
    ];
  }

  drawHead() {
    const takes = this.model.get("takes");
    const take = this.model.get("take");
    const pairs = takes.map(({ name, open, total }) => [name, `${name} (${open} of ${total} open)`]);
    const list = choice("Take", pairs, take, {
      signal: this.signal,
      onchange: () => this.ask({ deed: "take", take: list.value }),
    });
    const place = takes.findIndex(({ name }) => name === take);
    const other = (words, found) =>
      this.act(words, () => this.ask({ deed: "take", take: found.name }), { disabled: !found });
    fill(
      this.head,
      element("label", { class: "sk-field" }, "Take ", list),
      other("Take before", takes[place - 1]),
      other("Take after", takes[place + 1]),
      other("Next with open stretches", [...takes.slice(place + 1), ...takes.slice(0, place)].find(({ open }) => open > 0)),
    );
  }

  drawStretches() {
    const stretches = this.model.get("stretches");
    const chosen = this.model.get("chosen");
    const held = this.list.contains(document.activeElement) ? document.activeElement.dataset.place : undefined;
    const items = stretches.map((stretch, place) => {
      const decide = (decision) => {
        this.ask({ deed: "decide", ...this.limits(stretch), decision, note: this.remark.value });
        this.remark.value = "";
      };
      return element(
        "li",
        { class: `sk-stretch sk-is-${stretch.decision || "open"}`, "aria-current": place === chosen },
        this.act(`${clockText(stretch.start_s)} – ${clockText(stretch.stop_s)}`, () => this.jump(place), {
          class: "sk-button sk-jump",
          "data-place": `jump ${place}`,
        }),
        element("span", { class: "sk-what" }, stretch.words),
        this.act("Keep", () => decide("keep"), {
          "aria-pressed": stretch.decision === "keep",
          "data-place": `keep ${place}`,
        }),
        this.act("Cut", () => decide("cut"), {
          "aria-pressed": stretch.decision === "cut",
          "data-place": `cut ${place}`,
        }),
        element("span", { class: "sk-verdict" }, WORDS[stretch.decision] + (stretch.note ? `: ${stretch.note}` : "")),
      );
    });
    fill(this.list, items.length ? items : element("li", {}, "Nothing was flagged in this take."));
    if (held) [...this.list.querySelectorAll("button")].find((each) => each.dataset.place === held)?.focus();
  }

  limits({ start_s, stop_s }) {
    return { start_s, stop_s };
  }

  jump(place) {
    const stretch = this.model.get("stretches")[place];
    if (!stretch) return;
    this.player.tell({ chosen: place });
    this.player.go(Math.round(stretch.start_s * this.player.clock.rate));
  }

  drawOwn() {
    const now = () => this.player.clock.frame / this.player.clock.rate;
    const isReady = this.from !== null && this.to !== null && this.to > this.from;
    const say = (time) => (time === null ? "–" : clockText(time));
    fill(
      this.own,
      element("span", { class: "sk-field" }, "A stretch of your own:"),
      this.act(`from here (${say(this.from)})`, () => {
        this.from = now();
        this.drawOwn();
      }),
      this.act(`to here (${say(this.to)})`, () => {
        this.to = now();
        this.drawOwn();
      }),
      this.act(
        "Cut it",
        () => {
          this.ask({ deed: "decide", start_s: this.from, stop_s: this.to, decision: "cut", note: this.remark.value });
          this.remark.value = "";
          this.from = this.to = null;
          this.drawOwn();
        },
        { disabled: !isReady },
      ),
    );
  }

  drawDecisions() {
    const decisions = this.model.get("decisions");
    this.undoButton.disabled = !this.model.get("can_undo");
    this.decidedCount.textContent = `Decisions so far: ${this.model.get("decided")}`;
    fill(this.decided, decisions.map((words) => element("li", {}, words)));
  }

  /** N and P go from stretch to stretch; K keeps and C cuts the one that is chosen. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target === this.remark) return false;
    if (event.target.tagName === "SELECT") return false;
    const chosen = this.model.get("chosen");
    const deeds = { n: () => this.jump(chosen + 1), p: () => this.jump(chosen - 1) };
    const stretch = this.model.get("stretches")[chosen];
    if (stretch) {
      const decide = (decision) => {
        this.ask({ deed: "decide", ...this.limits(stretch), decision, note: this.remark.value });
        this.remark.value = "";
      };
      deeds.k = () => decide("keep");
      deeds.c = () => decide("cut");
    }
    const deed = deeds[event.key.toLowerCase()];
    deed?.();
    return deed !== undefined;
  }
}
