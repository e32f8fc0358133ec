// One time plot on a canvas: step bands, limits, a cursor shared with everything else, zoom.

import { element, themeColor } from "./dom.js";
import { indexAt, valueAt } from "./payload.js";
import { number, short } from "./units.js";

const MARGIN = { left: 46, right: 10, top: 6, bottom: 18 };
const FONT = "11px system-ui, sans-serif";
const LINE = 15; // height of a line of values [pixels]
const TICK_GAP = { x: 64, y: 30 }; // [pixels]
const DRAG = 6; // pixels that make a click a zoom
const ROOM = 0.07; // of the values' range, above and below

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
    this.cursor = 0;
    this.from = 0;
    this.to = 1;
    this.#control(actions);
    new ResizeObserver(() => this.#layOut()).observe(this.canvas);
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
    if (this.picture) {
      const pen = this.canvas.getContext("2d");
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.drawImage(this.picture, 0, 0);
      this.#drawCursor(pen);
    }
  }

  #color(index) {
    return Plot.color(this.colors[index] ?? index);
  }

  /** Colour of a number. @param {number} index */
  static color(index) {
    return themeColor(`--s${index % 10}`);
  }

  /** Draw everything anew. */
  draw() {
    const { width, height } = this.canvas;
    if (!this.data || width < 80 || height < 50) return;
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
    pen.fillStyle = themeColor("--panel");
    pen.fillRect(0, 0, width, height);
    this.#setRange();
    this.#drawBands(pen);
    this.#drawAxes(pen);
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.width, this.height);
    pen.clip();
    this.#drawLimits(pen);
    this.data.series.forEach((series, index) => this.hidden.has(index) || this.#drawSeries(pen, series, index));
    pen.restore();
  }

  /** The plot in another size, without its cursor. @param {number} width @param {number} height in CSS pixels @param {number} ratio pixels in one of them */
  pictureOf(width, height, ratio) {
    this.#resize(width, height, ratio);
    const data = this.picture.toDataURL();
    this.#layOut();
    return data;
  }

  get width() {
    return this.canvas.width / this.ratio - MARGIN.left - MARGIN.right;
  }

  get height() {
    return this.canvas.height / this.ratio - MARGIN.top - MARGIN.bottom;
  }

  #layOut() {
    this.#resize(this.canvas.clientWidth, this.canvas.clientHeight, Math.min(devicePixelRatio, 2));
  }

  #resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.draw();
  }

  #x(time) {
    return MARGIN.left + ((time - this.from) / (this.to - this.from || 1)) * this.width;
  }

  #y(value) {
    return MARGIN.top + ((this.high - value) / (this.high - this.low)) * this.height;
  }

  #timeAt(pixel) {
    return this.from + ((pixel - MARGIN.left) / this.width) * (this.to - this.from);
  }

  /** Heights shown: all values in sight, and the limits that need it. */
  #setRange() {
    let [low, high] = [Infinity, -Infinity];
    const take = (value) => {
      if (value < low) low = value;
      if (value > high) high = value;
    };
    this.data.series.forEach((series, index) => {
      if (this.hidden.has(index)) return;
      const last = indexAt(series.times, this.to);
      for (let i = Math.max(0, indexAt(series.times, this.from) - 1); i <= last; i++) take(series.values[i]);
    });
    for (const limit of this.data.limits) if (limit.stretches && this.#isShown(limit)) take(limit.value);
    if (low > high) [low, high] = [0, 1];
    const least = Math.max(1e-9, 1e-3 * Math.max(Math.abs(low), Math.abs(high)), this.data.least);
    if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
    const room = ROOM * (high - low);
    this.low = low - room;
    this.high = high + room;
  }

  #isShown(limit) {
    return limit.series === null || !this.hidden.has(limit.series);
  }

  #drawBands(pen) {
    let isShaded = false;
    for (const { start, end, tone } of this.bands) {
      if (end <= start) continue;
      isShaded = !isShaded;
      if (tone !== "bad" && !isShaded) continue;
      const [from, to] = [Math.max(MARGIN.left, this.#x(start)), Math.min(MARGIN.left + this.width, this.#x(end))];
      pen.fillStyle = themeColor(tone === "bad" ? "--bad-band" : "--step-band");
      if (to > from) pen.fillRect(from, MARGIN.top, to - from, this.height);
    }
  }

  #drawAxes(pen) {
    pen.font = FONT;
    pen.fillStyle = themeColor("--muted");
    pen.strokeStyle = themeColor("--grid");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const value of ticks(this.low, this.high, this.height / TICK_GAP.y)) {
      line(pen, MARGIN.left, this.#y(value), MARGIN.left + this.width, this.#y(value));
      pen.fillText(String(value), MARGIN.left - 6, this.#y(value));
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const time of ticks(this.from, this.to, this.width / TICK_GAP.x)) {
      line(pen, this.#x(time), MARGIN.top, this.#x(time), MARGIN.top + this.height);
      const isNearUnit = this.#x(time) > MARGIN.left + this.width - 30;
      if (!isNearUnit) pen.fillText(String(time), this.#x(time), MARGIN.top + this.height + 4);
    }
    pen.textAlign = "right";
    pen.fillText("t [s]", MARGIN.left + this.width + MARGIN.right - 2, MARGIN.top + this.height + 4);
  }

  #drawLimits(pen) {
    pen.setLineDash([6, 4]);
    pen.lineWidth = 1.2;
    for (const limit of this.data.limits) {
      if (!this.#isShown(limit)) continue;
      pen.strokeStyle = limit.series === null ? themeColor("--bad") : this.#color(limit.series);
      line(pen, MARGIN.left, this.#y(limit.value), MARGIN.left + this.width, this.#y(limit.value));
    }
    pen.setLineDash([]);
  }

  /** A line through the samples in sight; of many in one column of pixels, the lowest and highest. */
  #drawSeries(pen, series, index) {
    const { times, values } = series;
    const first = Math.max(0, indexAt(times, this.from) - 1);
    const last = indexAt(times, this.to);
    const perPixel = (last - first) / (this.width * this.ratio);
    pen.strokeStyle = this.#color(index);
    pen.lineWidth = 1.5;
    pen.setLineDash(series.dash ?? []);
    pen.lineJoin = "round";
    pen.beginPath();
    let isDown = false;
    const go = (x, value) => {
      if (Number.isNaN(value)) isDown = false;
      else if (isDown) pen.lineTo(x, this.#y(value));
      else {
        pen.moveTo(x, this.#y(value));
        isDown = true;
      }
    };
    if (perPixel <= 2) {
      for (let i = first; i <= last; i++) go(this.#x(times[i]), values[i]);
    } else {
      for (let pixel = 0; pixel < this.width * this.ratio; pixel++) {
        const from = first + Math.floor(pixel * perPixel);
        const to = Math.min(last, first + Math.floor((pixel + 1) * perPixel));
        let [low, high] = [from, from];
        for (let i = from; i <= to; i++) {
          if (!(values[i] >= values[low])) low = Number.isNaN(values[i]) ? low : i;
          if (!(values[i] <= values[high])) high = Number.isNaN(values[i]) ? high : i;
        }
        for (const i of new Set([Math.min(low, high), Math.max(low, high)])) go(this.#x(times[i]), values[i]);
      }
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  #drawCursor(pen) {
    const x = this.#x(this.cursor);
    if (x < MARGIN.left - 1 || x > MARGIN.left + this.width + 1) return;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.strokeStyle = themeColor("--accent");
    pen.lineWidth = 1.5;
    line(pen, x, MARGIN.top, x, MARGIN.top + this.height);
    this.data.series.forEach((series, index) => {
      const value = valueAt(series, this.cursor);
      if (this.hidden.has(index) || Number.isNaN(value)) return;
      pen.fillStyle = this.#color(index);
      pen.beginPath();
      pen.arc(x, this.#y(value), 2.7, 0, 7);
      pen.fill();
    });
  }

  #control({ onSeek, onZoom, onReset }) {
    const { canvas } = this;
    let start = null;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      start = event.offsetX;
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.pointerType === "mouse" || start !== null) this.#select(start, event.offsetX);
    });
    canvas.addEventListener("pointerleave", () => this.point(this.cursor));
    canvas.addEventListener("pointerup", (event) => {
      if (start === null) return;
      const [from, to] = [Math.min(start, event.offsetX), Math.max(start, event.offsetX)];
      if (to - from > DRAG) onZoom(this.#timeAt(from), this.#timeAt(to));
      else onSeek(this.#timeAt(event.offsetX));
      start = null;
    });
    canvas.addEventListener("dblclick", onReset);
    canvas.addEventListener("keydown", (event) => {
      const share = { "+": 0.25, "=": 0.25, "-": 1 }[event.key];
      const span = share * (this.to - this.from);
      if (share) onZoom(this.cursor - span, this.cursor + span);
      else if (event.key === "0") onReset();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /** The stretch that is being dragged, or the values under the pointer. */
  #select(start, pixel) {
    this.point(this.cursor);
    const pen = this.canvas.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    if (start !== null && Math.abs(pixel - start) > DRAG) {
      pen.fillStyle = themeColor("--step-band");
      pen.fillRect(Math.min(start, pixel), MARGIN.top, Math.abs(pixel - start), this.height);
      return;
    }
    const time = this.#timeAt(pixel);
    if (time < this.from || time > this.to) return;
    pen.strokeStyle = themeColor("--muted");
    pen.lineWidth = 1;
    line(pen, pixel, MARGIN.top, pixel, MARGIN.top + this.height);
    this.#drawValues(pen, time, pixel);
  }

  /** The values at a time in a box next to the pointer, the largest first. */
  #drawValues(pen, time, pixel) {
    const texts = readings(this.data, time);
    const rows = this.data.series
      .map(({ name, label }, index) => ({ index, text: `${texts[index]}  ${label ?? short(name)}`, value: parseFloat(texts[index]) }))
      .filter(({ index, value }) => !this.hidden.has(index) && Number.isFinite(value))
      .sort((a, b) => b.value - a.value)
      .slice(0, Math.max(1, Math.floor(this.height / LINE) - 1));
    pen.font = FONT;
    pen.textBaseline = "top";
    pen.textAlign = "left";
    const width = Math.max(60, ...rows.map(({ text }) => pen.measureText(text).width)) + 12;
    const isLeft = pixel > MARGIN.left + this.width / 2;
    const [x, y] = [isLeft ? pixel - width - 6 : pixel + 6, MARGIN.top + 2];
    pen.fillStyle = themeColor("--panel");
    pen.globalAlpha = 0.9;
    pen.fillRect(x, y, width, (rows.length + 1) * LINE + 4);
    pen.globalAlpha = 1;
    pen.fillStyle = themeColor("--text");
    pen.fillText(`${time.toFixed(3)} s`, x + 6, y + 3);
    rows.forEach(({ index, text }, row) => {
      pen.fillStyle = this.#color(index);
      pen.fillText(text, x + 6, y + 3 + (row + 1) * LINE);
    });
  }
}

/** Round numbers between two values, approximately as many as requested. */
export function ticks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; i++) found.push(Number((i * step).toPrecision(9)));
  return found;
}

function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

/** Values of all series at a time, with as many digits as the plot can show. @param {PlotData} data @param {number} time */
export function readings(data, time) {
  const highest = Math.max(...data.series.map(({ low, high }) => Math.max(Math.abs(low), Math.abs(high))), data.least);
  const digits = Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(highest || 1))));
  return data.series.map((series) => {
    const value = valueAt(series, time);
    return Number.isNaN(value) ? "–" : value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1");
  });
}
