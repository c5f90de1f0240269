// The player: a stage, a line of time and the buttons. It plays on the browser's own clock.
import { GHOST, SIDES, SPARED, css, gradient } from "./colours.js";
import { PlayClock } from "./clock.js";
import { button, choice, clockText, element, fill, hear, isTyping } from "./dom.js";
import { Stage } from "./stage.js";
import { Timeline } from "./timeline.js";

const SPEEDS = [0.25, 0.5, 0.75, 1, 1.25, 1.5, 2];
const MOVING = ["positions", "ghost", "frame_rate_hz", "joint_values", "marks", "ghost_name", "joint_values_label"];
const KEYS =
  "Space plays and pauses, the arrows step one frame, Home and End go to the ends, [ and ] go to the marks, " +
  "- and + change the speed, L loops, M mirrors, F follows, R resets the view, Shift with the arrows turns the view. ";

/** Read little-endian 32-bit numbers; the copy makes them start where the browser wants it. */
function floats(view) {
  if (!view || !view.byteLength) return new Float32Array(0);
  const numbers = new Float32Array(view.byteLength / 4);
  const bytes = new DataView(view.buffer, view.byteOffset, view.byteLength);
  for (let k = 0; k < numbers.length; k += 1) numbers[k] = bytes.getFloat32(4 * k, true);
  return numbers;
}

/** The middle of the floor that motions cover, and how far they go from there, m. */
function extentOf(motions, stride) {
  let [left, right, back, front] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const positions of motions) {
    for (let k = 0; k < positions.length; k += stride) {
      left = Math.min(left, positions[k]);
      right = Math.max(right, positions[k]);
      back = Math.min(back, positions[k + 2]);
      front = Math.max(front, positions[k + 2]);
    }
  }
  if (left > right) return { x: 0, z: 0, reach: 1 };
  return { x: (left + right) / 2, z: (back + front) / 2, reach: Math.max(right - left, front - back) / 2 + 0.6 };
}

export class Player {
  constructor(model, signal) {
    this.model = model;
    this.signal = signal;
    this.clock = new PlayClock();
    this.stage = new Stage(signal);
    this.timeline = new Timeline(signal, (frame) => this.go(frame));
    this.title = element("h3", { class: "sk-title" });
    this.badge = element("strong", { class: "sk-badge" }, "SYNTHETIC: nobody danced this");
    this.legend = element("div", { class: "sk-legend" });
    this.readout = element("span", { class: "sk-readout" });
    this.here = element("div", { class: "sk-here", role: "status" });
    this.element = element(
      "section",
      { class: "sk-player", "aria-label": "Motion player" },
      element("header", { class: "sk-head" }, this.title, this.badge),
      element("div", { class: "sk-picture" }, this.stage.element, this.legend),
      this.timeline.element,
      this.controls(),
      this.here,
    );
    this.listen();
    this.load();
    this.dress();
    this.settle();
    signal.addEventListener("abort", () => cancelAnimationFrame(this.ticking));
  }

  controls() {
    const { signal } = this;
    this.moreKeys = element("span"); // of the panel around the player
    const act = (words, label, onclick, more = {}) =>
      button(words, { "aria-label": label, title: label, signal, onclick, ...more });
    this.playButton = act("▶", "Play", () => this.toggle(), { class: "sk-button sk-play" });
    this.loopButton = act("Loop", "Play again and again", () => this.tell({ is_looping: !this.clock.isLooping }));
    this.mirrorButton = act(
      "Mirror",
      "See it as in a mirror, to dance along",
      () => this.tell({ is_mirrored: !this.model.get("is_mirrored") }),
      { class: "sk-button sk-mirror" },
    );
    this.followButton = act("Follow", "Keep the camera beside the figure", () => this.followFigure());
    this.speed = choice("Speed", SPEEDS.map((speed) => [speed, `${speed}×`]), 1, {
      signal,
      onchange: () => this.tell({ speed: Number(this.speed.value) }),
    });
    this.markButtons = element(
      "span",
      { class: "sk-group" },
      act("⟨ mark", "Previous mark", () => this.toMark(-1)),
      act("mark ⟩", "Next mark", () => this.toMark(1)),
    );
    return element(
      "div",
      { class: "sk-controls", role: "group", "aria-label": "Playing" },
      this.playButton,
      act("−1", "One frame back", () => this.step(-1)),
      act("+1", "One frame on", () => this.step(1)),
      this.readout,
      this.markButtons,
      element("label", { class: "sk-field sk-speed" }, "Speed ", this.speed),
      this.loopButton,
      this.mirrorButton,
      this.followButton,
      act("Reset view", "See all of it from the front", () => this.stage.resetView()),
      element("details", { class: "sk-keys" }, element("summary", {}, "Keys"), KEYS, this.moreKeys),
    );
  }

