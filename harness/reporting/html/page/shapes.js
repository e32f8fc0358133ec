// Triangles of the primitive shapes, centred as the scenario means them.

/** @typedef {{positions: Float32Array | number[], indices: Uint32Array | number[]}} Triangles */

const SEGMENTS = 48;
const BEVEL = { most: 0.0015, share: 0.08 }; // [m], and of the shortest side
const HALF_TURN_STEPS = 12;

/**
 * A box whose edges are broken, so that they catch light: each corner is three vertices, one in each side.
 * @param {ArrayLike<number>} size full size along x, y, z @returns {Triangles}
 */
function box(size) {
  const bevel = Math.min(BEVEL.most, BEVEL.share * Math.min(size[0], size[1], size[2]));
  const positions = [];
  for (let corner = 0; corner < 8; corner++) {
    for (let side = 0; side < 3; side++) {
      for (let axis = 0; axis < 3; axis++) {
        const reach = size[axis] / 2 - (axis === side ? 0 : bevel);
        positions.push((corner >> axis) & 1 ? reach : -reach);
      }
    }
  }
  const indices = [];
  const quad = (a, b, c, d) => indices.push(a, b, c, a, c, d);
  for (let side = 0; side < 3; side++) {
    const [u, v] = [1 << ((side + 1) % 3), 1 << ((side + 2) % 3)];
    for (const end of [0, 1 << side]) {
      const at = (corner) => 3 * (end | corner) + side;
      if (end) quad(at(0), at(u), at(u | v), at(v));
      else quad(at(0), at(v), at(u | v), at(u));
    }
    const [one, two] = [(side + 1) % 3, (side + 2) % 3]; // the edges along this axis lie between these sides
    for (const edge of [0, u, v, u | v]) {
      const [a, b] = [edge, edge | (1 << side)];
      const isTurned = edge === 0 || edge === (u | v);
      if (isTurned) quad(3 * a + one, 3 * a + two, 3 * b + two, 3 * b + one);
      else quad(3 * a + two, 3 * a + one, 3 * b + one, 3 * b + two);
    }
  }
  for (let corner = 0; corner < 8; corner++) {
    const isOdd = ((corner & 1) + ((corner >> 1) & 1) + (corner >> 2)) % 2 === 1;
    indices.push(3 * corner, 3 * corner + (isOdd ? 1 : 2), 3 * corner + (isOdd ? 2 : 1));
  }
  return { positions, indices };
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
