// The expectations: what was measured, the limit, and how much room was left.

import { judgedSpan } from "./cause.js";
import { element } from "./dom.js";
import { amount, amounts, seconds, tone } from "./units.js";

const SAME = 1e-6; // of a margin: a measure that it is of
const WORST_SHOWN = 3;
const ORDER = ["bad", "open", "good"];

/**
 * @param {import("./payload.js").Payload} payload
 * @param {(index: number) => void} select
 * @returns {HTMLElement}
 */
export function verdictList({ run }, select) {
  if (!run.verdicts.length) {
    const note = run.findings.find(({ kind }) => kind === "nothing_expected");
    return element("p.empty", {}, note ? `Note: ${note.message}.` : "The file expects nothing beyond what its steps say.");
  }
  const order = run.verdicts.map((_, index) => index);
  order.sort((a, b) => ORDER.indexOf(tone(run.verdicts[a].status)) - ORDER.indexOf(tone(run.verdicts[b].status)));
  return element(
    "ul.verdicts", {},
    ...order.map((index) => element("li", {}, verdict(run, run.verdicts[index], index, select))),
  );
}

function verdict(run, each, index, select) {
  const { start, end, step } = judgedSpan(run, each);
  const span = step && end > start ? ` of ${start.toFixed(2)} to ${seconds(end)}` : "";
  const place = [each.time === null ? "" : `t = ${seconds(each.time)}${span}`, each.line ? `line ${each.line}` : ""];
  return element(
    `button.verdict.${tone(each.status)}`,
    { type: "button", onclick: () => select(index), "data-verdict": index },
    element("i.sign", { role: "img", "aria-label": each.status }),
    element("b", {}, each.text),
    each.credit && element("span.credit", {}, each.credit),
    each.status !== "passed" && each.status !== "failed" && element("span.what", {}, each.status),
    each.status === "passed" ? null : element("span.reason", {}, each.reason),
    ...each.warnings.map((warning) => element("span.reason", {}, `warning: ${warning}`)),
    ...each.measures.slice(0, each.status === "passed" ? 1 : WORST_SHOWN).map((measure) => measured(measure)),
    each.status === "passed" && !each.measures.length ? element("span.what", {}, each.reason) : null,
    ...marginBar(each, element("span.place", { title: each.reason }, place.filter(Boolean).join(" · "))),
  );
}

/** A bar of the allowance: how much of it was used; below it the margin, and the place. */
function marginBar({ margin, unit, used, status, tightest, measures }, place) {
  const below = (...words) => element("span.below", {}, ...words, place);
  if (margin === null) return [below()];
  const marginText = `${tightest && `${tightest}: `}${margin >= 0 ? "margin" : "missed by"} ${amount(Math.abs(margin), unit)}`;
  if (used === null) return [below(element("span", {}, marginText))];
  const percent = Math.round(100 * used);
  const decides = ({ value, limit }) => limit !== null && Math.abs(Math.abs(value - limit) - Math.abs(margin)) <= SAME * Math.abs(margin);
  const isFloor = (measures.find(decides) ?? measures[0]).comparison === ">=";
  const label = isFloor ? `what is required is ${percent} % of what was measured` : `${percent} % of the allowance used`;
  const bar = element("span.margin", { role: "img", "aria-label": label }, element("i"));
  bar.firstChild.style.width = `${Math.max(1, Math.min(100, percent))}%`;
  const text = isFloor || used > 10 || status !== "passed" ? marginText : `${percent} % used · ${marginText}`;
  return [bar, below(element("span", { title: bar.ariaLabel }, text))];
}

function measured({ name, value, limit, comparison, unit, detail }) {
  const bound = { "<=": "at most", ">=": "at least", "==": "exactly" }[comparison];
  const [shown, required] = limit === null ? [amount(value, unit), ""] : amounts(value, limit, unit);
  return element(
    "span.measure", {},
    `${name} `, element("code", {}, shown), required && ` (${bound} ${required})`,
    detail && element("em", {}, ` ${detail}`),
  );
}
