// What pointer and keys do on a plot: seek, zoom, and show the values at a time.

import { themeColor } from "./dom.js";
import { FONT, line } from "./plot_paint.js";
import { valueAt } from "./payload.js";
import { short } from "./units.js";

const LINE = 15; // height of a line of values [CSS pixels]
const DRAG = 6; // [CSS pixels] that make a click a zoom
const ZOOMS = { "+": 0.25, "=": 0.25, "-": 1 }; // half of what a key shows, as a share of what is shown

/**
 * @param {import("./plot.js").Plot} plot
 * @param {{onSeek: (time: number) => void, onZoom: (from: number, to: number) => void, onReset: () => void}} actions
 */
export function controlPlot(plot, { onSeek, onZoom, onReset }) {
  const { canvas } = plot;
  let start = null;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    start = event.offsetX;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType === "mouse" || start !== null) showUnderPointer(plot, start, event.offsetX);
  });
  canvas.addEventListener("pointerleave", () => plot.point(plot.cursor));
  canvas.addEventListener("pointerup", (event) => {
    if (start === null) return;
    const [from, to] = [Math.min(start, event.offsetX), Math.max(start, event.offsetX)];
    if (to - from > DRAG) onZoom(plot.axes.timeAt(from), plot.axes.timeAt(to));
    else onSeek(plot.axes.timeAt(event.offsetX));
    start = null;
  });
  canvas.addEventListener("dblclick", onReset);
  canvas.addEventListener("keydown", (event) => {
    const span = ZOOMS[event.key] * (plot.to - plot.from);
    if (span) onZoom(plot.cursor - span, plot.cursor + span);
    else if (event.key === "0") onReset();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}

/** The stretch that is being dragged, or the values at the pointer. */
function showUnderPointer(plot, start, x) {
  plot.point(plot.cursor);
  const { axes } = plot;
  const pen = plot.pen();
  if (start !== null && Math.abs(x - start) > DRAG) {
    pen.fillStyle = themeColor("--step-band");
    pen.fillRect(Math.min(start, x), axes.top, Math.abs(x - start), axes.height);
    return;
  }
  const time = axes.timeAt(x);
  if (time < axes.from || time > axes.to) return;
  pen.strokeStyle = themeColor("--muted");
  pen.lineWidth = 1;
  line(pen, x, axes.top, x, axes.bottom);
  showValues(pen, plot, time, x);
}

/** The values at a time in a box next to the pointer, the largest first. */
function showValues(pen, { data, hidden, axes, color }, time, x) {
  const texts = readings(data, time);
  const rows = data.series
    .map(({ name, label }, index) => ({ index, text: `${texts[index]}  ${label ?? short(name)}`, value: parseFloat(texts[index]) }))
    .filter(({ index, value }) => !hidden.has(index) && Number.isFinite(value))
    .sort((a, b) => b.value - a.value)
    .slice(0, Math.max(1, Math.floor(axes.height / LINE) - 1));
  pen.font = FONT;
  pen.textBaseline = "top";
  pen.textAlign = "left";
  const width = Math.max(60, ...rows.map(({ text }) => pen.measureText(text).width)) + 12;
  const isLeft = x > axes.left + axes.width / 2;
  const [left, top] = [isLeft ? x - width - 6 : x + 6, axes.top + 2];
  pen.fillStyle = themeColor("--panel");
  pen.globalAlpha = 0.9;
  pen.fillRect(left, top, width, (rows.length + 1) * LINE + 4);
  pen.globalAlpha = 1;
  pen.fillStyle = themeColor("--text");
  pen.fillText(`${time.toFixed(3)} s`, left + 6, top + 3);
  rows.forEach(({ index, text }, row) => {
    pen.fillStyle = color(index);
    pen.fillText(text, left + 6, top + 3 + (row + 1) * LINE);
  });
}

/** Values of all series at a time, with as many digits as the plot can show. @param {import("./plot.js").PlotData} data @param {number} time */
export function readings(data, time) {
  const highest = Math.max(...data.series.map(({ low, high }) => Math.max(Math.abs(low), Math.abs(high))), data.least);
  const digits = Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(highest || 1))));
  return data.series.map((series) => {
    const value = valueAt(series, time);
    return Number.isNaN(value) ? "–" : value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1");
  });
}
