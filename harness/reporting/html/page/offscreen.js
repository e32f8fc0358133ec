// Pictures that are not shown: small copies of the scene, and which body is at a place of it.

import { multiply } from "./vectors.js";

export class Offscreen {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    /** By size. @type {Map<string, WebGLFramebuffer>} */
    this.buffers = new Map();
  }

  /** A buffer of a size, which stays. @param {number} width @param {number} height [pixels] */
  buffer(width, height) {
    const { gl } = this;
    const size = `${width} x ${height}`;
    if (this.buffers.has(size)) return this.buffers.get(size);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    for (const [format, attachment] of [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      const store = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, store);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, store);
    }
    this.buffers.set(size, buffer);
    return buffer;
  }

  /** Put what a buffer holds on a canvas of its size. @param {HTMLCanvasElement} target */
  copyTo(target) {
    const { gl } = this;
    const { width, height } = target;
    const pixels = new Uint8ClampedArray(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffer(width, height));
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const upright = new ImageData(width, height);
    for (let row = 0; row < height; row++) {
      upright.data.set(pixels.subarray(4 * width * row, 4 * width * (row + 1)), 4 * width * (height - 1 - row));
    }
    target.getContext("2d").putImageData(upright, 0, 0);
  }

  /**
   * The surface at a place of the picture; null where there is none. Each is drawn in a colour of its own.
   * @param {import("./surfaces.js").Shape[]} surfaces @param {import("./gl_program.js").Program} program
   * @param {import("./vectors.js").Matrix} view @param {[number, number]} size of the picture @param {[number, number]} place both in CSS pixels
   */
  pick(surfaces, { program, at }, view, [width, height], [x, y]) {
    const { gl } = this;
    const toPixel = new Float32Array([width, 0, 0, 0, 0, height, 0, 0, 0, 0, 1, 0, width - 2 * x, 2 * y - height, 0, 1]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffer(1, 1));
    gl.viewport(0, 0, 1, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.sun, false, multiply(toPixel, view));
    surfaces.forEach((surface, index) => {
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
    return surfaces[found[0] + 256 * found[1] - 1] ?? null;
  }
}
