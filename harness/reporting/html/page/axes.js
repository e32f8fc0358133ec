// Where times and values are on a plot.

import { indexAt } from "./payload.js";

const MARGIN = { left: 46, right: 10, top: 6, bottom: 18 }; // [CSS pixels]
const TICK_GAP = { x: 64, y: 30 }; // [CSS pixels]
const ROOM = 0.07; // of the values' range, above and below

export class Axes {
  /**
   * @param {[number, number]} times shown [s] @param {[number, number]} values shown
   * @param {number} width @param {number} height of the whole plot [CSS pixels]
   */
  constructor([from, to], [low, high], width, height) {
    Object.assign(this, { from, to, low, high });
    [this.left, this.top] = [MARGIN.left, MARGIN.top];
    this.width = width - MARGIN.left - MARGIN.right;
    this.height = height - MARGIN.top - MARGIN.bottom;
    [this.right, this.bottom] = [this.left + this.width, this.top + this.height];
    this.outer = { width, height };
  }

  /** @param {number} time [s] */
  x(time) {
    return this.left + ((time - this.from) / (this.to - this.from || 1)) * this.width;
  }

  /** @param {number} value */
  y(value) {
    return this.top + ((this.high - value) / (this.high - this.low)) * this.height;
  }

  /** @param {number} x [CSS pixels] */
  timeAt(x) {
    return this.from + ((x - this.left) / this.width) * (this.to - this.from);
  }

  /** Round times for the lower axis. */
  get times() {
    return ticks(this.from, this.to, this.width / TICK_GAP.x);
  }

  /** Round values for the left axis. */
  get values() {
    return ticks(this.low, this.high, this.height / TICK_GAP.y);
  }
}

/**
 * The values shown: all between two times, and the limits that need it.
 * @param {import("./plot.js").PlotData} data @param {Set<number>} hidden series
 * @param {number} from @param {number} to [s] @param {{value: number}[]} [judged] limits of the chosen verdict @returns {[number, number]}
 */
export function rangeOf(data, hidden, from, to, judged = []) {
  let [low, high] = [Infinity, -Infinity];
  const take = (value) => {
    if (value < low) low = value;
    if (value > high) high = value;
  };
  data.series.forEach((series, index) => {
    if (hidden.has(index)) return;
    const last = indexAt(series.times, to);
    for (let i = Math.max(0, indexAt(series.times, from) - 1); i <= last; i++) take(series.values[i]);
  });
  for (const limit of limitsOf(data, hidden)) if (limit.stretches) take(limit.value);
  for (const { value } of judged) take(value);
  if (low > high) [low, high] = [0, 1];
  const least = Math.max(1e-9, 1e-3 * Math.max(Math.abs(low), Math.abs(high)), data.least);
  if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
  const room = ROOM * (high - low);
  return [low - room, high + room];
}

/** Limits that are drawn: those of all series, and of the ones that are not hidden. @param {import("./plot.js").PlotData} data @param {Set<number>} hidden */
export function limitsOf(data, hidden) {
  return data.limits.filter(({ series }) => series === null || !hidden.has(series));
}

/** Round numbers between two values, approximately as many as requested. */
function ticks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; i++) found.push(Number((i * step).toPrecision(9)));
  return found;
}