  listen() {
    const on = (names, act) => hear(this.model, this.signal, names, act);
    // Several values may change at once: they are read together, after the last.
    const soon = () => {
      if (this.isLoading) return;
      this.isLoading = true;
      queueMicrotask(() => {
        this.isLoading = false;
        if (!this.signal.aborted) this.load();
      });
    };
    on(MOVING, soon);
    on(["title", "is_synthetic"], () => this.dress());
    on(["speed", "is_looping", "is_playing"], () => this.settle());
    on(["is_mirrored"], () => {
      this.settle();
      this.show();
    });
    on(["time_s"], () => this.heed());
  }

  /** Send values to Python. */
  tell(values) {
    for (const [name, value] of Object.entries(values)) this.model.set(name, value);
    this.model.save_changes();
  }

  tellTime() {
    this.told = this.clock.time;
    this.tell({ time_s: this.clock.time });
  }

  /** Go where Python says, unless that is only the echo of what was said here. */
  heed() {
    const time = this.model.get("time_s");
    if (Math.abs(time - (this.told ?? -1)) < 1e-9) return;
    this.told = time;
    this.clock.seek(time);
    this.show();
  }

  load() {
    const { model, clock } = this;
    const parents = model.get("parents");
    this.spared = model.get("spared") ?? [];
    const body = { parents, sides: model.get("sides"), headJoint: model.get("head_joint"), spared: this.spared };
    const view = model.get("positions");
    const isNew = view !== this.view;
    this.view = view;
    this.stride = 3 * parents.length;
    this.positions = floats(view);
    this.ghost = floats(model.get("ghost"));
    clock.frames = Math.max(this.positions.length / this.stride, 1);
    clock.rate = model.get("frame_rate_hz");
    this.marks = model.get("marks");
    const values = model.get("joint_values");
    if (isNew) {
      this.extent = extentOf([this.positions, this.ghost], this.stride);
      clock.time = 0;
      this.stage.isFollowing = this.extent.reach > 3;
    }
    const figures = this.positions.length ? [{ body, values, isGhost: false }] : [];
    if (this.ghost.length) figures.push({ body, values: [], isGhost: true });
    if (isNew || this.ghost.length > 0 !== this.hadGhost) this.stage.show(figures, this.extent);
    else this.stage.figures[0]?.colour(values);
    this.hadGhost = this.ghost.length > 0;
    this.timeline.show(this.marks, clock.duration, clock.frames);
    this.markButtons.hidden = this.marks.length === 0;
    this.drawLegend(values);
    clock.seek(isNew ? model.get("time_s") : clock.time);
    this.settle();
    this.show();
  }

  drawLegend(values) {
    const entry = (colour, words) => {
      const dot = element("span", { class: "sk-dot", "aria-hidden": "true" });
      dot.style.background = css(colour);
      return element("span", { class: "sk-entry" }, dot, words);
    };
    const entries = [entry(SIDES.left, "dancer's left"), entry(SIDES.right, "dancer's right")];
    if (this.spared.some(Boolean)) entries.push(entry(SPARED, "spared"));
    if (this.ghost.length) entries.push(entry(GHOST, this.model.get("ghost_name")));
    if (values.length) {
      const bar = element("span", { class: "sk-bar", "aria-hidden": "true" });
      bar.style.background = gradient;
      const most = Number(Math.max(...values).toPrecision(3));
      entries.push(
        element(
          "span",
          { class: "sk-entry" },
          `joints: ${this.model.get("joint_values_label")} 0 `,
          bar,
          ` ${most}`,
        ),
      );
    }
    fill(this.legend, entries);
  }

  dress() {
    const title = this.model.get("title");
    this.title.textContent = title;
    this.title.hidden = title === "";
    this.badge.hidden = !this.model.get("is_synthetic");
  }

  /** Take over speed, looping and playing from the model. */
  settle() {
    const { clock, model } = this;
    clock.speed = model.get("speed");
    clock.isLooping = model.get("is_looping");
    const isPlaying = model.get("is_playing") && this.positions.length > 0;
    this.speed.value = clock.speed;
    this.loopButton.setAttribute("aria-pressed", clock.isLooping);
    this.mirrorButton.setAttribute("aria-pressed", model.get("is_mirrored"));
    this.followButton.setAttribute("aria-pressed", this.stage.isFollowing);
    if (isPlaying && !clock.isPlaying) {
      if (clock.frame >= clock.frames - 1) clock.seek(0);
      this.last = undefined;
      this.ticking = requestAnimationFrame((now) => this.tick(now));
    }
    clock.isPlaying = isPlaying;
    fill(this.playButton, isPlaying ? "❚❚" : "▶");
    this.playButton.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
    this.playButton.title = isPlaying ? "Pause" : "Play";
  }

