// What anywidget calls: draws a widget's room into an element and gives back how to take it away.
import { BrowserPanel } from "../../browser/src/panel.js";
import { RaterPanel } from "../../rater/src/panel.js";
import { ReviewerPanel } from "../../reviewer/src/panel.js";
import { element } from "./dom.js";
import { Player } from "./player.js";

const PANELS = { browser: BrowserPanel, reviewer: ReviewerPanel, rater: RaterPanel };

function render({ model, el }) {
  const ending = new AbortController();
  const { signal } = ending;
  const player = new Player(model, signal);
  const Panel = PANELS[model.get("room")];
  const panel = Panel ? new Panel(model, player, signal) : undefined;
  const root = element(
    "div",
    {
      class: `sk-widget sk-room-${model.get("room")}`,
      "data-lm-suppress-shortcuts": "true", // otherwise JupyterLab takes our keys for its own
      signal,
      onkeydown: (event) => {
        if (panel?.key?.(event) || player.key(event)) event.preventDefault();
        event.stopPropagation();
      },
    },
    panel ? panel.around(player.element) : player.element,
  );
  el.append(root);
  return () => {
    ending.abort();
    root.remove();
  };
}

export default { render };
