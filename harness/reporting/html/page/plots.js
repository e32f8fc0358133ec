// The row of plots: what each shows, one legend and one stretch of time for all of them.

import { byId, element } from "./dom.js";
import { decodeGroup } from "./payload.js";
import { Plot } from "./plot.js";
import { savePng, saveSvg } from "./plot_file.js";
import { readings } from "./plot_pointer.js";
import { number, short } from "./units.js";

const PREFERRED = ["position", "velocity", "effort", "tracking"];

/** From the units of measures to those of plots. */
const FACTORS = { "m mm": 1e3, "rad °": 180 / Math.PI, "m/s mm/s": 1e3, "rad/s °/s": 180 / Math.PI, "1 % of limit": 100 };
const BOUNDS = { "<=": "at most", ">=": "at least", "==": "exactly" };

/** The plot of a measure; of a joint that is not the arm's, that of the others. @param {any} run @param {any} measure */
export function plotOf(run, { plot, detail }) {
  const has = (id) => run.groups.find((group) => group.id === id)?.series.some(({ name }) => name === detail);
  return plot && !has(plot) && has(`other_${plot}`) ? `other_${plot}` : plot;
}

/** The limit of a measure as a line of a plot; none where the plot has another unit. */
function limitOf({ limit, unit, comparison }, data) {
  const factor = unit === data.unit ? 1 : FACTORS[`${unit} ${data.unit}`];
  return factor ? [{ value: factor * limit, text: `${BOUNDS[comparison]} ${number(factor * limit)} ${data.unit}` }] : [];
}

export class Plots {
  /**
   * @param {import("./payload.js").Payload} payload
   * @param {import("./clock.js").Clock} clock
   * @param {{start: number, end: number, tone: string}[]} bands
   * @param {string[]} [preferred] groups that are shown first, if the run has them
   */
  constructor(payload, clock, bands, preferred = []) {
    this.payload = payload;
    this.clock = clock;
    this.decoded = new Map();
    /** Names of series that are hidden, in every plot. @type {Set<string>} */
    this.hidden = new Set();
    this.legend = element("div.legend", { role: "toolbar", "aria-label": "Lines of all plots" });
    byId("plot-head").prepend(this.legend);
    const groups = payload.run.groups;
    if (clock.duration <= 0) {
      byId("app").classList.add("at-rest");
      byId("plots").append(element("p.empty", {}, "The run took no simulated time: there is nothing to plot."));
    }
    const first = [...[...preferred, ...PREFERRED].map((id) => groups.find((group) => group.id === id)), ...groups].filter(Boolean);
    const shown = clock.duration > 0 ? [...new Set(first)].slice(0, PREFERRED.length) : [];
    this.panels = shown.map((group) => this.#panel(group.id, bands));
    byId("plots").append(...this.panels.map((panel) => panel.element));
    this.#showLegend();
    clock.onSpan(({ from, to }) => {
      for (const { plot } of this.panels) plot.zoom(from, to);
      byId("plots").classList.toggle("zoomed", !clock.isWhole);
    });
    clock.onTime((time) => this.panels.forEach((panel) => this.#point(panel, time)));
  }

  /** A group with its series, whether a panel shows it or not; null where the run has none. @param {string} id */
  panelData(id) {
    return this.payload.run.groups.some((group) => group.id === id) ? this.data(id) : null;
  }

  /** Draw in another theme. */
  redraw() {
    this.#showLegend();
  }

  /** Take the lines anew: they have changed. */
  refill() {
    this.decoded.clear();
    for (const panel of this.panels) this.#fill(panel, panel.choice.value);
    this.#showLegend();
  }

  /** Mark the time over which a verdict was judged, with the limits of what it measured, and show its first quantity. @param {{start: number, end: number}} span @param {any[]} measures with the ids of their plots */
  judge(span, measures) {
    const shown = measures.find(({ plot }) => plot)?.plot;
    if (shown) this.reveal(shown);
    for (const panel of this.panels) {
      const mine = measures.filter(({ plot, limit }) => plot === panel.data.id && limit !== null);
      panel.plot.judged = mine.length ? { ...span, limits: mine.flatMap((measure) => limitOf(measure, panel.data)) } : null;
      panel.plot.draw();
    }
  }

  /** Show a group, in the panel that shows it already or else in the last one. @param {string} id */
  reveal(id) {
    const panel = this.panels.find(({ data }) => data.id === id) ?? this.panels.at(-1);
    if (panel && panel.data.id !== id && this.payload.run.groups.some((group) => group.id === id)) {
      this.#fill(panel, id);
      this.#showLegend();
    }
  }

  /** @param {string} id of a group */
  data(id) {
    if (!this.decoded.has(id)) {
      const group = this.payload.run.groups.find((each) => each.id === id);
      this.decoded.set(id, { ...group, series: this.series(group) });
    }
    return this.decoded.get(id);
  }

  /** The lines of a group. */
  series(group) {
    return group.isDecoded ? group.series : decodeGroup(this.payload, group);
  }

  #panel(id, bands) {
    const plot = new Plot(bands, {
      onSeek: (time) => this.clock.seek(time),
      onZoom: (from, to) => this.clock.show(from, to),
      onReset: () => this.clock.show(),
    });
    const choice = element(
      "select", { "aria-label": "What this plot shows" },
      ...this.payload.run.groups.map((group) =>
        element("option", { value: group.id }, group.unit ? `${group.title} [${group.unit}]` : group.title),
      ),
    );
    const reading = element("output", { "aria-live": "off" });
    const panel = { plot, choice, reading, data: null, element: null, saves: [] };
    choice.addEventListener("change", () => {
      this.#fill(panel, choice.value);
      this.#showLegend();
    });
    panel.saves = [["SVG", saveSvg], ["PNG", savePng]].map(([kind, write]) => element("button.link", { type: "button", onclick: () => write(panel) }, kind));
    panel.element = element("figure.plot", {}, element("figcaption", {}, choice, reading, ...panel.saves), plot.canvas);
    this.#fill(panel, id);
    return panel;
  }

  #fill(panel, id) {
    panel.choice.value = id;
    panel.data = this.data(id);
    for (const save of panel.saves) save.title = save.ariaLabel = `Save the plot of ${panel.data.title} as ${save.textContent}`;
  }

  /** Of the lines of a plot: the largest value at the cursor, and whose it is, in its colour. */
  #point(panel, time) {
    panel.plot.point(time);
    const texts = readings(panel.data, time);
    const size = (index) => Math.abs(parseFloat(texts[index])) || 0;
    const shown = panel.data.series.map((_, index) => index).filter((index) => !panel.plot.hidden.has(index) && texts[index] !== "–");
    const largest = shown.reduce((best, index) => (best < 0 || size(index) > size(best) ? index : best), -1);
    const name = largest < 0 ? "" : panel.data.series[largest].name;
    panel.reading.textContent = largest < 0 ? "–" : shown.length > 1 ? `${texts[largest]} ${short(name)}` : texts[largest];
    panel.reading.style.color = largest < 0 ? "" : Plot.color(this.colors.get(name) ?? largest);
    panel.reading.title = name && `${name} at the cursor, the largest`;
  }

