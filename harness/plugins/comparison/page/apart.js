// How far apart the bodies of two runs are.

import { Poses } from "./poses.js";

const TURNED = 0.008; // [rad]: half a degree, of what is drawn as one body
export const TOOL = "the TCP";
export const SEEN = 1e-3; // [m]: what pictures show
const INSTANTS = 12; // of a step at which both runs are compared

export class Apart {
  /** @param {any[]} payloads of both runs */
  constructor(payloads) {
    this.runs = payloads.map(({ run }) => run);
    this.poses = payloads.map((payload) => new Poses(payload));
    this.bodies = this.runs.map(({ bodies }) => new Map(bodies.map((body) => [body.name, body])));
    /** Objects that both runs have and that move in one of them. */
    this.objects = this.runs[0].bodies
      .filter(({ name, isLink, ghost }) => !isLink && !ghost && this.#moves(name))
      .map(({ name }) => name);
  }

  #moves(name) {
    const both = this.bodies.map((bodies) => bodies.get(name));
    return both.every(Boolean) && both.some(({ fixed }) => !fixed);
  }

  /** How far a body or the tool of one run is from where the other run's is [m]; NaN where one of them is not there. @param {string} name @param {number} first @param {number} second times [s] */
  of(name, first, second) {
    const [a, b] = [first, second].map((time, index) => this.#place(name, index, time));
    return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) : NaN;
  }

  /** Whether a body is at the same place in both runs, as far as pictures show. @param {number[]} a @param {number[]} b poses */
  static coincide(a, b) {
    const [one, two] = [a.slice(3), b.slice(3)];
    const cosine = Math.abs(one.reduce((sum, value, i) => sum + value * two[i], 0)) / (Math.hypot(...one) * Math.hypot(...two));
    return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) < SEEN && 2 * Math.acos(Math.min(1, cosine)) < TURNED;
  }

  #place(name, index, time) {
    const body = this.bodies[index].get(name === TOOL ? this.runs[index].toolBody : name);
    const isThere = body?.shown.some(([from, to]) => time >= from - 1e-6 && time <= to + 1e-6);
    return isThere ? this.poses[index].of(body, time) : null;
  }

  /** Distances at equal times [mm] of the tool and of objects that come apart, the farthest first. @returns {import("./payload.js").Series[]} */
  series() {
    this.found ??= [TOOL, ...this.objects].map((name) => this.#over(name)).filter(({ high }) => high > 1e3 * SEEN).sort((a, b) => b.high - a.high);
    return this.found;
  }

  #over(name) {
    const { count, step } = this.runs[0].frames;
    const times = Float64Array.from({ length: count }, (_, i) => i * step).filter((time) => time <= this.runs[1].duration + 1e-9);
    const values = Float32Array.from(times, (time) => 1e3 * this.of(name, time, time));
    const known = values.filter((value) => !Number.isNaN(value));
    return { name, times, values, low: 0, high: known.reduce((most, value) => Math.max(most, value), 0) };
  }

  /** When something is apart first [s]; null where it never is. @param {string} name */
  since(name) {
    const series = this.series().find((each) => each.name === name);
    return series ? series.times[series.values.findIndex((value) => value > 1e3 * SEEN)] : null;
  }

  /** What comes apart, or nearer again, during a step of both runs, at equal shares of it: the link or object that does so most, and by how much [m]. @param {any} one @param {any} two */
  within(one, two) {
    const links = this.runs[0].bodies.filter(({ isLink }) => isLink).map(({ name }) => name);
    let most = { name: "", distance: 0 };
    for (const name of [...this.objects, ...links]) {
      let [low, high] = [Infinity, 0];
      for (let i = 0; i <= INSTANTS; i++) {
        const [a, b] = [one, two].map(({ start, end }) => start + (i / INSTANTS) * (end - start));
        const distance = this.of(name, a, b);
        if (Number.isNaN(distance)) continue;
        [low, high] = [Math.min(low, distance), Math.max(high, distance)];
      }
      if (high - low > Math.max(SEEN, most.distance)) most = { name, distance: high - low };
    }
    return most;
  }
}
