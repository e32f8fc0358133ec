// Draws posed bodies and lines with WebGL2: a sun with a soft shadow, translucent bodies last.

import { lineAttributes, lineVertices, VERTICES_PER_SEGMENT } from "./lines.js";
import { LINE, SHADOW, SKY, SURFACE } from "./shaders.js";
import { addScaled, lookAt, multiply, normalize, orthographic, transformPoint } from "./vectors.js";

const SHADOW_SIZE = 2048; // [pixels], as the shader divides by
const SLOW = 25; // [ms]
const COARSE = 0.55; // of the pixels along each side
const LOWEST = 360; // [pixels]: in pictures that are less high, lines in pixels shrink with them
const SUN = normalize([0.35, -0.45, 0.9]);
const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/**
 * @typedef {object} Surface
 * @property {Float32Array} model T_world_shape, set by whoever moves it
 * @property {number[]} color rgba
 * @property {boolean} visible
 * @property {boolean} castsShadow
 * @property {number} grid 1 for a floor with lines, else 0
 * @property {number} glow 0 to 1: lit from inside
 * @property {boolean} [isUntouchable] clicks go through it
 * @property {boolean} [recedes] a translucent one is hidden by what is solid at the same place
 */
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
    /** @type {(Surface & {vertexArray: WebGLVertexArrayObject, count: number})[]} */
    this.surfaces = [];
    /** @type {(Line & {vertexArray: WebGLVertexArrayObject, buffer: WebGLBuffer})[]} */
    this.lines = [];
    /** Buffers of small pictures by size. @type {Map<string, WebGLFramebuffer>} */
    this.small = new Map();
    this.background = [1, 1, 1];
    /** Colour of the sky above; null for one as the horizon. @type {number[] | null} */
    this.zenith = null;
    this.ambient = 1;
    this.outline = 0.1; // how bright the edges of bodies are
    this.isDirty = this.hasMoved = true;
    this.isCoarse = false;
    this.drawn = 0;
    this.cost = 0; // of a picture, once measured [ms]
    this.surfaceProgram = program(gl, SURFACE);
    this.shadowProgram = program(gl, SHADOW);
    this.lineProgram = program(gl, LINE);
    this.skyProgram = program(gl, SKY);
    this.#makeShadowMap();
    this.cover(bounds);
    new ResizeObserver(() => this.redraw()).observe(host);
  }

  /** What the sun's shadow covers. @param {{center: number[], radius: number}} bounds [m] */
  cover(bounds) {
    this.bounds = bounds;
    const distance = 3 * bounds.radius;
    this.sun = multiply(
      orthographic(bounds.radius, distance - bounds.radius * 1.5, distance + bounds.radius * 1.5),
      lookAt(addScaled(bounds.center, SUN, distance), /** @type {any} */ (bounds.center), [0, 1, 0]),
    );
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

  /**
   * @param {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}} mesh
   * @param {number[]} color rgba @param {Partial<Surface>} [options] @returns {Surface}
   */
  addSurface({ positions, normals, indices }, color, options = {}) {
    const { gl } = this;
    const vertexArray = gl.createVertexArray();
    gl.bindVertexArray(vertexArray);
    for (const [location, data] of [[0, positions], [1, normals]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, /** @type {Float32Array} */ (data), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(/** @type {number} */ (location));
      gl.vertexAttribPointer(/** @type {number} */ (location), 3, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    const surface = {
      vertexArray, count: indices.length, color, model: IDENTITY,
      visible: true, castsShadow: color[3] > 0.99, grid: 0, glow: 0, ...options,
    };
    this.surfaces.push(surface);
    return surface;
  }

  /** Another surface with the same triangles. @param {Surface} surface @param {Partial<Surface>} options @returns {Surface} */
  addCopy(surface, options) {
    const copy = { .../** @type {any} */ (surface), ...options };
    this.surfaces.push(copy);
    return copy;
  }

  /** Draw a surface no more; its triangles stay as long as copies use them. @param {Surface} surface */
  removeSurface(surface) {
    this.surfaces = this.surfaces.filter((each) => each !== surface);
    const { vertexArray } = /** @type {any} */ (surface);
    if (!this.surfaces.some((each) => each.vertexArray === vertexArray)) this.gl.deleteVertexArray(vertexArray);
    this.moved();
  }

  /** @param {ArrayLike<number>} points x, y, z of each @param {Partial<Line>} options @returns {Line} */
  addLine(points, options) {
    const { gl } = this;
    const vertexArray = gl.createVertexArray();
    const buffer = gl.createBuffer();
    gl.bindVertexArray(vertexArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    lineAttributes(gl);
    const line = {
      vertexArray, buffer, color: [0, 0, 0, 1], width: 2, dash: 0, visible: true, onTop: false,
      first: 0, segments: 0, model: IDENTITY, pixels: 0, ...options,
    };
    this.lines.push(line);
    this.setPoints(line, points);
    return line;
  }

  /** Give a line other points. @param {Line} line @param {ArrayLike<number>} points */
  setPoints(line, points) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, /** @type {any} */ (line).buffer);
    gl.bufferData(gl.ARRAY_BUFFER, lineVertices(points), gl.DYNAMIC_DRAW);
    line.segments = Math.max(0, points.length / 3 - 1);
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
    const { gl } = this;
    const { width, height } = target;
    const buffer = this.#smallBuffer(width, height);
    this.#drawAt(orbit, buffer, width, height, 1);
    const pixels = new Uint8ClampedArray(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const upright = new ImageData(width, height);
    for (let row = 0; row < height; row++) {
      upright.data.set(pixels.subarray(4 * width * row, 4 * width * (row + 1)), 4 * width * (height - 1 - row));
    }
    target.getContext("2d").putImageData(upright, 0, 0);
  }

  /** The surface at a place of the picture; null where there is none. @param {import("./orbit.js").Orbit} orbit @param {number} x CSS pixels @param {number} y @returns {Surface | null} */
  pick(orbit, x, y) {
    const { gl, shadowProgram: { program, at } } = this;
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
    const toPixel = new Float32Array([width, 0, 0, 0, 0, height, 0, 0, 0, 0, 1, 0, width - 2 * x, 2 * y - height, 0, 1]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.#smallBuffer(1, 1));
    gl.viewport(0, 0, 1, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.sun, false, multiply(toPixel, orbit.matrix(width / height)));
    this.surfaces.forEach((surface, index) => {
      if (!surface.visible || surface.isUntouchable) return;
      const number = index + 1;
      gl.uniform4f(at.color, (number & 255) / 255, ((number >> 8) & 255) / 255, 0, 1);
      gl.uniformMatrix4fv(at.model, false, surface.model);
      gl.bindVertexArray(surface.vertexArray);
      gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    });
    const found = new Uint8Array(4);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, found);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return this.surfaces[found[0] + 256 * found[1] - 1] ?? null;
  }

  /** Where a point of the world is on the canvas, in CSS pixels; null for points behind the camera. @param {import("./orbit.js").Orbit} orbit @param {ArrayLike<number>} point */
  project(orbit, point) {
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
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
    if (this.hasMoved) this.#drawShadows(shown);
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
    this.#drawSurfaces(shown, view, orbit.eye);
    this.#drawLines(view, width, height, ratio, orbit.tangent);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  #drawSky(orbit) {
    const { gl, skyProgram: { program, at } } = this;
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(program);
    gl.uniform3fv(at.low, this.background);
    gl.uniform3fv(at.high, this.zenith);
    gl.uniform1f(at.horizon, Math.tan(orbit.elevation) / orbit.tangent);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.enable(gl.DEPTH_TEST);
  }

  #smallBuffer(width, height) {
    const { gl } = this;
    const size = `${width} x ${height}`;
    if (this.small.has(size)) return this.small.get(size);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    for (const [format, attachment] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      const store = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, store);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, store);
    }
    this.small.set(size, buffer);
    return buffer;
  }

  #drawShadows(shown) {
    const { gl, shadowProgram } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(shadowProgram.program);
    gl.uniformMatrix4fv(shadowProgram.at.sun, false, this.sun);
    for (const surface of shown) {
      if (!surface.castsShadow) continue;
      gl.uniformMatrix4fv(shadowProgram.at.model, false, surface.model);
      gl.bindVertexArray(surface.vertexArray);
      gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  #drawSurfaces(shown, view, eye) {
    const { gl } = this;
    const { at } = this.surfaceProgram;
    gl.useProgram(this.surfaceProgram.program);
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniformMatrix4fv(at.sun, false, this.sun);
    gl.uniform3fv(at.eye, eye);
    gl.uniform3fv(at.sunDirection, SUN);
    gl.uniform3fv(at.gridCenter, this.bounds.center);
    gl.uniform4fv(at.fog, [...this.background, 1]);
    gl.uniform1f(at.ambient, this.ambient);
    gl.uniform1f(at.outline, this.outline);
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    const distance = ({ model }) => Math.hypot(model[12] - eye[0], model[13] - eye[1], model[14] - eye[2]);
    const solid = shown.filter((surface) => surface.color[3] > 0.99);
    const translucent = shown.filter((surface) => surface.color[3] <= 0.99);
    translucent.sort((a, b) => distance(b) - distance(a));
    for (const surface of [...solid, ...translucent]) {
      if (surface === translucent[0]) {
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthFunc(gl.LEQUAL);
        gl.enable(gl.POLYGON_OFFSET_FILL);
      }
      gl.polygonOffset(surface.recedes ? 1 : 0, surface.recedes ? 2 : 0);
      gl.uniformMatrix4fv(at.model, false, surface.model);
      gl.uniform4fv(at.color, surface.color);
      gl.uniform1f(at.grid, surface.grid);
      gl.uniform1f(at.glow, surface.glow);
      gl.bindVertexArray(surface.vertexArray);
      if (surface.color[3] <= 0.99) {
        // its depth alone first: then only its front is seen, not all of its folds
        gl.colorMask(false, false, false, false);
        gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
        gl.colorMask(true, true, true, true);
      }
      gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.depthFunc(gl.LESS);
  }

  #drawLines(view, width, height, ratio, tangent) {
    const { gl } = this;
    const pixel = (2 * tangent) / Math.max(height / ratio, LOWEST); // [m] at a distance of 1 m
    const { at } = this.lineProgram;
    gl.useProgram(this.lineProgram.program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniform2f(at.resolution, width / 2, height / 2);
    for (const line of this.lines) {
      if (!line.visible || line.segments < 1) continue;
      (line.onTop ? gl.disable : gl.enable).call(gl, gl.DEPTH_TEST);
      gl.uniformMatrix4fv(at.model, false, line.pixels ? scaled(line.model, line.pixels * pixel * depthOf(view, line.model)) : line.model);
      gl.uniform4fv(at.color, line.color);
      gl.uniform1f(at.width, (line.width * ratio) / 2);
      gl.uniform1f(at.dash, line.dash);
      gl.bindVertexArray(/** @type {any} */ (line).vertexArray);
      gl.drawArrays(gl.TRIANGLES, line.first * VERTICES_PER_SEGMENT, line.segments * VERTICES_PER_SEGMENT);
    }
  }

  #makeShadowMap() {
    const { gl } = this;
    this.shadowMap = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.shadowMap);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
    const settings = [
      [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ];
    for (const [name, value] of settings) gl.texParameteri(gl.TEXTURE_2D, name, value);
    this.shadowBuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowBuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.shadowMap, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
}

/** A pose with another unit of length. @param {Float32Array} model @param {number} unit */
function scaled(model, unit) {
  return model.map((value, i) => (i < 12 ? value * unit : value));
}

/** How far before the eye a pose is [m]. @param {Float32Array} view @param {Float32Array} model */
function depthOf(view, model) {
  return Math.abs(view[3] * model[12] + view[7] * model[13] + view[11] * model[14] + view[15]);
}

/** Compile a program. @returns {{program: WebGLProgram, at: Record<string, WebGLUniformLocation>}} */
function program(gl, source) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, source.vertex], [gl.FRAGMENT_SHADER, source.fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const at = {};
  for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(made, i);
    at[name] = gl.getUniformLocation(made, name);
  }
  return { program: made, at };
}
