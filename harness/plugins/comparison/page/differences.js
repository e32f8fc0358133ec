// What differs, and the steps of both runs side by side.

import { byId, element } from "./dom.js";
import { statusWord } from "./units.js";

/** @param {any} facts of the comparison @param {(time: number) => void} seek @returns {HTMLElement} */
export function differencesView(facts, seek) {
  const moments = [facts.parting, ...facts.farthest].filter(Boolean);
  const parting = moments.length > 0 && element("section", {},
    element("h3", {}, "Where they part"),
    ...moments.map(({ time, text }) => element("button.link", { type: "button", onclick: () => seek(time) }, text)),
  );
  return element("div.differences", {}, parting, ...facts.warnings.map((text) => element("p.why", {}, text)), ...facts.groups.map(groupView));
}

function groupView({ title, rows }) {
  const hasNames = rows.some(({ name }) => name);
  const head = [hasNames && "", "A", "B", rows.some(({ amount }) => amount) && "B − A"];
  return element(
    "section", {},
    element("h3", {}, title),
    element(
      "table", {},
      element("thead", {}, element("tr", {}, ...head.filter((each) => each !== false).map((text) => element("th", { scope: "col" }, text)))),
      element("tbody", {}, ...rows.map((row) =>
        element("tr", {}, hasNames && element("th", { scope: "row" }, row.name), element("td", {}, row.before), element("td", {}, row.after), head[3] && element("td", {}, row.amount)),
      )),
    ),
  );
}

/** @param {any[][]} steps of both runs @param {import("./two_runs.js").Pair[]} pairs @param {(pair: import("./two_runs.js").Pair) => void} select @returns {(first: number) => void} marks a step of the first run */
export function makePairs(steps, pairs, select) {
  const items = pairs.map((pair) => {
    const [a, b] = [pair.first === null ? null : steps[0][pair.first], pair.second === null ? null : steps[1][pair.second]];
    const step = a ?? b;
    const named = /^steps?[_[]/.test(step.id) ? step.summary : step.id;
    const doesTheSame = a && b && a.status === b.status && a.summary === b.summary;
    const isSame = doesTheSame && !pair.differs;
    return element(
      "li", { style: `--depth: ${step.depth}` },
      element(
        `button.step.${isSame ? (b.tone === "bad" ? "bad" : "good") : "open"}`, { type: "button", onclick: () => select(pair), title: step.summary },
        element("i.sign", { role: "img", "aria-label": isSame ? "the same" : "differs" }),
        element("span.title", {}, element("b", {}, named)),
        element("span.took", {}, took(a)),
        element("span.took", {}, took(b)),
        !doesTheSame && element("span.what.wide", {}, changed(a, b)),
      ),
    );
  });
  byId("steps").append(...items);
  return (first) => items.forEach((item, index) => item.firstChild.toggleAttribute("aria-current", pairs[index].first === first && first >= 0));
}

function took(step) {
  return !step || step.status === "not reached" ? "–" : `${(step.end - step.start).toFixed(2)} s`;
}

function changed(a, b) {
  if (!a) return "only in B";
  if (!b) return "only in A";
  const [one, two] = [a, b].map((step) => statusWord(step.status));
  return one !== two ? `${one} → ${two}` : `${a.summary} → ${b.summary}`;
}
