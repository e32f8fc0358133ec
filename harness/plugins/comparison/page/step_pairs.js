// The steps of both runs side by side, and what differs in each.

import { SEEN } from "./apart.js";
import { breakable, byId, element } from "./dom.js";
import { stepAt } from "./timeline.js";
import { amount, statusWord } from "./units.js";
import { turns } from "./verdict_table.js";

const LASTED = 5e-3; // [s], of two durations that are shown as different

/**
 * @param {any[][]} steps of both runs @param {import("./two_runs.js").Pair[]} pairs @param {import("./verdict_table.js").VerdictPair[]} verdicts
 * @param {import("./apart.js").Apart} apart @param {(pair: import("./two_runs.js").Pair) => void} select
 * @returns {(first: number) => void} marks a step of the first run
 */
export function makePairs(steps, pairs, verdicts, apart, select) {
  const owned = verdicts.filter(turns).map((pair) => ({ pair, steps: [owner(steps[0], pair.first), owner(steps[1], pair.second)] }));
  const found = pairs.map(({ first, second }) => {
    if (first === null || second === null) return [first === null ? "only in B" : "only in A"];
    const mine = owned.filter((each) => each.steps.includes(steps[0][first]) || each.steps.includes(steps[1][second]));
    return differencesOf(steps[0][first], steps[1][second], mine.map(({ pair }) => pair), apart);
  });
  const depthAt = ({ first, second }) => (first === null ? steps[1][second] : steps[0][first]).depth;
  /** Pairs of the steps nested in one. */
  const inside = (index) => {
    const after = pairs.findIndex((pair, other) => other > index && depthAt(pair) <= depthAt(pairs[index]));
    return Array.from({ length: (after < 0 ? pairs.length : after) - index - 1 }, (_, i) => index + 1 + i);
  };
  const items = pairs.map((pair, index) => {
    const [a, b] = [pair.first === null ? null : steps[0][pair.first], pair.second === null ? null : steps[1][pair.second]];
    const step = a ?? b;
    const named = /^steps?[_[]/.test(step.id) ? step.summary : step.id;
    const differences = found[index];
    const isSame = !differences.length && !inside(index).some((each) => found[each].length);
    return element(
      "li", { style: `--depth: ${step.depth}` },
      element(
        `button.step.${isSame ? "same" : "differs"}`, { type: "button", onclick: () => select(pair), title: step.summary },
        element("i.equality", { role: "img", "aria-label": isSame ? "the same" : "differs" }),
        element("span.title", {}, element("b", {}, ...breakable(named))),
        took(a),
        took(b),
        ...differences.filter(Boolean).map((text) => element("span.what", {}, ...breakable(text))),
      ),
    );
  });
  byId("steps").append(...items);
  return (first) => items.forEach((item, index) => item.firstChild.toggleAttribute("aria-current", pairs[index].first === first && first >= 0));
}

function took(step) {
  if (!step) return element("span.took", {}, "–");
  const seconds = step.status === "not reached" ? "–" : `${(step.end - step.start).toFixed(2)} s`;
  return element(`span.took.${step.tone}`, {}, element("i.sign", { role: "img", "aria-label": statusWord(step.status) }), ` ${seconds}`);
}

/** The step of a verdict: the one that it is judged over; of the whole run, the one in which it was missed. @param {any[]} steps @param {any} verdict */
function owner(steps, verdict) {
  const own = steps.find(({ id }) => id && id === verdict.step);
  return own ?? (verdict.status === "failed" && verdict.time !== null ? steps[stepAt(steps, verdict.time)] : undefined);
}

/** In words; an empty one where the durations say it. */
function differencesOf(a, b, verdicts, apart) {
  const found = [];
  const [one, two] = [a, b].map(({ status }) => statusWord(status));
  if (one !== two) found.push(`${one} → ${two}`);
  if (a.summary !== b.summary) found.push(`${a.summary} → ${b.summary}`);
  found.push(...verdicts.map(({ first, second }) => `${first.text}: ${first.status} → ${second.status}`));
  if (a.status === "not reached" || b.status === "not reached") return found;
  const doesTheSame = a.summary === b.summary && a.end > a.start && b.end > b.start && !a.hasChildren;
  const moved = doesTheSame ? apart.within(a, b) : { name: "", distance: 0 };
  if (moved.distance > SEEN) found.push(`${moved.name} moves otherwise, by ${amount(moved.distance, "m")}`);
  if (!found.length && Math.abs(a.end - a.start - b.end + b.start) > LASTED) found.push("");
  return found;
}