  tick(now) {
    if (!this.clock.isPlaying || this.signal.aborted) return;
    const passed = this.last === undefined ? 0 : (now - this.last) / 1000;
    this.last = now;
    const hasEnded = this.clock.advance(passed);
    this.show();
    if (hasEnded) {
      this.tell({ is_playing: false });
      this.tellTime();
      this.onended?.();
      return;
    }
    this.ticking = requestAnimationFrame((next) => this.tick(next));
  }

  /** Draw the frame of now. */
  show() {
    const { clock, stride } = this;
    const { frame } = clock;
    const isMirrored = this.model.get("is_mirrored");
    const now = { frame, positions: this.positions, ghost: this.ghost, isMirrored };
    if (this.shown && Object.keys(now).every((each) => now[each] === this.shown[each])) return;
    this.shown = now;
    const mirror = isMirrored ? 2 * this.extent.x : undefined;
    const [figure, second] = this.stage.figures;
    figure?.pose(this.positions, frame * stride, mirror);
    if (second) second.pose(this.ghost, Math.min(frame, this.ghost.length / stride - 1) * stride, mirror);
    const across = this.positions[frame * stride];
    this.stage.follow([isMirrored ? mirror - across : across, this.positions[frame * stride + 2]]);
    this.stage.draw();
    const of = this.positions.length ? clock.frames : 0;
    const text = `${clockText(frame / clock.rate)} of ${clockText(of / clock.rate)}, frame ${of ? frame + 1 : 0} of ${of}`;
    this.readout.textContent = text;
    this.timeline.at(frame, text);
    const time = frame / clock.rate;
    const met = this.marks.filter(([start, stop]) => time >= start - 1e-6 && time <= stop);
    const words = met.map(([, , label]) => label).join("; ");
    if (words !== this.here.textContent) this.here.textContent = words;
    this.element.dataset.frame = frame;
    this.onshow?.(time);
  }

  toggle() {
    this.tell({ is_playing: !this.clock.isPlaying });
    this.settle();
    if (!this.clock.isPlaying) this.tellTime();
  }

  /** Show one frame and stay there. */
  go(frame) {
    this.clock.seekFrame(frame);
    if (this.clock.isPlaying) this.tell({ is_playing: false });
    this.settle();
    this.show();
    this.tellTime();
  }

  step(by) {
    this.go(this.clock.frame + by);
  }

  /** Go to the start of the next mark, or of the one before. */
  toMark(by) {
    const time = this.clock.frame / this.clock.rate;
    const starts = this.marks.map(([start]) => start).sort((a, b) => a - b);
    const beyond = 0.5 / this.clock.rate;
    const start =
      by > 0 ? starts.find((each) => each > time + beyond) : starts.findLast((each) => each < time - beyond);
    if (start !== undefined) this.go(Math.round(start * this.clock.rate));
  }

  followFigure() {
    this.stage.isFollowing = !this.stage.isFollowing;
    this.shown = undefined;
    this.settle();
    this.show();
  }

  changeSpeed(by) {
    const place = SPEEDS.indexOf(this.clock.speed) + by;
    if (this.isSpeedFixed) return;
    if (place >= 0 && place < SPEEDS.length) this.tell({ speed: SPEEDS[place] });
  }

  /** Act on a key; gives whether it meant something. */
  key(event) {
    if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.shiftKey && event.key.startsWith("Arrow")) {
      const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
      this.stage.turn(...turns[event.key]);
      return true;
    }
    if (event.key === " " && ["BUTTON", "SUMMARY"].includes(event.target.tagName)) return false;
    const deeds = {
      " ": () => event.repeat || this.toggle(), // not again while it is held down
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      Home: () => this.go(0),
      End: () => this.go(this.clock.frames - 1),
      "[": () => this.toMark(-1),
      "]": () => this.toMark(1),
      "-": () => this.changeSpeed(-1),
      "+": () => this.changeSpeed(1),
      l: () => this.tell({ is_looping: !this.clock.isLooping }),
      m: () => this.tell({ is_mirrored: !this.model.get("is_mirrored") }),
      f: () => this.followFigure(),
      r: () => this.stage.resetView(),
    };
    const deed = deeds[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    deed?.();
    return deed !== undefined;
  }
}
