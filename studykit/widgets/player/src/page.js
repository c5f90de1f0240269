// What a page of dances calls: one player, which moves to the dance that is chosen. Needs no notebook.
import styles from "../../style.css";
import { element } from "./dom.js";
import { Player } from "./player.js";

const MANY = 20; // segments are more than one row holds
const GAP_S = 0.1; // so that neighbours on the line of time can be told apart

/** Values that can be listened to, as a widget's model has them in a notebook. */
class Values {
  constructor(values) {
    this.values = values;
    this.listeners = {};
  }

  get(name) {
    return this.values[name];
  }

  set(name, value) {
    if (this.values[name] === value) return;
    this.values[name] = value;
    for (const act of [...(this.listeners[`change:${name}`] ?? [])]) act();
  }

  save_changes() {}

  on(change, act) {
    (this.listeners[change] ??= []).push(act);
  }

  off(change, act) {
    this.listeners[change] = (this.listeners[change] ?? []).filter((each) => each !== act);
  }
}

/** Undo base64: the bytes of little-endian 32-bit numbers. */
function bytes(text) {
  return new DataView(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
}

/** The segments as buttons, each in the place of its time. */
class Segments {
  constructor(player, segments) {
    this.segments = segments;
    this.chips = segments.map(({ letter, colour, start_s: start, words }) => {
      const go = () => player.go(Math.round(start * player.clock.rate));
      const chip = element(
        "button",
        { type: "button", class: "sk-chip", title: words, "aria-label": `Segment ${letter}: ${words}`, onclick: go },
        letter,
      );
      chip.style.setProperty("--sk-letter", colour);
      return chip;
    });
    this.element = element("div", { class: `sk-chips${segments.length > MANY ? " sk-many" : ""}` }, this.chips);
    this.element.style.setProperty("--sk-columns", segments.length);
  }

  at(time) {
    const now = this.segments.findLastIndex(({ start_s: start }) => start <= time + 1e-6);
    this.chips.forEach((chip, place) => chip.setAttribute("aria-current", place === now));
  }
}

function begin() {
  document.head.prepend(element("style", {}, styles)); // before the page's own
  const { body, dances } = JSON.parse(document.getElementById("dances").textContent);
  const sections = [...document.querySelectorAll("[data-dance]")];
  const tabs = [...document.querySelectorAll("[data-tab]")];
  const model = new Values({
    ...body,
    ghost: null,
    ghost_name: "",
    joint_values: [],
    joint_values_label: "",
    time_s: 0,
    is_playing: false,
    speed: 1,
    is_looping: true,
    is_mirrored: false,
    title: "",
    is_synthetic: false,
    spared: [],
    positions: null,
    frame_rate_hz: 30,
    marks: [],
  });
  const player = new Player(model, new AbortController().signal);
  let segments;
  player.onshow = (time) => segments?.at(time);
  // Space plays from wherever nothing else wants it; other keys are the player's once it was clicked.
  document.addEventListener("keydown", (event) => {
    const isForPlayer = room.contains(event.target) || (event.key === " " && !event.shiftKey);
    if (isForPlayer && player.key(event)) event.preventDefault();
  });
  const room = element("div", { class: "sk-widget" });

  function choose(number) {
    sections.forEach((section, place) => (section.hidden = place !== number));
    tabs.forEach((tab) => tab.setAttribute("aria-current", Number(tab.dataset.tab) === number));
    const { positions, ...values } = dances[number];
    segments = new Segments(player, values.segments);
    room.replaceChildren(player.element, segments.element);
    sections[number].querySelector("[data-player]").replaceChildren(room);
    model.set("is_playing", false);
    model.set("time_s", 0);
    for (const name of ["is_synthetic", "frame_rate_hz", "spared"]) model.set(name, values[name]);
    model.set(
      "marks",
      values.segments.map(({ letter, start_s, stop_s, words }) => [start_s, stop_s - GAP_S, `${letter}: ${words}`, "note"]),
    );
    model.set("positions", bytes(positions));
    queueMicrotask(() => segments.at(0));
  }

  /** Choose the dance that the address names, or that holds the place that it names. */
  function heed() {
    const place = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const named = sections.indexOf(place?.closest("[data-dance]"));
    if (named < 0 && room.isConnected) return;
    choose(Math.max(named, 0));
    if (named >= 0) place.scrollIntoView();
  }

  addEventListener("hashchange", heed);
  heed();
}

begin();
