// How close a dance came: its measures beside their targets, and its segments with their letters.
import { button, clockText, element, fill, hear } from "../../player/src/dom.js";

const SEGMENT_S = 4;
const REACH = 3; // a bar shows this many times the tolerance on either side
const LETTER_COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7a7a7a", "#b8a800"];

function number(value, unit) {
  const digits = Math.abs(value) < 10 ? 2 : 1;
  return `${value.toFixed(unit === "s" ? 0 : digits)}${unit ? ` ${unit}` : ""}`;
}

/** A tick or a warning, never by colour alone. */
function sign(isHit, words) {
  const mark = element("span", { role: "img", "aria-label": isHit ? "close enough: " : "off: " }, isHit ? "✓ " : "▲ ");
  return element("span", { class: isHit ? "sk-hit" : "sk-miss" }, mark, words);
}

function short(value) {
  return value.toFixed(Math.abs(value) < 20 ? 1 : 0);
}

export class Outcome {
  constructor(model, player, signal) {
    this.model = model;
    this.player = player;
    this.signal = signal;
    this.measures = element("section", { class: "sk-measures", "aria-label": "How close it came" });
    this.segments = element("section", { class: "sk-segments", "aria-label": "Segments" });
    this.chips = [];
    player.onshow = (time) => this.follow(time);
    hear(model, signal, ["blocks", "found"], () => this.drawMeasures());
    hear(model, signal, ["segments"], () => this.drawSegments());
    this.drawMeasures();
    this.drawSegments();
  }

  drawMeasures() {
    const blocks = this.model.get("blocks");
    if (!blocks.length) return fill(this.measures, []);
    const head = element("h4", { class: "sk-part" }, this.model.get("found") === "preview" ? "How close a quick look comes" : "How close it came");
    const explained = "Band: close enough. Dot: the segments; ring: with the joins. Energies for 73.5 kg.";
    if (blocks.length === 1) {
      fill(this.measures, head, blocks[0].measures.map((each) => this.measure(each)), element("p", { class: "sk-hint" }, explained));
    } else fill(this.measures, head, element("div", { class: "sk-scroll" }, this.table(blocks)), element("p", { class: "sk-hint" }, "Found of asked; energies for 73.5 kg."));
  }

  /** Several blocks: a row each, with what was found and how far it is off. */
  table(blocks) {
    const names = blocks[0].measures.map(({ name, unit }) => name.replace("energy", unit)).slice(1);
    const row = ({ start_s: start, stop_s: stop, measures }) =>
      element(
        "tr",
        {},
        element("th", { scope: "row" }, `${Math.round(start)}–${Math.round(stop)} s`),
        measures.slice(1).map(({ asked, achieved, is_hit: isHit, verdict }) =>
          element(
            "td",
            { title: `${number(asked, "")} asked, ${verdict}` },
            sign(isHit, ""),
            `${short(achieved)} of ${short(asked)}`,
          ),
        ),
      );
    return element(
      "table",
      { class: "sk-table sk-blocks" },
      element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "block"), names.map((name) => element("th", { scope: "col" }, name)))),
      element("tbody", {}, blocks.map(row)),
    );
  }

  measure({ name, unit, asked, tolerance, achieved, shown, is_hit: isHit, verdict }) {
    const reach = REACH * tolerance;
    const place = (value) => `${50 + 50 * Math.min(Math.max((value - asked) / reach, -1), 1)}%`;
    const track = element("div", { class: "sk-track", "aria-hidden": "true" });
    if (reach > 0) {
      const band = element("span", { class: "sk-band" });
      band.style.left = `${50 - 50 / REACH}%`;
      band.style.width = `${100 / REACH}%`;
      const dot = element("span", { class: `sk-pin${isHit ? "" : " sk-pin-off"}` });
      dot.style.left = place(achieved);
      track.append(band, element("span", { class: "sk-target" }), dot);
      if (shown !== null) {
        const ring = element("span", { class: "sk-ring" });
        ring.style.left = place(shown);
        track.append(ring);
      }
    }
    return element(
      "div",
      { class: "sk-measure" },
      element("span", { class: "sk-measure-name" }, name),
      sign(isHit, verdict),
      element("span", { class: "sk-measure-numbers" }, `${number(asked, unit)} asked, ${number(achieved, unit)} found`),
      reach > 0 ? track : [],
    );
  }

  drawSegments() {
    const segments = this.model.get("segments");
    const plain = (letter) => letter.replace("′", ""); // a mirror image has the colour of its original
    const order = [...new Set(segments.map(({ letter }) => plain(letter)))];
    this.chips = segments.map(({ letter, start_s: start, origin, jump_cm: jump }) => {
      const chip = button(letter, {
        class: "sk-chip",
        title: `${origin}${jump === null ? "" : `; joints jump ${jump.toFixed(1)} cm before joining`}`,
        "aria-label": `Segment ${letter} at ${start} s: ${origin}`,
        signal: this.signal,
        onclick: () => this.player.go(Math.round(start * this.player.clock.rate)),
      });
      chip.style.setProperty("--sk-letter", LETTER_COLOURS[order.indexOf(plain(letter)) % LETTER_COLOURS.length]);
      return chip;
    });
    const mirrored = segments.some(({ letter }) => letter !== plain(letter)) ? ", with a ′ its mirror image" : "";
    const words = segments.length
      ? `${segments.length} segments of 4 s, ${order.length} different ones; the same letter is the same movement${mirrored}.`
      : "";
    const row = element("div", { class: "sk-chips" }, this.chips);
    row.style.setProperty("--sk-columns", Math.min(Math.max(segments.length, 1), 16));
    this.follow(this.player.clock.time);
    fill(this.segments, row, element("p", { class: "sk-hint" }, words));
  }

  /** Show which segment plays. */
  follow(time) {
    const now = Math.floor(time / SEGMENT_S + 1e-6);
    this.chips.forEach((chip, place) => chip.setAttribute("aria-current", place === now));
  }
}
