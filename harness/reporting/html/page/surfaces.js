// Bodies of triangles, lit by the sun; translucent ones are drawn last, the farthest first.

import { compile } from "./gl_program.js";
import { SURFACE } from "./shaders.js";
import { SUN } from "./shadow.js";
import { IDENTITY } from "./vectors.js";

const SOLID = 0.99; // opacity from which on nothing is seen through

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
/** @typedef {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}} Mesh */
/** @typedef {Surface & {mesh: Mesh, vertexArray: WebGLVertexArrayObject, count: number}} Shape */

export class Surfaces {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    /** @type {Shape[]} */
    this.all = [];
  }

  /** Put everything on the graphics card, at first and after the card has lost it. */
  prepare() {
    this.program = compile(this.gl, SURFACE);
    const arrays = new Map(this.all.map(({ mesh }) => [mesh, null]));
    for (const mesh of arrays.keys()) arrays.set(mesh, this.#upload(mesh));
    for (const each of this.all) each.vertexArray = arrays.get(each.mesh);
  }

  /** @param {Mesh} mesh @param {number[]} color rgba @param {Partial<Surface>} options @returns {Surface} */
  add(mesh, color, options) {
    const surface = {
      mesh, vertexArray: this.#upload(mesh), count: mesh.indices.length, color, model: IDENTITY,
      visible: true, castsShadow: color[3] > SOLID, grid: 0, glow: 0, ...options,
    };
    this.all.push(surface);
    return surface;
  }

  /** @param {Mesh} mesh */
  #upload({ positions, normals, indices }) {
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
    return vertexArray;
  }

  /** Another surface with the same triangles. @param {Surface} surface @param {Partial<Surface>} options @returns {Surface} */
  addCopy(surface, options) {
    const copy = { .../** @type {Shape} */ (surface), ...options };
    this.all.push(copy);
    return copy;
  }

  /** Draw a surface no more; its triangles stay as long as copies use them. @param {Surface} surface */
  remove(surface) {
    this.all = this.all.filter((each) => each !== surface);
    const { vertexArray } = /** @type {Shape} */ (surface);
    if (!this.all.some((each) => each.vertexArray === vertexArray)) this.gl.deleteVertexArray(vertexArray);
  }

  /**
   * @param {Shape[]} shown @param {import("./vectors.js").Matrix} view @param {ArrayLike<number>} eye
   * @param {import("./shadow.js").Shadow} shadow @param {{background: number[], ambient: number, outline: number}} look
   */
  draw(shown, view, eye, shadow, { background, ambient, outline }) {
    const { gl, program: { program, at } } = this;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniformMatrix4fv(at.sun, false, shadow.matrix);
    gl.uniform3fv(at.eye, eye);
    gl.uniform3fv(at.sunDirection, SUN);
    gl.uniform3fv(at.gridCenter, shadow.bounds.center);
    gl.uniform4fv(at.fog, [...background, 1]);
    gl.uniform1f(at.ambient, ambient);
    gl.uniform1f(at.outline, outline);
    gl.bindTexture(gl.TEXTURE_2D, shadow.map);
    const distance = ({ model }) => Math.hypot(model[12] - eye[0], model[13] - eye[1], model[14] - eye[2]);
    const isSolid = ({ color }) => color[3] > SOLID;
    for (const surface of shown.filter(isSolid)) this.#drawOne(surface);
    const translucent = shown.filter((surface) => !isSolid(surface)).sort((a, b) => distance(b) - distance(a));
    if (translucent.length) this.#drawTranslucent(translucent);
  }

  /** The depth of each alone first: then only its front is seen, not all of its folds. */
  #drawTranslucent(surfaces) {
    const { gl } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    for (const surface of surfaces) {
      gl.polygonOffset(surface.recedes ? 1 : 0, surface.recedes ? 2 : 0);
      gl.colorMask(false, false, false, false);
      this.#drawOne(surface);
      gl.colorMask(true, true, true, true);
      this.#drawOne(surface);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.depthFunc(gl.LESS);
  }

  #drawOne(surface) {
    const { gl, program: { at } } = this;
    gl.uniformMatrix4fv(at.model, false, surface.model);
    gl.uniform4fv(at.color, surface.color);
    gl.uniform1f(at.grid, surface.grid);
    gl.uniform1f(at.glow, surface.glow);
    gl.bindVertexArray(surface.vertexArray);
    gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
  }
}
