// The picture of the body with a button on each joint.
import { drawing } from "../../player/src/dom.js";
import { JOINTS, WIDTHS, speaker, speedText, stateOf, words } from "./body.js";

const [WIDTH, HEIGHT, MIDDLE] = [300, 440, 150];
const RADIUS = 8.5;
const SKULL = { cx: MIDDLE, cy: 40, rx: 23, ry: 29 };
const PLACES = new Map(JOINTS.map(([name, , x, y]) => [name, [MIDDLE + x, y]]));
const NEXT = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function widthAt(joint) {
  return WIDTHS[joint] ?? WIDTHS[joint.replace(/^(left|right)_/, "")];
}

function limb(joint, parent, attributes) {
  const [[x1, y1], [x2, y2]] = [PLACES.get(parent), PLACES.get(joint)];
  return drawing("line", { x1, y1, x2, y2, "stroke-width": widthAt(joint), ...attributes });
}

export class BodyFigure {
  /** `onchoose` is told of a joint that is looked at, `oncycle` of one that is clicked. */
  constructor(signal, { onchoose, oncycle }) {
    this.chosen = "right_elbow";
    const bones = JOINTS.filter(([, parent]) => parent);
    // What moves with a joint is what lies beyond it: the forearm with the elbow.
    this.tints = new Map(
      JOINTS.map(([joint]) => [
        joint,
        joint === "head"
          ? [drawing("ellipse", { class: "sk-tint sk-skull", ...SKULL })]
          : bones.filter(([, parent]) => parent === joint).map(([name]) => limb(name, joint, { class: "sk-tint" })),
      ]),
    );
    this.buttons = new Map(JOINTS.map(([name]) => [name, this.joint(name, signal, onchoose, oncycle)]));
    this.element = drawing(
      "svg",
      {
        class: "sk-body",
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        role: "group",
        "aria-label": "Body that faces you: the person's right side is on your left. The arrows go from joint to joint, Enter changes one.",
        signal,
        onkeydown: (event) => this.key(event, onchoose),
      },
      this.side(56, "RIGHT"),
      this.side(WIDTH - 56, "LEFT"),
      drawing(
        "g",
        { class: "sk-flesh", "aria-hidden": "true" },
        drawing("ellipse", { class: "sk-skull", ...SKULL }),
        drawing("path", { class: "sk-trunk", d: "M104 116 Q150 98 196 116 Q184 160 180 190 Q182 214 187 230 L113 230 Q118 214 120 190 Q116 160 104 116Z" }),
        bones.map(([name, parent]) => limb(name, parent, {})),
      ),
      drawing("g", { "aria-hidden": "true" }, [...this.tints.values()].flat()),
      [...this.buttons.values()].map(({ group }) => group),
    );
  }

  side(x, side) {
    return drawing(
      "text",
      { class: "sk-side", x, y: 26, "text-anchor": "middle" },
      drawing("tspan", { x }, "person's own"),
      drawing("tspan", { class: `sk-side-${side.toLowerCase()}`, x, dy: 17 }, side),
    );
  }

  joint(name, signal, onchoose, oncycle) {
    const [x, y] = PLACES.get(name);
    const title = drawing("title");
    const group = drawing(
      "g",
      {
        class: "sk-joint",
        role: "button",
        tabindex: name === this.chosen ? 0 : -1,
        transform: `translate(${x} ${y})`,
        "data-joint": name,
        signal,
        onclick: () => oncycle(name),
        onfocus: () => {
          this.choose(name);
          onchoose(name);
        },
      },
      title,
      drawing("circle", { class: "sk-reach", r: 12.5 }),
      drawing("circle", { class: "sk-limit", r: RADIUS + 3.5 }),
      drawing("circle", { class: "sk-ball", r: RADIUS }),
      drawing("path", { class: "sk-half", d: `M0 ${-RADIUS} A${RADIUS} ${RADIUS} 0 0 0 0 ${RADIUS}Z` }),
      drawing("path", { class: "sk-cross", d: "M-3.4 -3.4 L3.4 3.4 M3.4 -3.4 L-3.4 3.4" }),
      drawing("text", { class: "sk-alarm", x: 0, y: 5, "text-anchor": "middle" }, "!"),
    );
    return { group, title };
  }

  /** Make one joint the one that Tab comes to. */
  choose(name) {
    this.buttons.get(this.chosen).group.setAttribute("tabindex", -1);
    this.chosen = name;
    this.buttons.get(name).group.setAttribute("tabindex", 0);
  }

  focus(name) {
    this.buttons.get(name).group.focus();
  }

  /** Arrows go to the nearest joint in their direction; Enter and Space click. */
  key(event, onchoose) {
    if (event.key === "Enter" || event.key === " ") {
      event.target.dispatchEvent(new MouseEvent("click", { bubbles: true }));
      event.preventDefault();
    }
    const way = NEXT[event.key];
    if (!way || event.shiftKey) return;
    event.preventDefault();
    const [x, y] = PLACES.get(this.chosen);
    const cost = ([name, [otherX, otherY]]) => {
      const [along, across] = [(otherX - x) * way[0] + (otherY - y) * way[1], (otherX - x) * way[1] + (otherY - y) * way[0]];
      return name === this.chosen || along < 4 ? Infinity : along + 2 * Math.abs(across);
    };
    const [nearest] = [...PLACES].sort((first, second) => cost(first) - cost(second));
    if (cost(nearest) === Infinity) return;
    this.focus(nearest[0]);
    onchoose(nearest[0]);
  }

  /** Show what is asked of the joints and, where it is known, what a dance asks of them. */
  draw(weights, limits, report) {
    for (const [name, { group, title }] of this.buttons) {
      const [by, limitBy] = [speaker(name, weights), speaker(name, limits)];
      const weight = by ? weights[by] : 1;
      const state = stateOf(weight);
      const done = report.get(name);
      const tooFast = done !== undefined && done.is_within === false;
      group.setAttribute("class", `sk-joint sk-is-${state}${by && by !== name ? " sk-is-beyond" : ""}`);
      group.classList.toggle("sk-has-limit", limitBy !== undefined);
      group.classList.toggle("sk-is-broken", tooFast);
      for (const tint of this.tints.get(name)) {
        tint.style.visibility = weight >= 1 ? "hidden" : "visible";
        tint.style.setProperty("--sk-share", `${30 + 50 * (1 - weight)}%`);
      }
      const parts = [`${words(name)}: ${state}`];
      if (by && by !== name && weight < 1) parts[0] += ` along with the ${words(by)}`;
      if (state === "reduced") parts.push(`weight ${weight.toFixed(2)}`);
      if (limitBy) parts.push(`at most ${speedText(limits[limitBy])}`);
      if (done) parts.push(`in this dance up to ${speedText(done.peak_rad_s)}${tooFast ? ", too fast" : ""}`);
      const label = parts.join(", ");
      if (title.textContent !== label) title.textContent = label;
      group.setAttribute("aria-label", label);
    }
  }
}
