// Plots of two runs over each other: the same colours, the second run dashed.

import { decodeGroup } from "./payload.js";
import { Plots } from "./plots.js";
import { short } from "./units.js";

const DASH = [5, 3]; // [pixels]

export class TwoPlots extends Plots {
  /** @param {any[]} payloads of both runs @param {import("./clock.js").Clock} clock @param {any[]} bands @param {import("./two_runs.js").Alignment} alignment */
  static of(payloads, clock, bands, alignment) {
    const groups = [...new Map(payloads.toReversed().flatMap(({ run }) => run.groups.map((group) => [group.id, group]))).values()];
    return new TwoPlots({ run: { groups }, payloads, alignment }, clock, bands);
  }

  series(group) {
    const { payloads, alignment } = this.payload;
    return payloads.flatMap((payload, index) => {
      const own = payload.run.groups.find(({ id }) => id === group.id);
      if (!own) return [];
      const series = decodeGroup(payload, own);
      return index ? series.map((each) => later(each, alignment)) : series.map((each) => ({ ...each, label: `A ${short(each.name)}` }));
    });
  }
}

function later(series, alignment) {
  const times = series.times.map((time) => alignment.onClock(time));
  return { ...series, times, dash: DASH, label: `B ${short(series.name)}` };
}
