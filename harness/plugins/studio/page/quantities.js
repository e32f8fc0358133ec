// The units of every number on the page: millimetres and degrees, or metres and radians as a file has bare numbers.

const TURN = 180 / Math.PI;
/** Factor, name, digits, and the step of a nudge in the unit that is shown. */
const SYSTEMS = {
  "mm · °": { rad: [TURN, "°", 1, 1], m: [1000, "mm", 1, 1], "rad/s": [TURN, "°/s", 1, 1], "m/s": [1000, "mm/s", 1, 1] },
  "m · rad": { rad: [1, "rad", 4, 0.01], m: [1, "m", 4, 0.001], "rad/s": [1, "rad/s", 3, 0.01], "m/s": [1, "m/s", 4, 0.001] },
};
const listeners = [];
let name = localStorage.units in SYSTEMS ? localStorage.units : "mm · °";

const of = (unit) => SYSTEMS[name][unit] ?? [1, unit, 2, 1];

/** Whether the page shows degrees, as requests have it. */
export const angleUnit = () => (name === "m · rad" ? "rad" : "deg");
export const system = () => name;
export const unitName = (unit) => of(unit)[1];
export const nudge = (unit) => of(unit)[3];
export const shown = (value, unit) => value * of(unit)[0];
export const read = (value, unit) => Number(value) / of(unit)[0];

/** The number as a field has it. */
export const digits = (value, unit) => String(Number(shown(value, unit).toFixed(of(unit)[2] + 1)));

/** The number and its unit, with at most some decimals. */
export function amount(value, unit, most = 9) {
  const [factor, label, all] = of(unit);
  const count = name === "m · rad" ? all : Math.min(most, all);
  const text = (factor * value).toFixed(count);
  return `${Number(text) === 0 ? (0).toFixed(count) : text}${label.startsWith("°") ? "" : " "}${label}`;
}

/** Calls back at once, and whenever the units are others. */
export function onUnits(listener) {
  listeners.push(listener);
  listener();
}

export function toggleUnits() {
  const names = Object.keys(SYSTEMS);
  name = localStorage.units = names[(names.indexOf(name) + 1) % names.length];
  for (const listener of listeners) listener();
}
