// Elements of a page. What a person or a file wrote enters as text nodes and attributes, never as markup.

const SVG = "http://www.w3.org/2000/svg";

/** Make an element; `attributes` may hold `on...` listeners, which end with `signal`. */
export function element(tag, attributes = {}, ...children) {
  return dressed(document.createElement(tag), attributes, children);
}

/** Make an element of a drawing (SVG). */
export function drawing(tag, attributes = {}, ...children) {
  return dressed(document.createElementNS(SVG, tag), attributes, children);
}

function dressed(made, { signal, ...attributes }, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value, { signal });
    else if (name.startsWith("aria-")) made.setAttribute(name, String(value)); // "false" is a word there
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) made.setAttribute(name, String(value));
  }
  made.append(...children.flat().map((child) => (child instanceof Node ? child : String(child))));
  return made;
}

/** Replace what an element contains. */
export function fill(parent, ...children) {
  parent.replaceChildren(...children.flat().map((child) => (child instanceof Node ? child : String(child))));
}

/** Make a button with a word on it. */
export function button(words, attributes = {}) {
  return element("button", { type: "button", class: "sk-button", ...attributes }, words);
}

/** Make a drop-down list of [value, words] pairs. */
export function choice(label, pairs, chosen, attributes = {}) {
  const select = element(
    "select",
    { "aria-label": label, class: "sk-select", ...attributes },
    pairs.map(([value, words]) => element("option", { value }, words)),
  );
  select.value = chosen;
  return select;
}

/** Whether a key pressed here is meant for a field that takes text or a list of choices. */
export function isTyping(event) {
  const { tagName, type, isContentEditable } = event.target;
  if (isContentEditable) return true;
  if (tagName === "SELECT" || tagName === "TEXTAREA") return true;
  return tagName === "INPUT" && type !== "range" && type !== "checkbox";
}

/** Write a time as seconds, or as minutes and seconds from a minute on. */
export function clockText(seconds) {
  if (seconds < 60) return `${seconds.toFixed(2)} s`;
  const whole = Math.floor(seconds / 60);
  return `${whole}:${(seconds - 60 * whole).toFixed(2).padStart(5, "0")} min`;
}

/** Call `act` whenever one of these values of a model changes, until `signal`. */
export function hear(model, signal, names, act) {
  for (const name of names) model.on(`change:${name}`, act);
  signal.addEventListener("abort", () => names.forEach((name) => model.off(`change:${name}`, act)));
}
