// Numbers as a person reads them.

const SHOWN = {
  m: [1000, "mm"],
  rad: [180 / Math.PI, "°"],
  "rad/s": [180 / Math.PI, "°/s"],
  "m/s": [1000, "mm/s"],
  "rad/s^2": [180 / Math.PI, "°/s²"],
  "m/s^2": [1, "m/s²"],
  "1": [1, ""],
};

/** @param {number} value three or four digits that matter */
export function number(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size < 1e-3) return value.toExponential(1);
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3;
  return value.toFixed(digits);
}

const FINEST = 1e-3; // in the unit that is shown: what is smaller is written as 0, as on the terminal
const FINEST_ANGLE = 1e-4; // [°]
const MOST_DIGITS = 12;

/**
 * A value with its unit; metres as millimetres, radians as degrees.
 * @param {number} value @param {string} unit @param {number} more digits than usual
 */
export function amount(value, unit, more = 0) {
  const [factor, name] = SHOWN[unit] ?? [1, unit];
  const gap = name === "" || name.startsWith("°") ? "" : " ";
  const shown = value * factor, size = Math.abs(shown);
  if (more) return `${shown.toPrecision(3 + more)}${gap}${name}`;
  const text = size < (name === "°" ? FINEST_ANGLE : FINEST) ? "0" : size < 1e-3 ? shown.toFixed(4) : number(shown);
  return `${text}${gap}${name}`;
}

/** Two values with as many digits as show their difference. @returns {[string, string]} */
export function amounts(first, second, unit) {
  for (let more = 0; more < MOST_DIGITS; more++) {
    const texts = [amount(first, unit, more), amount(second, unit, more)];
    if (texts[0] !== texts[1] || first === second) return texts;
  }
  return [amount(first, unit), amount(second, unit)];
}

/** A joint's or link's name without what all of them have. @param {string} name */
export function short(name) {
  return name.replace(/_joint$/, "").replace(/^rh_p12_rn_/, "");
}

/** @param {number} time [s] */
export function seconds(time) {
  return `${time.toFixed(2)} s`;
}

/** Angles of an arm [rad] as degrees in one line. @param {number[]} positions */
export function degrees(positions) {
  return positions.map((position) => ((position * 180) / Math.PI).toFixed(1)).join("  ");
}

const TONES = { passed: "good", "expected error": "good", failed: "bad" };

/** Class of the status of a step or verdict: what was not reached or not observable is no failure of its own. @param {string} status */
export function tone(status) {
  return TONES[status] ?? "open";
}

/** A status in words. @param {string} status */
export function statusWord(status) {
  return status === "expected error" ? "failed as expected" : status;
}
