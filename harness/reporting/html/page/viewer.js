// A picture of posed bodies and lines with WebGL2, drawn when something has changed.

import { compile } from "./gl_program.js";
import { Lines } from "./lines.js";
import { Offscreen } from "./offscreen.js";
import { SKY } from "./shaders.js";
import { Shadow } from "./shadow.js";
import { Surfaces } from "./surfaces.js";
import { transformPoint } from "./vectors.js";

const SLOW = 25; // [ms]
const COARSE = 0.55; // of the pixels along each side

export class Viewer {
  /**
   * @param {HTMLElement} host is filled by the picture
   * @param {{center: number[], radius: number}} bounds what the shadow covers [m]
   */
  constructor(host, bounds) {
    this.host = host;
    this.onChange = () => {}; // called when draw is due
    /** Shows what each half of the picture holds, where there are two. @type {(() => void)[] | null} */
    this.halves = null;
    this.onDrawn = () => {}; // called when what lies over the picture has to follow it
    this.canvas = document.createElement("canvas");
    const gl = this.canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("WebGL2 is not available");
    this.gl = gl;
    host.prepend(this.canvas);
    this.background = [1, 1, 1];
    /** Colour of the sky above; null for one as the horizon. @type {number[] | null} */
    this.zenith = null;
    this.ambient = 1;
    this.outline = 0.1; // how bright the edges of bodies are
    this.isDirty = this.hasMoved = true;
    this.isCoarse = false;
    this.drawn = 0;
    this.cost = 0; // of a picture, once measured [ms]
    this.bodies = new Surfaces(gl);
    this.lines = new Lines(gl);
    this.#prepare(bounds);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault()); // so that it is restored
    this.canvas.addEventListener("webglcontextrestored", () => this.#prepare(this.shadow.bounds));
    new ResizeObserver(() => this.redraw()).observe(host);
  }

  /** Put everything on the graphics card, at first and after the card has lost it. @param {{center: number[], radius: number}} bounds */
  #prepare(bounds) {
    const { gl } = this;
    this.shadow = new Shadow(gl, bounds);
    this.bodies.prepare();
    this.lines.prepare();
    this.offscreen = new Offscreen(gl);
    this.sky = compile(gl, SKY);
    this.moved();
  }

  /** What the sun's shadow covers. @param {{center: number[], radius: number}} bounds [m] */
  cover(bounds) {
    this.shadow.cover(bounds);
  }

  /** Have the picture drawn at the next chance. */
  redraw() {
    this.isDirty = true;
    this.onChange();
  }

  /** Have the shadows drawn anew too: something has moved. */
  moved() {
    this.hasMoved = true;
    this.redraw();
  }

  /** Every surface, in the order in which they were added. */
  get surfaces() {
    return this.bodies.all;
  }

  /**
   * @param {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}} mesh
   * @param {number[]} color rgba @param {Partial<import("./surfaces.js").Surface>} [options]
   */
  addSurface(mesh, color, options = {}) {
    return this.bodies.add(mesh, color, options);
  }

  /** Another surface with the same triangles. @param {import("./surfaces.js").Surface} surface @param {Partial<import("./surfaces.js").Surface>} options */
  addCopy(surface, options) {
    return this.bodies.addCopy(surface, options);
  }

  /** Draw a surface no more. @param {import("./surfaces.js").Surface} surface */
  removeSurface(surface) {
    this.bodies.remove(surface);
    this.moved();
  }

  /** @param {ArrayLike<number>} points x, y, z of each @param {Partial<import("./lines.js").Line>} options */
  addLine(points, options) {
    this.redraw();
    return this.lines.add(points, options);
  }

  /** Give a line other points. @param {import("./lines.js").Line} line @param {ArrayLike<number>} points */
  setPoints(line, points) {
    this.lines.setPoints(line, points);
    this.redraw();
  }

  /**
   * Draw, if anything changed; while it moves in fewer pixels, where graphics are slow.
   * @param {import("./orbit.js").Orbit} orbit @param {boolean} isMoving
   */
  draw(orbit, isMoving) {
    const wasCoarse = this.isCoarse;
    this.isCoarse = isMoving && this.cost > SLOW;
    if (!this.isDirty && !(wasCoarse && !this.isCoarse)) return;
    const ratio = Math.min(devicePixelRatio, 2) * (this.isCoarse ? COARSE : 1);
    const [width, height] = [Math.round(this.host.clientWidth * ratio), Math.round(this.host.clientHeight * ratio)];
    if (!width || !height) return;
    this.isDirty = false;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const begin = performance.now();
    if (this.halves) this.#drawHalves(orbit, width, height, ratio);
    else this.#drawAt(orbit, null, width, height, ratio);
    this.onDrawn();
    if (this.cost === 0 && this.drawn++ > 0) {
      this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits
      this.cost = performance.now() - begin;
    }
  }

  /** Draw the scene as it is posed now on a small canvas. @param {import("./orbit.js").Orbit} orbit @param {HTMLCanvasElement} target */
  copyTo(orbit, target) {
    const { width, height } = target;
    this.#drawAt(orbit, this.offscreen.buffer(width, height), width, height, 1);
    this.offscreen.copyTo(target);
  }

  /** The surface at a place of the picture; null where there is none. @param {import("./orbit.js").Orbit} orbit @param {number} x CSS pixels @param {number} y */
  pick(orbit, x, y) {
    const { clientWidth: width, clientHeight: height } = this.host;
    return this.offscreen.pick(this.surfaces, this.shadow.program, orbit.matrix(width / height), [width, height], [x, y]);
  }

  /** Where a point of the world is on the canvas, in CSS pixels; null for points behind the camera. @param {import("./orbit.js").Orbit} orbit @param {ArrayLike<number>} point */
  project(orbit, point) {
    const { clientWidth: width, clientHeight: height } = this.host;
    const view = orbit.matrix(width / height);
    const [x, y] = transformPoint(view, point);
    const w = view[3] * point[0] + view[7] * point[1] + view[11] * point[2] + view[15];
    return w > 0 ? [(0.5 + (0.5 * x) / w) * width, (0.5 - (0.5 * y) / w) * height] : null;
  }

  #drawHalves(orbit, width, height, ratio) {
    const half = Math.floor(width / 2);
    this.halves.forEach((show, index) => {
      show();
      this.hasMoved = true;
      this.#drawAt(orbit, null, half, height, ratio, index * (width - half));
    });
  }

  #drawAt(orbit, buffer, width, height, ratio, left = 0) {
    const { gl } = this;
    const shown = this.surfaces.filter((surface) => surface.visible);
    if (this.hasMoved) this.shadow.draw(shown);
    this.hasMoved = false;
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.viewport(left, 0, width, height);
    gl.scissor(left, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.clearColor(this.background[0], this.background[1], this.background[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.disable(gl.SCISSOR_TEST);
    const view = orbit.matrix(width / height);
    if (this.zenith) this.#drawSky(orbit);
    this.bodies.draw(shown, view, orbit.eye, this.shadow, this);
    this.lines.draw(view, width, height, ratio, orbit.tangent);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  #drawSky(orbit) {
    const { gl, sky: { program, at } } = this;
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(program);
    gl.uniform3fv(at.low, this.background);
    gl.uniform3fv(at.high, this.zenith);
    gl.uniform1f(at.horizon, Math.tan(orbit.elevation) / orbit.tangent);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.enable(gl.DEPTH_TEST);
  }
}
