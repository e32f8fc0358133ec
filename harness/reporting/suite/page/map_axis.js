// The axes of the map of runs: a varied quantity each, and the worst margin.

const MARGIN = { name: "worst margin (share of its limit)", unit: "", words: [] };
const ROOM = 0.04; // of the range, left free at both ends

/** @typedef {{ index: number, label: string, words: string[], text: (value: number | null) => string, range: (points: any[][]) => number[], ticks: (low: number, high: number, most: number) => number[] }} Axis */

/** The axes of a campaign, in the order of the columns of its points. @returns {Axis[]} */
export function axesOf(parameters) {
  return [...parameters.map((each, index) => axisOf(each, index, false)), axisOf(MARGIN, parameters.length, true)];
}

function axisOf({ name, unit, words }, index, hasZero) {
  const label = unit ? `${name} [${unit}]` : name;
  const text = (value) => {
    if (value === null) return "?";
    if (words.length) return words[Math.round(value)] ?? "";
    return `${Number(value.toPrecision(4))}${unit ? ` ${unit}` : ""}`;
  };
  const range = (points) => {
    if (words.length) return [-0.5, words.length - 0.5];
    const values = points.map((point) => point[index]).filter((value) => value !== null);
    const low = values.reduce((least, value) => Math.min(least, value), hasZero ? 0 : Infinity);
    const high = values.reduce((most, value) => Math.max(most, value), hasZero ? 0 : -Infinity);
    const room = (high - low || 1) * ROOM;
    return [low - room, high + room];
  };
  const ticks = (low, high, most) => words.length ? words.map((_, place) => place) : roundValues(low, high, most);
  return { index, label, words, text, range, ticks };
}

/** Round values in a range, at most about so many. */
function roundValues(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough);
  const found = [];
  for (let index = Math.ceil(low / step); index * step <= high; index++) found.push(index * step);
  return found;
}
