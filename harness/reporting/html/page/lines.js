// Polylines with a width in pixels, as triangles for the line program.

/** @typedef {import("./vectors.js").Matrix} Matrix */

const FLOATS = 9; // from, to, corner (end, side), length along
const CORNERS = [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]];
export const VERTICES_PER_SEGMENT = CORNERS.length;

/**
 * @param {ArrayLike<number>} points x, y, z of each; a point that is not finite interrupts the line
 * @returns {Float32Array} six vertices for each segment
 */
export function lineVertices(points) {
  const count = Math.max(0, points.length / 3 - 1);
  const vertices = new Float32Array(count * VERTICES_PER_SEGMENT * FLOATS);
  let at = 0;
  let along = 0;
  for (let i = 0; i < count; i++) {
    const a = 3 * i;
    const length = Math.hypot(points[a + 3] - points[a], points[a + 4] - points[a + 1], points[a + 5] - points[a + 2]);
    const isGap = !Number.isFinite(length);
    for (const [end, side] of CORNERS) {
      if (!isGap) {
        vertices.set([points[a], points[a + 1], points[a + 2], points[a + 3], points[a + 4], points[a + 5]], at);
        vertices.set([end, side, along + end * length], at + 6);
      }
      at += FLOATS;
    }
    if (!isGap) along += length;
  }
  return vertices;
}

/** Describe the vertex layout to a vertex array. @param {WebGL2RenderingContext} gl */
export function lineAttributes(gl) {
  const parts = [[0, 3, 0], [1, 3, 12], [2, 2, 24], [3, 1, 32]];
  for (const [location, size, offset] of parts) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * FLOATS, offset);
  }
}
