// Rotations: as people read them, and as handles turn bodies.

/** Roll, pitch and yaw [rad] of a quaternion w, x, y, z: turns about fixed x, then y, then z. */
export function eulerOf([w, x, y, z]) {
  const down = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  if (Math.abs(down) > 1 - 1e-9) return [2 * Math.atan2(x, w), (Math.PI / 2) * Math.sign(down), 0];
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(down), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

/** The rotation about a unit axis, as w, x, y, z. */
export const aboutAxis = (axis, angle) => [Math.cos(angle / 2), ...axis.map((each) => each * Math.sin(angle / 2))];

/** One rotation after another. */
export function product([a, b, c, d], [e, f, g, h]) {
  return [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
}

/** The axes of a body, as columns of its rotation. */
export function axesOf([w, x, y, z]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}
