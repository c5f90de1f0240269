// What anywidget calls: draws a widget's room into an element and gives back how to take it away.
import { BrowserPanel } from "../../browser/src/panel.js";
import { BodyMapPanel } from "../../body_map/src/panel.js";
import { DesignerPanel } from "../../designer/src/panel.js";
import { RaterPanel } from "../../rater/src/panel.js";
import { ReviewerPanel } from "../../reviewer/src/panel.js";
import { element } from "./dom.js";
import { Player } from "./player.js";

const PANELS = {
  body_map: BodyMapPanel,
  browser: BrowserPanel,
  designer: DesignerPanel,
  rater: RaterPanel,
  reviewer: ReviewerPanel,
};
const WITHOUT_PLAYER = ["body_map"];

function render({ model, el }) {
  const ending = new AbortController();
  const { signal } = ending;
  const room = model.get("room");
  const player = WITHOUT_PLAYER.includes(room) ? undefined : new Player(model, signal);
  const Panel = PANELS[room];
  const panel = Panel ? new Panel(model, player, signal) : undefined;
  const root = element(
    "div",
    {
      class: `sk-widget sk-room-${room}`,
      "data-lm-suppress-shortcuts": "true", // otherwise JupyterLab takes our keys for its own
      signal,
      onkeydown: (event) => {
        const isForPlayer = player && !panel?.keeps?.(event.target);
        if (panel?.key?.(event) || (isForPlayer && player.key(event))) event.preventDefault();
        event.stopPropagation();
      },
    },
    panel ? panel.around(player?.element) : player.element,
  );
  el.append(root);
  return () => {
    ending.abort();
    root.remove();
  };
}

export default { render };
