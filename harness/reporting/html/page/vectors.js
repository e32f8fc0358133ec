// Small linear algebra: vectors are arrays of three numbers, matrices column-major Float32Array(16).

/** @typedef {[number, number, number]} Vector */
/** @typedef {Float32Array} Matrix */

export const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b @returns {Vector} */
export function subtract(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** a + factor * b. @param {ArrayLike<number>} a @param {ArrayLike<number>} b @param {number} factor @returns {Vector} */
export function addScaled(a, b, factor) {
  return [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
}

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b */
export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b @returns {Vector} */
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {ArrayLike<number>} a @returns {Vector} */
export function normalize(a) {
  const length = Math.hypot(a[0], a[1], a[2]) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
}

/** @param {Matrix} a @param {Matrix} b @returns {Matrix} */
export function multiply(a, b) {
  const product = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      product[4 * column + row] = sum;
    }
  }
  return product;
}

/** @param {Matrix} m @param {ArrayLike<number>} point @returns {Vector} */
export function transformPoint(m, point) {
  const [x, y, z] = [point[0], point[1], point[2]];
  return [
    m[0] * x + m[4] * y + m[8] * z + m[12],
    m[1] * x + m[5] * y + m[9] * z + m[13],
    m[2] * x + m[6] * y + m[10] * z + m[14],
  ];
}

/** Perspective projection. @param {number} fieldOfView vertical [rad] @returns {Matrix} */
export function perspective(fieldOfView, aspect, near, far) {
  const f = 1 / Math.tan(fieldOfView / 2);
  const depth = 1 / (near - far);
  return new Float32Array([
    f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0,
  ]);
}

/** Parallel projection of a square. @param {number} half half its side @returns {Matrix} */
export function orthographic(half, near, far) {
  const depth = 1 / (near - far);
  return new Float32Array([
    1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 2 * depth, 0, 0, 0, (far + near) * depth, 1,
  ]);
}

/** View matrix of an eye that looks at a target. @param {Vector} eye @param {Vector} target @param {Vector} up @returns {Matrix} */
export function lookAt(eye, target, up) {
  const z = normalize(subtract(eye, target));
  const x = normalize(cross(up, z));
  const y = cross(z, x);
  return new Float32Array([
    x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0,
    -dot(x, eye), -dot(y, eye), -dot(z, eye), 1,
  ]);
}

/** Homogeneous matrix of a pose: xyz, then quaternion wxyz of any length. @param {ArrayLike<number>} pose @returns {Matrix} */
export function poseMatrix(pose) {
  const scale = 1 / (Math.hypot(pose[3], pose[4], pose[5], pose[6]) || 1);
  const [w, x, y, z] = [pose[3] * scale, pose[4] * scale, pose[5] * scale, pose[6] * scale];
  return new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
    2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
    2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0,
    pose[0], pose[1], pose[2], 1,
  ]);
}
