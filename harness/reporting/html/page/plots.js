// The row of plots: what each shows, its legend, and one zoom for all of them.

import { byId, element } from "./dom.js";
import { decodeGroup } from "./payload.js";
import { Plot, readings } from "./plot.js";
import { short } from "./units.js";

const PREFERRED = ["position", "velocity", "effort", "tracking"];

export class Plots {
  /**
   * @param {import("./payload.js").Payload} payload
   * @param {import("./clock.js").Clock} clock
   * @param {{start: number, end: number, tone: string}[]} bands
   */
  constructor(payload, clock, bands) {
    this.payload = payload;
    this.clock = clock;
    this.decoded = new Map();
    /** Names of series that are hidden, in every plot. @type {Set<string>} */
    this.hidden = new Set();
    const groups = payload.run.groups;
    if (clock.duration <= 0) {
      byId("app").classList.add("at-rest");
      byId("plots").append(element("p.empty", {}, "The run took no simulated time: there is nothing to plot."));
    }
    const first = [...PREFERRED.map((id) => groups.find((group) => group.id === id)), ...groups].filter(Boolean);
    const shown = clock.duration > 0 ? [...new Set(first)].slice(0, PREFERRED.length) : [];
    this.panels = shown.map((group) => this.#panel(group.id, bands));
    byId("plots").append(...this.panels.map((panel) => panel.element));
    this.zoom(0, clock.duration);
    clock.onTime((time) => this.point(time));
  }

  /** @param {number} from @param {number} to times shown [s] */
  zoom(from, to) {
    const end = Math.max(this.clock.duration, 1e-3);
    const [start, stop] = [Math.max(0, from), Math.min(end, Math.max(to, from + 1e-3))];
    for (const panel of this.panels) panel.plot.zoom(start, stop);
    byId("plots").classList.toggle("zoomed", stop - start < end - 1e-9);
  }

  /** @param {number} time */
  point(time) {
    for (const { plot, values, data } of this.panels) {
      plot.point(time);
      const texts = readings(data, time);
      values.forEach((cell, index) => (cell.textContent = texts[index]));
    }
  }

  /** A group with its series, whether a panel shows it or not; null where the run has none. @param {string} id */
  panelData(id) {
    return this.payload.run.groups.some((group) => group.id === id) ? this.#data(id) : null;
  }

  /** Draw in another theme. */
  redraw() {
    for (const panel of this.panels) this.#fill(panel, panel.data.id);
  }

  /** Show a group, in the panel that shows it already or else in the last one. @param {string} id */
  reveal(id) {
    const panel = this.panels.find(({ data }) => data.id === id) ?? this.panels.at(-1);
    if (panel && panel.data.id !== id && this.payload.run.groups.some((group) => group.id === id)) this.#fill(panel, id);
    panel?.element.scrollIntoView({ block: "nearest" });
  }

  #panel(id, bands) {
    const plot = new Plot(bands, {
      onSeek: (time) => this.clock.seek(time),
      onZoom: (from, to) => this.zoom(from, to),
      onReset: () => this.zoom(0, this.clock.duration),
    });
    const choice = element(
      "select", { "aria-label": "What this plot shows" },
      ...this.payload.run.groups.map((group) =>
        element("option", { value: group.id }, group.unit ? `${group.title} [${group.unit}]` : group.title),
      ),
    );
    const legend = element("div.legend");
    const panel = { plot, choice, legend, values: [], data: null, element: null };
    choice.addEventListener("change", () => this.#fill(panel, choice.value));
    panel.element = element("figure.plot", {}, element("figcaption", {}, choice, legend), plot.canvas);
    this.#fill(panel, id);
    return panel;
  }

  #fill(panel, id) {
    panel.choice.value = id;
    panel.data = this.#data(id);
    panel.values = panel.data.series.map(() => element("output", { "aria-live": "off" }));
    panel.legend.replaceChildren(
      ...panel.data.series.map((series, index) => {
        const swatch = element("i");
        swatch.style.background = Plot.color(index);
        return element(
          "button",
          {
            type: "button", title: series.name, "aria-pressed": !this.hidden.has(series.name),
            onclick: () => this.#toggle(series.name),
            ondblclick: () => this.#only(panel, series.name),
          },
          swatch, element("span", {}, short(series.name)), panel.values[index],
        );
      }),
    );
    this.#redraw(panel);
    const texts = readings(panel.data, this.clock.time);
    panel.values.forEach((cell, index) => (cell.textContent = texts[index]));
  }

  #data(id) {
    if (!this.decoded.has(id)) {
      const group = this.payload.run.groups.find((each) => each.id === id);
      this.decoded.set(id, { ...group, series: decodeGroup(this.payload, group) });
    }
    return this.decoded.get(id);
  }

  #toggle(name) {
    if (!this.hidden.delete(name)) this.hidden.add(name);
    this.#showHidden();
  }

  #only(panel, name) {
    const others = panel.data.series.map((series) => series.name).filter((each) => each !== name);
    const isAlone = others.every((each) => this.hidden.has(each));
    for (const each of others) isAlone ? this.hidden.delete(each) : this.hidden.add(each);
    this.hidden.delete(name);
    this.#showHidden();
  }

  #showHidden() {
    for (const panel of this.panels) {
      [...panel.legend.children].forEach((chip, index) =>
        chip.setAttribute("aria-pressed", String(!this.hidden.has(panel.data.series[index].name))),
      );
      this.#redraw(panel);
    }
  }

  #redraw(panel) {
    const hidden = panel.data.series.flatMap((series, index) => (this.hidden.has(series.name) ? [index] : []));
    panel.plot.show(panel.data, new Set(hidden));
  }
}
