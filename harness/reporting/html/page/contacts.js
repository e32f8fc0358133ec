// Arrows where the robot presses on something: they end at the contact and are as long as it is hard.

import { rgba, themeColor } from "./dom.js";
import { undoDifferences } from "./payload.js";

const LENGTH = { least: 0.03, more: 0.09 }; // [m]; the hardest press of the run has both
const HEAD = { length: 0.28, width: 0.11 }; // shares of the length
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
      line: viewer.addLine([], { color: rgba(themeColor("--contact")), width: 2.5, onTop: true, visible: false }),
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
      if (pair.line.visible) this.viewer.setPoints(pair.line, this.#arrow(press));
    }
    this.viewer.redraw();
  }

  /** @returns {Press} */
  #pressOf({ link, body, columns, count, units }, index) {
    const numbers = Array.from({ length: NUMBERS }, (_, i) => columns[i * count + index] * units[i < 3 ? 0 : 1]);
    const force = numbers.slice(3);
    return { link, body, place: numbers.slice(0, 3), force, size: Math.hypot(...force) };
  }

  /** A shaft and four barbs, with gaps between them. @param {Press} press @returns {number[]} */
  #arrow({ place, force, size }) {
    const along = force.map((value) => value / size);
    const length = LENGTH.least + LENGTH.more * Math.sqrt(size / this.hardest);
    const flattest = along.reduce((best, value, axis) => (Math.abs(value) < Math.abs(along[best]) ? axis : best), 0);
    const side = perpendicular(along, [0, 1, 2].map((axis) => Number(axis === flattest)));
    const other = perpendicular(along, side);
    const back = (share, across, width) => place.map((value, i) => value - length * (share * along[i] + width * across[i]));
    const gap = [NaN, NaN, NaN];
    const barbs = [side, other].flatMap((across) => [HEAD.width, -HEAD.width].map((width) => back(HEAD.length, across, width)));
    return [...back(1, side, 0), ...place, ...barbs.flatMap((barb) => [...gap, ...place, ...barb])];
  }
}

/** A unit vector at right angles to two others. */
function perpendicular([ax, ay, az], [bx, by, bz]) {
  const cross = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
  const length = Math.hypot(...cross) || 1;
  return cross.map((value) => value / length);
}
