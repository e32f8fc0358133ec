// Polylines with a width in pixels, drawn as triangles.

import { compile } from "./gl_program.js";
import { LINE } from "./shaders.js";
import { IDENTITY } from "./vectors.js";

const FLOATS = 9; // from, to, corner (end, side), length along
const CORNERS = [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]];
const LAYOUT = [[0, 3, 0], [1, 3, 12], [2, 2, 24], [3, 1, 32]]; // location, size, offset [bytes]
const LOWEST = 360; // [pixels]: in pictures that are less high, lines in pixels shrink with them

/**
 * @typedef {object} Line
 * @property {number[]} color rgba
 * @property {number} width [pixels]
 * @property {number} dash length of a dash and its gap [m]; 0 draws it whole
 * @property {boolean} visible
 * @property {boolean} onTop drawn over everything
 * @property {number} first segment that is drawn
 * @property {number} segments how many are drawn
 * @property {Float32Array} model T_world_line
 * @property {number} pixels length of its unit on the screen [pixels]; 0 for one in metres
 */

export class Lines {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    /** @type {(Line & {points: ArrayLike<number>, vertexArray: WebGLVertexArrayObject, buffer: WebGLBuffer})[]} */
    this.all = [];
  }

  /** Put everything on the graphics card, at first and after the card has lost it. */
  prepare() {
    this.program = compile(this.gl, LINE);
    for (const line of this.all) {
      const { points, segments } = line;
      this.setPoints(Object.assign(line, this.#buffer()), points);
      line.segments = segments;
    }
  }

  /** @param {ArrayLike<number>} points x, y, z of each @param {Partial<Line>} options @returns {Line} */
  add(points, options) {
    const line = {
      ...this.#buffer(), points, color: [0, 0, 0, 1], width: 2, dash: 0, visible: true, onTop: false,
      first: 0, segments: 0, model: IDENTITY, pixels: 0, ...options,
    };
    this.all.push(line);
    this.setPoints(line, points);
    return line;
  }

  #buffer() {
    const { gl } = this;
    const [vertexArray, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    gl.bindVertexArray(vertexArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const [location, size, offset] of LAYOUT) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * FLOATS, offset);
    }
    return { vertexArray, buffer };
  }

  /** Give a line other points. @param {Line} line @param {ArrayLike<number>} points */
  setPoints(line, points) {
    const { gl } = this;
    Object.assign(line, { points });
    gl.bindBuffer(gl.ARRAY_BUFFER, /** @type {any} */ (line).buffer);
    gl.bufferData(gl.ARRAY_BUFFER, vertices(points), gl.DYNAMIC_DRAW);
    line.segments = Math.max(0, points.length / 3 - 1);
  }

  /**
   * @param {import("./vectors.js").Matrix} view @param {number} width @param {number} height [pixels]
   * @param {number} ratio pixels in one of CSS @param {number} tangent of half the field of view
   */
  draw(view, width, height, ratio, tangent) {
    const { gl, program: { program, at } } = this;
    const pixel = (2 * tangent) / Math.max(height / ratio, LOWEST); // [m] at a distance of 1 m
    gl.useProgram(program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniform2f(at.resolution, width / 2, height / 2);
    for (const line of this.all) {
      if (!line.visible || line.segments < 1) continue;
      (line.onTop ? gl.disable : gl.enable).call(gl, gl.DEPTH_TEST);
      const unit = line.pixels ? line.pixels * pixel * depthOf(view, line.model) : 1;
      gl.uniformMatrix4fv(at.model, false, unit === 1 ? line.model : scaled(line.model, unit));
      gl.uniform4fv(at.color, line.color);
      gl.uniform1f(at.width, (line.width * ratio) / 2);
      gl.uniform1f(at.dash, line.dash);
      gl.bindVertexArray(line.vertexArray);
      gl.drawArrays(gl.TRIANGLES, line.first * CORNERS.length, line.segments * CORNERS.length);
    }
  }
}

/** Six vertices for each segment; a point that is not finite interrupts the line. @param {ArrayLike<number>} points x, y, z of each */
function vertices(points) {
  const count = Math.max(0, points.length / 3 - 1);
  const found = new Float32Array(count * CORNERS.length * FLOATS);
  let [at, along] = [0, 0];
  for (let i = 0; i < count; i++) {
    const a = 3 * i;
    const length = Math.hypot(points[a + 3] - points[a], points[a + 4] - points[a + 1], points[a + 5] - points[a + 2]);
    const isGap = !Number.isFinite(length);
    for (const [end, side] of CORNERS) {
      if (!isGap) {
        found.set([points[a], points[a + 1], points[a + 2], points[a + 3], points[a + 4], points[a + 5]], at);
        found.set([end, side, along + end * length], at + 6);
      }
      at += FLOATS;
    }
    if (!isGap) along += length;
  }
  return found;
}

/** A pose with another unit of length. @param {Float32Array} model @param {number} unit */
function scaled(model, unit) {
  return model.map((value, i) => (i < 12 ? value * unit : value));
}

/** How far before the eye a pose is [m]. @param {Float32Array} view @param {Float32Array} model */
function depthOf(view, model) {
  return Math.abs(view[3] * model[12] + view[7] * model[13] + view[11] * model[14] + view[15]);
}
