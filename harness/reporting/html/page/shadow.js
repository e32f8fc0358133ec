// The sun: its direction, and a map of what it does not reach.

import { compile } from "./gl_program.js";
import { SHADOW } from "./shaders.js";
import { addScaled, lookAt, multiply, normalize, orthographic } from "./vectors.js";

const SIZE = 2048; // [pixels], as the shader of surfaces divides by
export const SUN = normalize([0.35, -0.45, 0.9]);

export class Shadow {
  /** @param {WebGL2RenderingContext} gl @param {{center: number[], radius: number}} bounds what is covered [m] */
  constructor(gl, bounds) {
    this.gl = gl;
    this.program = compile(gl, SHADOW);
    this.map = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SIZE, SIZE);
    const settings = [
      [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ];
    for (const [name, value] of settings) gl.texParameteri(gl.TEXTURE_2D, name, value);
    this.buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.map, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.cover(bounds);
  }

  /** What the shadow covers. @param {{center: number[], radius: number}} bounds [m] */
  cover(bounds) {
    this.bounds = bounds;
    const distance = 3 * bounds.radius;
    /** From the world to the map. */
    this.matrix = multiply(
      orthographic(bounds.radius, distance - bounds.radius * 1.5, distance + bounds.radius * 1.5),
      lookAt(addScaled(bounds.center, SUN, distance), /** @type {any} */ (bounds.center), [0, 1, 0]),
    );
  }

  /** Draw the map anew. @param {import("./surfaces.js").Shape[]} surfaces */
  draw(surfaces) {
    const { gl, program: { program, at } } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.buffer);
    gl.viewport(0, 0, SIZE, SIZE);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.sun, false, this.matrix);
    for (const surface of surfaces) {
      if (!surface.castsShadow) continue;
      gl.uniformMatrix4fv(at.model, false, surface.model);
      gl.bindVertexArray(surface.vertexArray);
      gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
}
