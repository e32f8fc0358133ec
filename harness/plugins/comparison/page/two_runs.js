// Two runs on one clock: the clock is the first run's, the second one follows it step by step or from the start.

/**
 * @typedef {object} Pair
 * @property {number | null} first index of a step of the first run @property {number | null} second likewise
 */

export class Alignment {
  /** @param {any[]} first steps of the first run @param {any[]} second of the second @param {Pair[]} pairs steps that are the same @param {number[]} durations [s] */
  constructor(first, second, pairs, durations) {
    this.bySteps = false;
    this.durations = durations;
    const corners = pairs
      .filter((pair) => pair.first !== null && pair.second !== null)
      .flatMap((pair) => [[first[pair.first].start, second[pair.second].start], [first[pair.first].end, second[pair.second].end]]);
    this.corners = rising([[0, 0], ...corners, durations]);
  }

  /** How long both take on the clock [s]. */
  get duration() {
    return this.bySteps ? this.durations[0] : Math.max(...this.durations);
  }

  /** Time of the second run at a time of the clock. @param {number} time [s] */
  ofSecond(time) {
    return this.bySteps ? between(this.corners, time, 0, 1) : time;
  }

  /** Time of the clock at a time of the second run. @param {number} time [s] */
  onClock(time) {
    return this.bySteps ? between(this.corners, time, 1, 0) : time;
  }
}

/** Corners that fall in neither time, from the first one on: where one run has a step more, the other one's time stands still. */
function rising(corners) {
  const found = [];
  for (const corner of corners) {
    const last = found.at(-1);
    if (!last || (corner[0] >= last[0] && corner[1] >= last[1])) found.push(corner);
  }
  return found;
}

/** A value between corners, and beyond them at the same pace. */
function between(corners, value, from, to) {
  let after = corners.findIndex((corner) => corner[from] >= value);
  if (after < 0) return corners.at(-1)[to] + value - corners.at(-1)[from];
  if (after === 0) after = Math.min(1, corners.length - 1);
  const [a, b] = [corners[Math.max(0, after - 1)], corners[after]];
  const length = b[from] - a[from];
  return a[to] + (length > 0 ? ((value - a[from]) * (b[to] - a[to])) / length : 0);
}
