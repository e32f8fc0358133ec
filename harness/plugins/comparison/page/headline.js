// What differs between two runs in a few sentences: outcome, cause, and motion.

import { TOOL } from "./apart.js";
import { byId, element } from "./dom.js";
import { amount } from "./units.js";
import { holds, turns } from "./verdict_table.js";

const CAUSES = ["scenario", "robot", "seed", "version"];
const NONE = "-"; // stands for what one of two runs does not have

/**
 * @param {any} facts of the comparison @param {any[]} runs @param {any[]} verdicts pairs of them @param {import("./apart.js").Apart} apart
 * @returns {{label: string, text: string, time: number | null}[]} the first one says which run fails
 */
export function headline(facts, runs, verdicts, apart) {
  if (facts.isSame) return [{ label: "Outcome", text: "Commands, signals and verdicts are the same.", time: null }];
  return [{ label: "Outcome", ...outcome(runs, verdicts) }, { label: "Cause", text: cause(facts.groups), time: null }, { label: "Motion", ...motion(facts, apart) }];
}

/** @param {{label: string, text: string, time: number | null}[]} sentences @param {(time: number) => void} seek */
export function showHeadline(sentences, seek) {
  const rows = sentences.map(({ label, text, time }) => [
    element("dt", {}, label),
    element("dd", {}, time === null ? text : element("button.link", { type: "button", onclick: () => seek(time), title: "Show this moment" }, text)),
  ]);
  byId("headline").replaceChildren(...rows.flat());
  byId("summary-headline").replaceChildren(...sentences.map(({ label, text }) => element("p", {}, element("b", {}, `${label}: `), text)));
}

function outcome(runs, verdicts) {
  const failed = runs.map(({ steps }) => steps.find(({ status, hasChildren }) => status === "failed" && !hasChildren));
  if (Boolean(failed[0]) !== Boolean(failed[1])) {
    const step = failed[0] ?? failed[1];
    return { text: `${failed[0] ? "A" : "B"} fails in step “${step.summary}”: ${step.errorCode}; ${failed[0] ? "B" : "A"} gets through it.`, time: step.end };
  }
  const turned = verdicts.filter(turns);
  const lost = turned.filter(({ second }) => !holds(second));
  const [first] = lost.length ? lost : turned;
  if (!first) return { text: `Every expectation has the same outcome in both runs: both ${runs[0].outcome}.`, time: null };
  const more = (lost.length || turned.length) - 1;
  const others = more ? ` and ${more} more expectation${more > 1 ? "s" : ""} that` : ", which";
  const [does, other] = lost.length ? ["misses", "meets"] : ["meets", "misses"];
  return { text: `B ${does} “${first.name}”${others} A ${other}.`, time: first.second.time };
}

/** The first line of the file that differs, else the robot, the seed or a version. */
function cause(groups) {
  const rows = CAUSES.flatMap((kind) => groups.filter((group) => group.kind === kind).flatMap((group) => group.rows.map((row) => ({ kind, ...row }))));
  if (!rows.length) return "File, robot, seed and versions are the same.";
  const [{ kind, name, before, after }] = rows;
  const where = kind === "scenario" ? "In the file" : `The ${name || kind}`;
  const value = before === NONE ? `only B has ${after}` : after === NONE ? `only A has ${before}` : `${after} in place of ${before}`;
  return `${where}: ${value}${rows.length > 1 ? `, and ${rows.length - 1} more difference${rows.length > 2 ? "s" : ""}` : ""}.`;
}

function motion(facts, apart) {
  const parts = apart.series().map(({ name, high }) => ({ name, high, since: apart.since(name) })).sort((a, b) => a.since - b.since);
  if (!parts.length) return { text: facts.parting ? "Nothing comes apart by a millimetre; the numbers do." : "The recorded motion is the same.", time: facts.parting?.time ?? null };
  const [first] = parts;
  const tool = parts.find(({ name }) => name === TOOL);
  const arm = first === tool ? "" : tool ? `; the arm moves the same until t = ${tool.since.toFixed(2)} s` : "; the arm moves the same throughout";
  return { text: `From t = ${first.since.toFixed(2)} s on, ${first.name} is elsewhere, by up to ${amount(first.high / 1e3, "m")}${arm}.`, time: first.since };
}
