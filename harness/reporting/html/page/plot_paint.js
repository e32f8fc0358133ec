// Paints a plot with the pen of a canvas, or with one that writes a file.

import { limitsOf } from "./axes.js";
import { themeColor } from "./dom.js";
import { indexAt } from "./payload.js";

export const FONT = "11px system-ui, sans-serif";
const UNIT_ROOM = 30; // [CSS pixels] of the word `t [s]` under the lower axis

/**
 * @typedef {object} Shown what is painted
 * @property {import("./plot.js").PlotData} data
 * @property {Set<number>} hidden series
 * @property {{start: number, end: number, tone: string}[]} bands of the steps
 * @property {(index: number) => string} color of a series
 * @property {(index: number) => number[]} dash of a series
 * @property {{start: number, end: number, limits: {value: number, text: string}[]} | null} judged
 * @property {number} ratio pixels in one of CSS
 */

/** Everything but the cursor. @param {any} pen @param {Shown} shown @param {import("./axes.js").Axes} axes */
export function paint(pen, { data, hidden, bands, color, dash, ratio, judged }, axes) {
  pen.fillStyle = themeColor("--panel");
  pen.fillRect(0, 0, axes.outer.width, axes.outer.height);
  paintBands(pen, bands, axes);
  paintAxes(pen, axes);
  pen.save();
  pen.beginPath();
  pen.rect(axes.left, axes.top, axes.width, axes.height);
  pen.clip();
  pen.setLineDash([6, 4]);
  pen.lineWidth = 1.2;
  for (const limit of limitsOf(data, hidden)) {
    pen.strokeStyle = limit.series === null ? themeColor("--bad") : color(limit.series);
    line(pen, axes.left, axes.y(limit.value), axes.right, axes.y(limit.value));
  }
  for (const { value } of judged?.limits ?? []) {
    pen.strokeStyle = themeColor("--bad");
    line(pen, axes.left, axes.y(value), axes.right, axes.y(value));
  }
  data.series.forEach((series, index) => hidden.has(index) || paintSeries(pen, series, color(index), series.dash ?? dash(index), axes, ratio));
  pen.restore();
  if (judged) paintJudged(pen, judged, axes);
}

export function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

/** Every second step shaded, failed ones in another colour. */
function paintBands(pen, bands, axes) {
  let isShaded = false;
  for (const { start, end, tone } of bands) {
    if (end <= start) continue;
    isShaded = !isShaded;
    if (tone !== "bad" && !isShaded) continue;
    const [from, to] = [Math.max(axes.left, axes.x(start)), Math.min(axes.right, axes.x(end))];
    pen.fillStyle = themeColor(tone === "bad" ? "--bad-band" : "--step-band");
    if (to > from) pen.fillRect(from, axes.top, to - from, axes.height);
  }
}

/** A bracket over the time that the chosen verdict was judged over, and its limits in words. */
function paintJudged(pen, { start, end, limits }, axes) {
  const [from, to] = [start, end].map((time) => Math.max(axes.left, Math.min(axes.right, axes.x(time))));
  pen.strokeStyle = pen.fillStyle = themeColor("--text");
  pen.lineWidth = 1.5;
  const [top, tick] = [axes.top + 2, 7];
  if (to > from) for (const [x0, y0, x1, y1] of [[from, top, to, top], [from, top, from, top + tick], [to, top, to, top + tick]]) line(pen, x0, y0, x1, y1);
  pen.font = FONT;
  pen.textBaseline = "top";
  pen.textAlign = from > axes.left + axes.width / 2 ? "right" : "left";
  if (to > from) pen.fillText("judged", pen.textAlign === "right" ? Math.min(to, axes.right) : from + 4, top + 4);
  pen.fillStyle = themeColor("--bad");
  pen.textAlign = "right";
  const [first] = limits;
  if (first) {
    const y = axes.y(first.value);
    pen.textBaseline = y > axes.top + 40 ? "bottom" : "top";
    pen.fillText(first.text, axes.right - 4, y + (pen.textBaseline === "top" ? 3 : -2));
  }
}

function paintAxes(pen, axes) {
  pen.font = FONT;
  pen.fillStyle = themeColor("--muted");
  pen.strokeStyle = themeColor("--grid");
  pen.lineWidth = 1;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const value of axes.values) {
    line(pen, axes.left, axes.y(value), axes.right, axes.y(value));
    pen.fillText(String(value), axes.left - 6, axes.y(value));
  }
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const time of axes.times) {
    line(pen, axes.x(time), axes.top, axes.x(time), axes.bottom);
    if (axes.x(time) <= axes.right - UNIT_ROOM) pen.fillText(String(time), axes.x(time), axes.bottom + 4);
  }
  pen.textAlign = "right";
  pen.fillText("t [s]", axes.outer.width - 2, axes.bottom + 4);
}

/** A line through the samples in sight. */
function paintSeries(pen, series, color, dash, axes, ratio) {
  pen.strokeStyle = color;
  pen.lineWidth = 1.5;
  pen.setLineDash(dash);
  pen.lineJoin = "round";
  pen.beginPath();
  let isDown = false;
  for (const i of samplesShown(series, axes, axes.width * ratio)) {
    const value = series.values[i];
    if (Number.isNaN(value)) isDown = false;
    else if (isDown) pen.lineTo(axes.x(series.times[i]), axes.y(value));
    else {
      pen.moveTo(axes.x(series.times[i]), axes.y(value));
      isDown = true;
    }
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** Numbers of the samples in sight; of many in one column of pixels, the lowest and the highest. */
function* samplesShown({ times, values }, axes, pixels) {
  const first = Math.max(0, indexAt(times, axes.from) - 1);
  const last = indexAt(times, axes.to);
  const perPixel = (last - first) / pixels;
  if (perPixel <= 2) {
    for (let i = first; i <= last; i++) yield i;
    return;
  }
  for (let pixel = 0; pixel < pixels; pixel++) {
    const from = first + Math.floor(pixel * perPixel);
    const to = Math.min(last, first + Math.floor((pixel + 1) * perPixel));
    let [low, high] = [from, from];
    for (let i = from; i <= to; i++) {
      if (!(values[i] >= values[low])) low = Number.isNaN(values[i]) ? low : i;
      if (!(values[i] <= values[high])) high = Number.isNaN(values[i]) ? high : i;
    }
    yield Math.min(low, high);
    if (low !== high) yield Math.max(low, high);
  }
}
