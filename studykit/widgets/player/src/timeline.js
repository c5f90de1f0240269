// The line of time: a slider over the frames, with marked stretches above it.
import { element, fill } from "./dom.js";

export class Timeline {
  constructor(signal, onScrub) {
    this.marks = element("div", { class: "sk-marks", "aria-hidden": "true" });
    this.slider = element("input", {
      type: "range",
      class: "sk-slider",
      min: 0,
      max: 0,
      step: 1,
      value: 0,
      "aria-label": "Frame",
      signal,
      oninput: () => onScrub(Number(this.slider.value)),
    });
    this.element = element("div", { class: "sk-timeline" }, this.marks, this.slider);
  }

  /** Draw stretches [start_s, stop_s, label, kind] along a motion. */
  show(marks, duration, frames) {
    this.slider.max = Math.max(frames - 1, 0);
    fill(
      this.marks,
      marks.map(([start, stop, label, kind]) => {
        const mark = element("span", { class: `sk-mark sk-mark-${kind}`, title: label });
        mark.style.left = `${(100 * start) / duration}%`;
        mark.style.width = `max(3px, ${(100 * Math.min(stop - start, duration - start)) / duration}%)`;
        return mark;
      }),
    );
    this.element.classList.toggle("sk-has-marks", marks.length > 0);
  }

  at(frame, text) {
    this.slider.value = frame;
    this.slider.setAttribute("aria-valuetext", text);
  }
}
