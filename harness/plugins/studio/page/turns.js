// Rotations as people read them.

/** Roll, pitch and yaw [rad] of a quaternion w, x, y, z: turns about fixed x, then y, then z. */
export function eulerOf([w, x, y, z]) {
  const down = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(down), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}
