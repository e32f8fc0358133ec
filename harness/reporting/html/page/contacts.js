// Arrows where the robot presses on something: they end at the contact and are as long as it is hard.

import { rgba, themeColor } from "./dom.js";
import { undoDifferences } from "./payload.js";
import { cross, normalize } from "./vectors.js";

const LENGTH = { least: 26, more: 54 }; // [pixels]; the hardest press of the run has both
const HEAD = { length: 0.28, width: 0.11 }; // shares of the length
const GAP = [NaN, NaN, NaN];
const BARBS = [[HEAD.width, 0], [-HEAD.width, 0], [0, HEAD.width], [0, -HEAD.width]];
const ARROW = [0, 0, -1, 0, 0, 0, ...BARBS.flatMap(([x, y]) => [...GAP, 0, 0, 0, x, y, -HEAD.length])]; // ends at 0, along z
const NUMBERS = 6; // of a frame: where (xyz), and the force (xyz)

/**
 * @typedef {object} Press
 * @property {string} link @property {string} body
 * @property {number[]} place [m]
 * @property {number[]} force on the body [N]
 * @property {number} size of the force [N]
 */

export class Contacts {
  /** @param {import("./payload.js").Payload} payload @param {import("./viewer.js").Viewer} viewer */
  constructor(payload, viewer) {
    this.viewer = viewer;
    this.step = payload.run.frames.step;
    this.pairs = payload.run.presses.map((head) => ({
      ...head,
      columns: undoDifferences(payload.buffer(head.buffer), head.count),
      line: viewer.addLine(ARROW, { color: rgba(themeColor("--contact")), width: 2.5, onTop: true, visible: false }),
    }));
    const sizes = this.pairs.flatMap((pair) => Array.from({ length: pair.count }, (_, i) => this.#pressOf(pair, i).size));
    this.hardest = sizes.reduce((most, size) => Math.max(most, size), 1e-9);
    this.shown = -1;
  }

  /** Who presses on what at a time, the hardest first. @param {number} time @returns {Press[]} */
  at(time) {
    const frame = Math.round(time / this.step);
    return this.pairs
      .filter(({ first, count }) => frame >= first && frame < first + count)
      .map((pair) => this.#pressOf(pair, frame - pair.first))
      .filter(({ size }) => size > 0)
      .sort((a, b) => b.size - a.size);
  }

  /** Draw the arrows of a time. @param {number} time @param {boolean} isEnabled */
  show(time, isEnabled) {
    const frame = isEnabled ? Math.round(time / this.step) : -1;
    if (frame === this.shown) return;
    this.shown = frame;
    for (const pair of this.pairs) {
      const index = frame - pair.first;
      const press = isEnabled && index >= 0 && index < pair.count ? this.#pressOf(pair, index) : null;
      pair.line.visible = Boolean(press && press.size > 0);
      if (pair.line.visible) this.#point(pair.line, press);
    }
    this.viewer.redraw();
  }

  /** @returns {Press} */
  #pressOf({ link, body, columns, count, units }, index) {
    const numbers = Array.from({ length: NUMBERS }, (_, i) => columns[i * count + index] * units[i < 3 ? 0 : 1]);
    const force = numbers.slice(3);
    return { link, body, place: numbers.slice(0, 3), force, size: Math.hypot(...force) };
  }

  /** Turn the arrow along a force, longer for a harder one. @param {any} line @param {Press} press */
  #point(line, { place, force, size }) {
    const along = force.map((value) => value / size);
    const flattest = along.reduce((best, value, axis) => (Math.abs(value) < Math.abs(along[best]) ? axis : best), 0);
    const side = normalize(cross(along, [0, 1, 2].map((axis) => Number(axis === flattest))));
    line.model = new Float32Array([...side, 0, ...cross(along, side), 0, ...along, 0, ...place, 1]);
    line.pixels = LENGTH.least + LENGTH.more * Math.sqrt(size / this.hardest);
  }
}