  /** One entry for each line of any plot; its colour is the same in all of them. */
  #showLegend() {
    const names = [...new Set(this.panels.flatMap(({ data }) => data.series.map(({ name }) => name)))];
    this.colors = new Map(names.map((name, index) => [name, index]));
    const chips = names.map((name, index) => {
      return element(
        "button",
        {
          type: "button", title: name, "aria-pressed": !this.hidden.has(name),
          onclick: () => this.#toggle(name), ondblclick: () => this.#only(names, name),
        },
        Plot.swatch(index), element("span", {}, short(name)),
      );
    });
    this.legend.replaceChildren(...chips);
    for (const panel of this.panels) this.#draw(panel);
  }

  #toggle(name) {
    if (!this.hidden.delete(name)) this.hidden.add(name);
    this.#showHidden();
  }

  #only(names, name) {
    const others = names.filter((each) => each !== name);
    const isAlone = others.every((each) => this.hidden.has(each));
    for (const each of others) isAlone ? this.hidden.delete(each) : this.hidden.add(each);
    this.hidden.delete(name);
    this.#showHidden();
  }

  #showHidden() {
    for (const chip of this.legend.children) chip.setAttribute("aria-pressed", String(!this.hidden.has(chip.title)));
    for (const panel of this.panels) this.#draw(panel);
  }

  #draw(panel) {
    const { series } = panel.data;
    const hidden = series.flatMap(({ name }, index) => (this.hidden.has(name) ? [index] : []));
    panel.plot.show(panel.data, new Set(hidden), series.map(({ name }) => this.colors.get(name)));
    this.#point(panel, this.clock.time);
  }
}
