// What differs: the file, the verdicts, where the runs part, and the rest.

import { element } from "./dom.js";
import { seconds } from "./units.js";
import { verdictTable } from "./verdict_table.js";

const SHOWN_ABOVE = ["outcome", "verdict", "margin"]; // in the headline, and in the table of verdicts
const OPEN = ["scenario", "robot", "seed"]; // what most often is the cause

/** @param {any} facts of the comparison @param {import("./verdict_table.js").VerdictPair[]} verdicts @param {import("./apart.js").Apart} apart @param {{seek: (time: number) => void, verdict: (pair: any) => void}} select @returns {HTMLElement} */
export function differencesView(facts, verdicts, apart, select) {
  const seen = apart.series().map(({ name }) => ({ time: apart.since(name), text: `${name} is elsewhere from t = ${seconds(apart.since(name))} on` }));
  const numerical = facts.parting && { ...facts.parting, text: `numerically apart, ${facts.parting.text}` };
  const moments = [...seen.sort((a, b) => a.time - b.time), ...facts.farthest, numerical].filter(Boolean);
  const parting = moments.length > 0 && element("section", {},
    element("h3", {}, "Where they part"),
    ...moments.map(({ time, text }) => element("button.link", { type: "button", onclick: () => select.seek(time) }, text)),
  );
  const groups = facts.groups.filter(({ kind }) => !SHOWN_ABOVE.includes(kind));
  const causes = groups.filter(({ kind }) => OPEN.includes(kind));
  return element(
    "div.differences", {},
    ...facts.warnings.map((text) => element("p.why", {}, text)),
    ...causes.map((group) => element("section", {}, element("h3", {}, group.kind === "scenario" ? "In the file" : group.title), group.kind === "scenario" ? changedLines(group) : groupTable(group))),
    verdictTable(verdicts, select.verdict),
    parting,
    ...groups.filter((group) => !causes.includes(group)).map((group) => element("details", {}, element("summary", {}, `${group.title} (${group.rows.length})`), groupTable(group))),
  );
}

/** Lines of the file as a patch has them. */
function changedLines({ rows }) {
  const line = (sign, text) => text !== "-" && element(`code.${sign === "−" ? "removed" : "added"}`, {}, `${sign} ${text}`);
  return element("pre.patch", { "aria-label": "Lines only in A, and lines only in B" }, ...rows.flatMap(({ before, after }) => [line("−", before), line("+", after)]));
}

function groupTable({ rows }) {
  const hasNames = rows.some(({ name }) => name);
  const head = [hasNames && "", "A", "B", rows.some(({ amount }) => amount) && "B − A"];
  return element(
    "table", {},
    element("thead", {}, element("tr", {}, ...head.filter((each) => each !== false).map((text) => element("th", { scope: "col" }, text)))),
    element("tbody", {}, ...rows.map((row) =>
      element("tr", {}, hasNames && element("th", { scope: "row" }, row.name), element("td", {}, row.before), element("td", {}, row.after), head[3] && element("td", {}, row.amount)),
    )),
  );
}
