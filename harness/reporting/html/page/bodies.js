// The surfaces of a body's shapes.

import { creased } from "./normals.js";
import { primitive, square } from "./shapes.js";
import { poseMatrix } from "./vectors.js";

export const CREASE = { mesh: 0.76, shape: 0.9 }; // cosines
const FLOOR_SIZE = 12; // half its side [m]

/**
 * @param {import("./viewer.js").Viewer} viewer @param {ShapeHead} shape
 * @param {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}[]} meshes
 * @param {boolean} isGhost drawn translucent @param {Partial<import("./surfaces.js").Surface>} [more]
 * @returns {{local: Float32Array, surface: import("./surfaces.js").Surface}[]} each with T_body_shape
 */
export function surfacesOf(viewer, shape, meshes, isGhost, more = {}) {
  const local = poseMatrix(shape.pose);
  const color = [...shape.color];
  if (isGhost) color[3] = Math.min(color[3], 0.34);
  const options = { castsShadow: !isGhost && color[3] > 0.99, ...more };
  const add = (mesh, tint, other = {}) => ({ local, surface: viewer.addSurface(mesh, tint, { ...options, ...other }) });
  if (shape.kind === "mesh") {
    return shape.parts.map(([mesh, tint]) => add(meshes[mesh], tint && !isGhost ? tint : [...(tint ?? color).slice(0, 3), color[3]]));
  }
  if (shape.kind === "plane") {
    const { positions, indices } = square(FLOOR_SIZE);
    return [add(creased(positions, indices, 0), [...color.slice(0, 3), 1], { grid: 1, castsShadow: false })];
  }
  const { positions, indices } = primitive(shape);
  return [add(creased(positions, indices, CREASE.shape), color)];
}
