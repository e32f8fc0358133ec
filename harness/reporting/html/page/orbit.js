// A camera that circles a point: it frames what is of interest from any side; mouse, touch and keyboard.

import { addScaled, cross, dot, lookAt, multiply, normalize, perspective } from "./vectors.js";

const FIELD_OF_VIEW = 0.7; // [rad]
const FRAMED = { left: 0.95, right: 0.95, top: 0.8, bottom: 0.86, narrow: 0.74 }; // shares of half the picture: words lie along its edges, in a narrow one above all of it
const THICKNESS = { share: 0.09, least: 0.05 }; // of the arm's size, and [m]: how far links reach beyond their origins
const FOLLOWED = 0.4; // of the arm's size: how much of it is seen around a TCP that is followed
const TURN_PER_PIXEL = 0.008; // [rad]
const STEEPEST = 1.55; // [rad]

/** Where the eye is, seen from the target: angles in [rad]. */
export const SIDES = {
  iso: { azimuth: -0.72, elevation: 0.42 },
  front: { azimuth: 0, elevation: 0.02 },
  side: { azimuth: -Math.PI / 2, elevation: 0.02 },
  top: { azimuth: -Math.PI / 2, elevation: STEEPEST },
};

export class Orbit {
  /**
   * @param {{points: number[][], arm: number}} focus what the picture holds, and the arm's size [m]
   * @param {() => void} changed called when the view is another one
   */
  constructor(focus, changed) {
    this.focus = focus;
    this.framed = focus.points;
    this.changed = changed;
    this.isHeld = false;
    this.target = [0, 0, 0];
    this.distance = 1;
    this.tangent = Math.tan(FIELD_OF_VIEW / 2);
    this.look("iso");
  }

  /** Frame what is of interest from a side. @param {keyof SIDES} side */
  look(side) {
    this.framed = this.focus.points;
    Object.assign(this, SIDES[side]);
    this.side = side;
    this.framedFor = 0;
    this.changed();
  }

  /** Frame some points until a side is chosen. @param {number[][]} points [m] */
  open(points) {
    this.framed = points;
    this.framedFor = 0;
    this.changed();
  }

  /** Keep a point in the middle. @param {number[]} point [m] */
  follow(point) {
    this.target = [...point];
    this.changed();
  }

  /** Look at a point from nearby. @param {number[]} point [m] */
  approach(point) {
    this.#leave();
    this.target = [...point];
    this.distance = (FOLLOWED * this.focus.arm) / Math.tan(FIELD_OF_VIEW / 2);
    this.changed();
  }

  /** Direction from the target to the eye. @returns {import("./vectors.js").Vector} */
  get back() {
    const flat = Math.cos(this.elevation);
    return [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }

  /** Where the eye is. @returns {import("./vectors.js").Vector} */
  get eye() {
    return addScaled(this.target, this.back, this.distance);
  }

  /** Projection times view. @param {number} aspect width over height; a narrow picture has a wider angle */
  matrix(aspect) {
    const angle = aspect >= 1 ? FIELD_OF_VIEW : 2 * Math.atan(Math.tan(FIELD_OF_VIEW / 2) / Math.sqrt(aspect));
    this.tangent = Math.tan(angle / 2);
    if (this.framedFor !== null && Math.abs(this.framedFor - aspect) > 1e-3) this.#frame(aspect);
    const lens = perspective(angle, aspect, Math.max(0.005, this.distance * 0.02), this.distance + 40);
    return multiply(lens, lookAt(this.eye, this.target, [0, 0, 1]));
  }

  /** Right and up of the picture, in the world. */
  #axes() {
    const right = normalize(cross([0, 0, 1], this.back));
    return { right, up: cross(this.back, right) };
  }

  /**
   * Put the eye as near as all points allow, in their middle. With t the slope of an edge of the picture,
   * a point at (x, depth z towards the eye) is inside it if x - eye.x <= t (eye.z - z): linear in the eye.
   */
  #frame(aspect) {
    const { right, up } = this.#axes();
    const room = Math.max(THICKNESS.least, THICKNESS.share * this.focus.arm);
    const placed = this.framed.map((point) => [dot(point, right), dot(point, up), dot(point, this.back)]);
    const farthest = (axis, sign, slope) => Math.max(...placed.map((at) => sign * at[axis] + room + slope * at[2]));
    const slopes = [
      [this.tangent * aspect * FRAMED.right, this.tangent * aspect * FRAMED.left],
      [this.tangent * (aspect < 1 ? FRAMED.narrow : FRAMED.top), this.tangent * FRAMED.bottom],
    ];
    const edges = slopes.map(([more, less], axis) => [farthest(axis, 1, more), farthest(axis, -1, less)]);
    const near = Math.max(...placed.map((at) => at[2])) + 2 * room;
    const depth = Math.max(near, ...slopes.map(([more, less], axis) => (edges[axis][0] + edges[axis][1]) / (more + less)));
    const [x, y] = slopes.map(([more, less], axis) => (edges[axis][0] - edges[axis][1] + (less - more) * depth) / 2);
    const middle = placed.reduce((sum, at) => sum + at[2], 0) / placed.length;
    this.distance = depth - middle;
    this.target = [0, 1, 2].map((i) => x * right[i] + y * up[i] + middle * this.back[i]);
    this.framedFor = aspect;
  }

  /** The view is the reader's own from now on: another size of the picture does not frame it anew. */
  #leave() {
    this.framedFor = null;
    this.side = null;
  }

  /** @param {number} right pixels @param {number} down pixels */
  turn(right, down) {
    this.#leave();
    this.azimuth -= right * TURN_PER_PIXEL;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + down * TURN_PER_PIXEL));
    this.changed();
  }

  /** Move the target with the pointer. @param {number} right pixels @param {number} down @param {number} height of the picture */
  pan(right, down, height) {
    this.#leave();
    const scale = (this.distance * 2 * this.tangent) / height;
    const axes = this.#axes();
    this.target = addScaled(addScaled(this.target, axes.right, -scale * right), axes.up, scale * down);
    this.changed();
  }

  /**
   * Go nearer or away, towards what is under the pointer.
   * @param {number} factor above 1 goes away @param {number[]} [at] from the middle of the picture, in half heights: right and up
   */
  zoom(factor, at = [0, 0]) {
    this.#leave();
    const distance = Math.max(0.02, Math.min(30, this.distance * factor));
    const moved = (this.distance - distance) * this.tangent;
    const axes = this.#axes();
    this.target = addScaled(addScaled(this.target, axes.right, moved * at[0]), axes.up, moved * at[1]);
    this.distance = distance;
    this.changed();
  }
}

/** Where an event is, from the middle of a canvas in half heights: right and up. */
export function placeOf(canvas, { offsetX, offsetY }) {
  const half = canvas.clientHeight / 2;
  return [(offsetX - canvas.clientWidth / 2) / half, 1 - offsetY / half];
}
