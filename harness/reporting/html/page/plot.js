// One time plot on a canvas, with a cursor that is shared with everything else.

import { Axes, rangeOf } from "./axes.js";
import { element, themeColor } from "./dom.js";
import { valueAt } from "./payload.js";
import { line, paint } from "./plot_paint.js";
import { controlPlot } from "./plot_pointer.js";
import { number } from "./units.js";

const LEAST = { width: 40, height: 25 }; // [CSS pixels] of a plot that is drawn
const DOT = 2.7; // radius at the cursor [CSS pixels]
const COLORS = 12; // of the theme
const DASHES = [[], [7, 3], [2, 3]]; // of lines that share a colour: strokes and gaps [CSS pixels]

/**
 * @typedef {object} PlotData
 * @property {string} title
 * @property {string} unit
 * @property {import("./payload.js").Series[]} series
 * @property {{value: number, series: number | null, stretches: boolean}[]} limits
 * @property {number} least range of values that the plot shows: what is smaller is noise
 */

export class Plot {
  /**
   * @param {{start: number, end: number, tone: string}[]} bands of the steps
   * @param {{onSeek: (time: number) => void, onZoom: (from: number, to: number) => void, onReset: () => void}} actions
   */
  constructor(bands, actions) {
    this.bands = bands;
    this.canvas = element("canvas", { role: "img", tabindex: 0 });
    /** @type {Set<number>} */
    this.hidden = new Set();
    /** Number of the colour of each series. @type {number[]} */
    this.colors = [];
    /** @type {PlotData | null} */
    this.data = null;
    /** The time over which the chosen verdict was judged, with its limits. @type {{start: number, end: number, limits: {value: number, text: string}[]} | null} */
    this.judged = null;
    this.cursor = 0;
    this.from = 0;
    this.to = 1;
    /** Of the last drawing. @type {Axes | null} */
    this.axes = null;
    this.color = (index) => Plot.color(this.colors[index] ?? index);
    this.dash = (index) => Plot.dash(this.colors[index] ?? index);
    controlPlot(this, actions);
    new ResizeObserver(() => this.#fit()).observe(this.canvas);
  }

  /** Colour of a number. @param {number} index */
  static color(index) {
    return themeColor(`--s${index % COLORS}`);
  }

  /** Strokes and gaps of a number's line, which differ where colours repeat. @param {number} index */
  static dash(index) {
    return DASHES[Math.floor(index / COLORS) % DASHES.length];
  }

  /** A piece of a number's line. @param {number} index */
  static swatch(index) {
    const [made, color, [stroke, gap]] = [element("i"), Plot.color(index), Plot.dash(index)];
    made.style.background = gap ? `repeating-linear-gradient(90deg, ${color} 0 ${stroke}px, transparent 0 ${stroke + gap}px)` : color;
    return made;
  }

  /** @param {PlotData} data @param {Set<number>} [hidden] series that are not drawn @param {number[]} [colors] number of each one's colour */
  show(data, hidden = new Set(), colors = data.series.map((_, index) => index)) {
    this.data = data;
    this.hidden = hidden;
    this.colors = colors;
    const ranges = data.series.map(({ name, low, high }) => `${name} from ${number(low)} to ${number(high)}`);
    this.canvas.setAttribute("aria-label", `Plot over time of ${data.title} in ${data.unit}: ${ranges.join(", ")}`);
    this.draw();
  }

  /** @param {number} from @param {number} to times shown [s] */
  zoom(from, to) {
    this.from = from;
    this.to = to;
    this.draw();
  }

  /** Move the cursor; the lines below it are kept. @param {number} time */
  point(time) {
    this.cursor = time;
    if (!this.picture) return;
    const pen = this.pen();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.drawImage(this.picture, 0, 0);
    this.#drawCursor(this.pen());
  }

  /** Draw everything anew. */
  draw() {
    const { width, height } = this.canvas;
    if (!this.data || width < LEAST.width * this.ratio || height < LEAST.height * this.ratio) return;
    this.picture ??= document.createElement("canvas");
    this.picture.width = width;
    this.picture.height = height;
    const pen = this.picture.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    this.paint(pen, width / this.ratio, height / this.ratio);
    this.point(this.cursor);
  }

  /** Draw everything but the cursor. @param {any} pen of a canvas, or one that writes @param {number} width @param {number} height in CSS pixels */
  paint(pen, width, height) {
    this.axes = new Axes([this.from, this.to], rangeOf(this.data, this.hidden, this.from, this.to, this.judged?.limits), width, height);
    paint(pen, this, this.axes);
  }

  /** The plot in another size, without its cursor. @param {number} width @param {number} height in CSS pixels @param {number} ratio pixels in one of them */
  pictureOf(width, height, ratio) {
    this.#resize(width, height, ratio);
    const data = this.picture.toDataURL();
    this.#fit();
    return data;
  }

  /** What draws on the canvas in CSS pixels. */
  pen() {
    const pen = this.canvas.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    return pen;
  }

  #fit() {
    this.#resize(this.canvas.clientWidth, this.canvas.clientHeight, Math.min(devicePixelRatio, 2));
  }

  #resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.draw();
  }

  #drawCursor(pen) {
    const { axes } = this;
    const x = axes.x(this.cursor);
    if (x < axes.left - 1 || x > axes.right + 1) return;
    pen.strokeStyle = themeColor("--accent");
    pen.lineWidth = 1.5;
    line(pen, x, axes.top, x, axes.bottom);
    this.data.series.forEach((series, index) => {
      const value = valueAt(series, this.cursor);
      if (this.hidden.has(index) || Number.isNaN(value)) return;
      pen.fillStyle = this.color(index);
      pen.beginPath();
      pen.arc(x, axes.y(value), DOT, 0, 7);
      pen.fill();
    });
  }
}
