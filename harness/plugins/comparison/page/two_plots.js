// Plots of two runs over each other, those of what differs first: the same colours, the second run dashed.

import { decodeGroup, valueAt } from "./payload.js";
import { Plots } from "./plots.js";
import { short } from "./units.js";
import { turns } from "./verdict_table.js";

const DASH = [5, 3]; // [pixels]
const APART = { id: "apart", title: "apart at equal times", unit: "mm", limits: [], least: 1 };
const REVEALING = ["height", "slip", "contact", "gripper", "tcp", "position", "turn", "tracking", "velocity", "effort", "displacement"];
const PANELS = 4; // plots that are shown at once
const INSTANTS = 100; // at which lines are compared
const DIFFERS = 0.02; // of a plot's range: lines that are farther apart differ to the eye

export class TwoPlots extends Plots {
  /** @param {any[]} payloads of both runs @param {import("./clock.js").Clock} clock @param {any[]} bands @param {import("./two_runs.js").Alignment} alignment @param {import("./apart.js").Apart} apart @param {any[]} verdicts pairs */
  static of(payloads, clock, bands, alignment, apart, verdicts) {
    const groups = [...new Map(payloads.toReversed().flatMap(({ run }) => run.groups.map((group) => [group.id, group]))).values()];
    if (apart.series().length) groups.unshift(APART);
    const judged = verdicts.filter(turns).flatMap(({ first, second }) => [second.plot, first.plot]).filter(Boolean);
    const preferred = [...new Set([APART.id, ...judged])];
    const differing = new Map();
    for (const id of REVEALING) {
      if (preferred.length >= PANELS) break;
      differing.set(id, linesThatDiffer(payloads, id));
      if (differing.get(id).size && !preferred.includes(id)) preferred.push(id);
    }
    return new TwoPlots({ run: { groups }, payloads, alignment, apart, differing }, clock, bands, preferred);
  }

  series(group) {
    const { payloads, alignment, apart, differing: known } = this.payload;
    if (group.id === APART.id) return apart.series();
    if (!known.has(group.id)) known.set(group.id, linesThatDiffer(payloads, group.id));
    const differing = known.get(group.id);
    return payloads.flatMap((payload, index) => {
      const own = payload.run.groups.find(({ id }) => id === group.id);
      if (!own) return [];
      const series = decodeGroup(payload, own).filter(({ name }) => !differing.size || differing.has(name));
      return index ? series.map((each) => later(each, alignment)) : series.map((each) => ({ ...each, label: `A ${short(each.name)}` }));
    });
  }
}

/** Names of the lines of a group that are not over each other. @param {any[]} payloads @param {string} id */
function linesThatDiffer(payloads, id) {
  const groups = payloads.map(({ run }) => run.groups.find((group) => group.id === id));
  if (groups.some((group) => !group)) return new Set();
  const [ours, theirs] = groups.map((group, index) => decodeGroup(payloads[index], group));
  const all = [...ours, ...theirs];
  const range = Math.max(groups[0].least, Math.max(...all.map(({ high }) => high)) - Math.min(...all.map(({ low }) => low)));
  const end = Math.min(...payloads.map(({ run }) => run.duration));
  const times = Array.from({ length: INSTANTS }, (_, i) => (i / (INSTANTS - 1)) * end);
  return new Set([...new Set(all.map(({ name }) => name))].filter((name) => {
    const [a, b] = [ours, theirs].map((series) => series.find((each) => each.name === name));
    return !a || !b || times.some((time) => Math.abs(valueAt(a, time) - valueAt(b, time)) > DIFFERS * range);
  }));
}

function later(series, alignment) {
  const times = series.times.map((time) => alignment.onClock(time));
  return { ...series, times, dash: DASH, label: `B ${short(series.name)}` };
}
