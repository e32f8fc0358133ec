// Triangles of the primitive shapes, centred as the scenario means them.

/** @typedef {{positions: Float32Array | number[], indices: Uint32Array | number[]}} Triangles */

const SEGMENTS = 48;
const HALF_TURN_STEPS = 12;

/** @param {ArrayLike<number>} size full size along x, y, z @returns {Triangles} */
function box(size) {
  const positions = [];
  for (let corner = 0; corner < 8; corner++) {
    for (let axis = 0; axis < 3; axis++) positions.push(((corner >> axis) & 1 ? 0.5 : -0.5) * size[axis]);
  }
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return { positions, indices: sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]) };
}

/** A profile of [radius, z] from bottom to top, turned about z. @param {[number, number][]} profile @returns {Triangles} */
function turned(profile) {
  const positions = [];
  const indices = [];
  const rows = profile.length;
  for (let segment = 0; segment < SEGMENTS; segment++) {
    const angle = (2 * Math.PI * segment) / SEGMENTS;
    for (const [radius, z] of profile) positions.push(radius * Math.cos(angle), radius * Math.sin(angle), z);
    const next = (segment + 1) % SEGMENTS;
    for (let row = 0; row < rows - 1; row++) {
      const [a, b] = [segment * rows + row, next * rows + row];
      if (profile[row][0] > 0) indices.push(a, b, a + 1);
      if (profile[row + 1][0] > 0) indices.push(a + 1, b, b + 1);
    }
  }
  return { positions, indices };
}

/** Half circles of a radius, pulled apart by a length. @param {number} radius @param {number} length @returns {[number, number][]} */
function roundProfile(radius, length) {
  /** @type {[number, number][]} */
  const profile = [];
  for (const side of [-1, 1]) {
    for (let step = 0; step <= HALF_TURN_STEPS; step++) {
      const angle = (Math.PI / 2) * (side < 0 ? step / HALF_TURN_STEPS - 1 : step / HALF_TURN_STEPS);
      if (side > 0 && step === 0 && length === 0) continue;
      profile.push([Math.max(0, radius * Math.cos(angle)), radius * Math.sin(angle) + (side * length) / 2]);
    }
  }
  profile[0][0] = profile[profile.length - 1][0] = 0;
  return profile;
}

/**
 * @param {ShapeHead} shape a primitive
 * @returns {Triangles}
 */
export function primitive(shape) {
  switch (shape.kind) {
    case "box":
      return box(shape.size);
    case "cylinder": {
      const half = shape.length / 2;
      return turned([[0, -half], [shape.radius, -half], [shape.radius, half], [0, half]]);
    }
    case "sphere":
      return turned(roundProfile(shape.radius, 0));
    case "capsule":
      return turned(roundProfile(shape.radius, shape.length));
    default:
      return { positions: [], indices: [] };
  }
}

/** A square in the plane z = 0. @param {number} half @returns {Triangles} */
export function square(half) {
  return { positions: [-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0], indices: [0, 1, 2, 0, 2, 3] };
}
