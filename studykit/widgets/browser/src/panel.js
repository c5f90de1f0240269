// The library browser: filters, one page of segments, and the facts of the one that plays.
import { button, choice, element, fill, hear } from "../../player/src/dom.js";

export class BrowserPanel {
  constructor(model, player, signal) {
    this.model = model;
    this.player = player;
    this.signal = signal;
    player.moreKeys.textContent = "In the table, up and down go through the rows, Enter plays.";
    this.filters = element("div", { class: "sk-controls", role: "group", "aria-label": "Filters" });
    this.count = element("span", { class: "sk-count", role: "status" });
    this.head = element("thead");
    this.body = element("tbody");
    this.pager = element("div", { class: "sk-controls", role: "group", "aria-label": "Pages" });
    this.facts = element("dl", { class: "sk-facts", "aria-label": "The segment that plays" });
    const on = (names, act) => hear(model, signal, names, act);
    on(["rows", "selected", "sort", "columns"], () => this.drawTable());
    on(["page", "pages", "total"], () => this.drawPager());
    on(["facts"], () => this.drawFacts());
    on(["filters", "choices"], () => this.drawFilters());
    this.drawFilters();
    this.drawTable();
    this.drawPager();
    this.drawFacts();
  }

  around(picture) {
    return [
      element("div", { class: "sk-columns" }, picture, this.facts),
      this.filters,
      element("div", { class: "sk-scroll" }, element("table", { class: "sk-table" }, this.head, this.body)),
      this.pager,
    ];
  }

  drawFilters() {
    const filters = this.model.get("filters");
    const set = (name, value) => this.player.tell({ filters: { ...this.model.get("filters"), [name]: value } });
    const lists = Object.entries(this.model.get("choices")).map(([name, values]) => {
      const words = name.replace("_", " ");
      const pairs = [["", `any ${words}`], ...values.map((value) => [value, value])];
      const list = choice(words, pairs, filters[name] ?? "", {
        signal: this.signal,
        onchange: () => set(name, list.value),
      });
      return element("label", { class: "sk-field" }, `${words} `, list);
    });
    const bound = (name, words) => {
      const field = element("input", {
        type: "number",
        min: 0,
        step: "any",
        class: "sk-number",
        "aria-label": `${words} linear energy, J`,
        placeholder: words,
        value: filters[name] ?? "",
        signal: this.signal,
        onchange: () => set(name, field.value === "" ? null : Math.max(Number(field.value), 0)),
      });
      return field;
    };
    fill(
      this.filters,
      lists,
      element("span", { class: "sk-field" }, "linear energy, J ", bound("least_j", "least"), " – ", bound("most_j", "most")),
      button("Show all", { signal: this.signal, onclick: () => this.player.tell({ filters: {} }) }),
    );
  }

  drawTable() {
    const [sorted, direction] = this.model.get("sort");
    const columns = this.model.get("columns");
    const headings = columns.map(([key, words, isNumber]) => {
      const isSorted = key === sorted;
      const arrow = isSorted ? (direction === "ascending" ? " ▲" : " ▼") : "";
      const onclick = () =>
        this.player.tell({ sort: [key, isSorted && direction === "ascending" ? "descending" : "ascending"] });
      return element(
        "th",
        { scope: "col", "aria-sort": isSorted ? direction : "none", class: isNumber ? "sk-figure" : "" },
        button(words + arrow, { class: "sk-plain", signal: this.signal, onclick }),
      );
    });
    fill(this.head, element("tr", {}, element("th", { scope: "col" }, "play"), headings));
    const selected = this.model.get("selected");
    const hadFocus = this.body.contains(document.activeElement) && document.activeElement.dataset.id;
    const rows = this.model.get("rows").map(({ id, cells }) => {
      const play = () => this.player.tell({ selected: id });
      const row = element(
        "tr",
        { "aria-selected": id === selected, signal: this.signal, ondblclick: play },
        element(
          "td",
          {},
          button("▶", { class: "sk-plain", "aria-label": `Play segment ${id}`, "data-id": id, signal: this.signal, onclick: play }),
        ),
        cells.map((cell, column) =>
          element("td", { class: columns[column][2] ? "sk-figure" : "", title: cell }, cell),
        ),
      );
      return row;
    });
    fill(this.body, rows);
    if (hadFocus) this.body.querySelector(`[data-id="${Number(hadFocus)}"]`)?.focus();
  }

  drawPager() {
    const page = this.model.get("page");
    const pages = this.model.get("pages");
    const total = this.model.get("total");
    const to = (words, label, target) =>
      button(words, {
        "aria-label": label,
        disabled: target < 0 || target >= pages || target === page,
        signal: this.signal,
        onclick: () => this.player.tell({ page: target }),
      });
    this.count.textContent = `${total.toLocaleString("en")} ${total === 1 ? "segment" : "segments"}, page ${pages ? page + 1 : 0} of ${pages}`;
    fill(
      this.pager,
      to("«", "First page", 0),
      to("‹", "Page before", page - 1),
      to("›", "Page after", page + 1),
      to("»", "Last page", pages - 1),
      this.count,
    );
  }

  drawFacts() {
    fill(
      this.facts,
      this.model.get("facts").map(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]).flat(),
    );
  }

  /** Up and down go through the rows. */
  key(event) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!by || event.shiftKey || !this.body.contains(event.target)) return false;
    const buttons = [...this.body.querySelectorAll("button")];
    buttons[buttons.indexOf(event.target) + by]?.focus();
    return true;
  }
}
