// Plots of how far something is from where a verdict requires it: what the verdict measured, over time.

import { Poses } from "./poses.js";

const SAME = 2e-3; // [m]: a body whose place the verdict measured

/**
 * Groups of plots, one for each verdict that does not hold and has an expected point; the verdict's plot becomes that one.
 * @param {import("./payload.js").Payload} payload @returns {any[]} with their series
 */
export function missGroups(payload) {
  const { run } = payload;
  const poses = new Poses(payload);
  return run.verdicts.flatMap((verdict, index) => {
    const [measure] = verdict.measures;
    const { expected, actual } = verdict.points ?? {};
    if (verdict.status !== "failed" || verdict.time === null || !expected || measure?.unit !== "m") return [];
    const away = (body, time, point) => {
      const [x, y, z] = poses.of(body, time);
      return Math.hypot(x - point[0], y - point[1], z - point[2]);
    };
    const body = run.bodies.find((each) => (!each.isLink || each.name === run.toolBody) && away(each, verdict.time, actual) < SAME);
    if (!body) return [];
    const { count, step } = run.frames;
    const times = Float64Array.from({ length: count }, (_, i) => i * step);
    const values = Float32Array.from(times, (time) => 1e3 * away(body, time, expected));
    const series = { name: body.name, times, values, low: Math.min(...values), high: Math.max(...values) };
    const id = `miss${index}`;
    Object.assign(measure, { plot: id });
    verdict.plot = id;
    return [{ id, title: measure.name, unit: "mm", least: 1, limits: [{ value: 1e3 * measure.limit, series: null, stretches: true }], series: [series], isDecoded: true }];
  });
}
