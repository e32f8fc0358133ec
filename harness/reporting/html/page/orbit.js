// A camera that circles a point: mouse, touch and keyboard.

import { addScaled, lookAt, multiply, perspective } from "./vectors.js";

const FIELD_OF_VIEW = 0.7; // [rad]
const CLOSENESS = 0.84; // the corners of what is seen may touch the edge
const LIFT = 0.07; // of the radius: room for what is written over the picture's top
const TURN_PER_PIXEL = 0.008; // [rad]
const STEEPEST = 1.55; // [rad]

export class Orbit {
  /**
   * @param {{center: number[], radius: number}} focus what is to fill the picture [m]
   * @param {() => void} changed called when the view is another one
   */
  constructor(focus, changed) {
    this.home = {
      azimuth: -0.72,
      elevation: 0.42,
      distance: (CLOSENESS * focus.radius) / Math.sin(FIELD_OF_VIEW / 2),
      target: /** @type {number[]} */ ([focus.center[0], focus.center[1], focus.center[2] + LIFT * focus.radius]),
    };
    this.changed = changed;
    this.reset();
  }

  /** Look as at the beginning. */
  reset() {
    Object.assign(this, structuredClone(this.home));
    this.changed();
  }

  /** Where the eye is. @returns {import("./vectors.js").Vector} */
  get eye() {
    const flat = Math.cos(this.elevation);
    return addScaled(
      this.target,
      [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)],
      this.distance,
    );
  }

  /** Projection times view. @param {number} aspect width over height; a narrow picture steps back */
  matrix(aspect) {
    const angle = aspect >= 1 ? FIELD_OF_VIEW : 2 * Math.atan(Math.tan(FIELD_OF_VIEW / 2) / Math.sqrt(aspect));
    const lens = perspective(angle, aspect, Math.max(0.005, this.distance * 0.02), this.distance + 40);
    return multiply(lens, lookAt(this.eye, this.target, [0, 0, 1]));
  }

  /** @param {number} right pixels @param {number} down pixels */
  turn(right, down) {
    this.azimuth -= right * TURN_PER_PIXEL;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + down * TURN_PER_PIXEL));
    this.changed();
  }

  /** Move the target with the pointer. @param {number} right pixels @param {number} down @param {number} height of the picture */
  pan(right, down, height) {
    const scale = (this.distance * 2 * Math.tan(FIELD_OF_VIEW / 2)) / height;
    const [sin, cos] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [rise, flat] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    this.target[0] += scale * (sin * right - cos * rise * down);
    this.target[1] += scale * (-cos * right - sin * rise * down);
    this.target[2] += scale * flat * down;
    this.changed();
  }

  /** @param {number} factor above 1 goes away */
  zoom(factor) {
    this.distance = Math.max(0.05, Math.min(30, this.distance * factor));
    this.changed();
  }

  /** Take a canvas's pointer and keys. @param {HTMLCanvasElement} canvas */
  control(canvas) {
    const pointers = new Map();
    Object.defineProperty(this, "isHeld", { get: () => pointers.size > 0 });
    let spread = 0;
    canvas.style.touchAction = "none";
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => this.reset());
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    const release = (event) => {
      pointers.delete(event.pointerId);
      spread = 0;
      this.changed();
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointermove", (event) => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const [right, down] = [event.clientX - last[0], event.clientY - last[1]];
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pointers.size === 2) {
        const [a, b] = [...pointers.values()];
        const distance = Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (spread > 0) this.zoom(spread / distance);
        spread = distance;
        this.pan(right / 2, down / 2, canvas.clientHeight);
      } else if (event.buttons === 2 || event.shiftKey) {
        this.pan(right, down, canvas.clientHeight);
      } else {
        this.turn(right, down);
      }
    });
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(event.deltaY * 0.001));
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] };
      if (turns[event.key]) this.turn(...turns[event.key]);
      else if (event.key === "+") this.zoom(0.9);
      else if (event.key === "-") this.zoom(1.1);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }
}
