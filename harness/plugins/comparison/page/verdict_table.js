// The expectations of both runs with their margins, those that turned first.

import { breakable, element } from "./dom.js";
import { amount, amounts, tone } from "./units.js";

/** @typedef {{name: string, first: any, second: any}} VerdictPair an expectation with the verdicts of both runs; null where a run has none */

/** @param {any} facts of the comparison @param {any[]} runs @returns {VerdictPair[]} */
export function verdictPairs({ names, verdicts }, runs) {
  return verdicts.map(([first, second], index) => ({ name: names[index], first: runs[0].verdicts[first] ?? null, second: runs[1].verdicts[second] ?? null }));
}

/** @param {any} verdict */
export function holds(verdict) {
  return verdict?.status === "passed";
}

/** Whether both runs have an expectation, and only one of them meets it. @param {VerdictPair} pair */
export function turns({ first, second }) {
  return Boolean(first && second) && holds(first) !== holds(second);
}

/** @param {VerdictPair[]} pairs @param {(pair: VerdictPair) => void} select @returns {HTMLElement | false} */
export function verdictTable(pairs, select) {
  if (!pairs.length) return false;
  const [changed, same] = [pairs.filter((pair) => !isSame(pair)), pairs.filter(isSame)];
  changed.sort((a, b) => Number(turns(b)) - Number(turns(a)));
  const count = pairs.filter(turns).length;
  return element(
    "section", {},
    element("h3", {}, `Verdicts: ${count ? `${count} of ${pairs.length} turned` : "none turned"}`),
    changed.length > 0 && table(changed, select),
    same.length > 0 && element("details", { open: changed.length === 0 }, element("summary", {}, `${same.length} with the same margin`), table(same, select)),
  );
}

function table(pairs, select) {
  return element(
    "table.verdict-pairs", {},
    element("thead", {}, element("tr", {}, ...["expectation", "A", "B", "B − A"].map((text) => element("th", { scope: "col" }, text)))),
    element("tbody", {}, ...pairs.map((pair) => element(
      turns(pair) ? "tr.turned" : "tr", {},
      element("th", { scope: "row" }, element("button.link", { type: "button", onclick: () => select(pair), title: "Show the moment that decided, and the plot" }, ...breakable(pair.name))),
      judged(pair.first), judged(pair.second), element("td", {}, difference(pair)),
    ))),
  );
}

function judged(verdict) {
  if (!verdict) return element("td", {}, "–");
  const margin = verdict.margin === null ? verdict.status : amount(verdict.margin, verdict.unit).replace(/^-/, "−");
  return element(`td.${tone(verdict.status)}`, { title: `${verdict.status}${verdict.margin === null ? "" : `, margin ${margin}`}` }, element("i.sign", { role: "img", "aria-label": verdict.status }), ` ${margin}`);
}

/** How much the margin grew or shrank, where both are of one unit. */
function difference({ first, second }) {
  if (first?.margin == null || second?.margin == null || first.unit !== second.unit) return "–";
  const change = second.margin - first.margin;
  return change === 0 ? "0" : `${change < 0 ? "−" : "+"}${amount(Math.abs(change), first.unit)}`;
}

/** Whether people read both margins as equal. */
function isSame({ first, second }) {
  if (!first || !second || first.status !== second.status || first.unit !== second.unit) return false;
  if (first.margin === null || second.margin === null) return first.margin === second.margin;
  return /^0\D/.test(`${amount(second.margin - first.margin, first.unit)} `) || amounts(first.margin, second.margin, first.unit)[0] === amounts(first.margin, second.margin, first.unit)[1];
}
