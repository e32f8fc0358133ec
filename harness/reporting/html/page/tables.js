// Source, findings, joints and environment: the plainer tabs.

import { element } from "./dom.js";
import { number, seconds, tone } from "./units.js";

/**
 * The scenario file, with the lines of failures in red.
 * @param {import("./payload.js").Payload} payload
 * @param {(line: number) => void} select
 */
export function sourceView({ run }, select) {
  if (!run.source) return element("p.empty", {}, "The run does not hold the text of its scenario.");
  const bad = new Set();
  const known = new Set();
  const toned = [
    ...run.steps.map(({ line, status }) => [line, tone(status)]),
    ...run.verdicts.map(({ line, status }) => [line, tone(status)]),
  ];
  for (const [line, colour] of toned) {
    if (line) known.add(line);
    if (line && colour === "bad") bad.add(line);
  }
  const lines = run.source.replace(/\n$/, "").split("\n").map((text, index) => {
    const line = index + 1;
    const made = element(`span.line${bad.has(line) ? ".failing" : ""}${known.has(line) ? ".known" : ""}`, { "data-line": line });
    made.append(...highlighted(text));
    if (known.has(line)) made.addEventListener("click", () => select(line));
    return made;
  });
  const set = run.options ? element("p.setting", {}, "Run with ", element("code", {}, run.options), ": where these say otherwise, the file's values did not apply.") : null;
  return element("div", {}, set, element("pre.source", { tabindex: 0, "aria-label": "Scenario file" }, ...lines));
}

/** Mark the lines of the step that runs. @param {HTMLElement} view @param {number} from @param {number} to not included */
export function markLines(view, from, to) {
  for (const line of view.querySelectorAll(".line")) {
    const number = Number(line.getAttribute("data-line"));
    line.classList.toggle("current", number >= from && number < to);
  }
}

/** YAML with its comments and keys highlighted. */
function highlighted(text) {
  const [, code, comment] = /^((?:[^#"']|"[^"]*"|'[^']*'|\S#)*)(#.*)?$/.exec(text) ?? [null, text, ""];
  const pieces = [];
  let rest = code;
  while (rest) {
    const match = /"[^"]*"|'[^']*'|[\w.]+(?=:(\s|$))/.exec(rest);
    if (!match) break;
    const isText = /^["']/.test(match[0]);
    pieces.push(rest.slice(0, match.index), element(isText ? "span.text" : "span.key", {}, match[0]));
    rest = rest.slice(match.index + match[0].length);
  }
  return [...pieces, rest, comment ? element("span.comment", {}, comment) : "", "\n"];
}

/** What plan and physics disagreed on, and who touched whom. @param {import("./payload.js").Payload} payload @param {(time: number) => void} seek */
export function findingsView(payload, seek) {
  return element("div", {}, findingList(payload, seek), contactTable(payload, seek));
}

function contactTable({ run }, seek) {
  if (!run.contacts.length) return null;
  const head = ["contacts", "first", "for", "at most"];
  const rows = run.contacts.map(({ first, second, time, duration, peak, isCollision }) =>
    element(
      `tr${isCollision ? ".bad" : ""}`, {},
      element("th", { scope: "row" }, `${first} and ${second}`, isCollision ? element("span.reason", {}, " collision") : null),
      element("td", {}, element("button.link", { type: "button", onclick: () => seek(time) }, seconds(time))),
      element("td", {}, seconds(duration)),
      element("td", {}, `${number(peak)} N`),
    ),
  );
  return element(
    "table.contacts", {},
    element("thead", {}, element("tr", {}, ...head.map((name) => element("th", { scope: "col" }, name)))),
    element("tbody", {}, ...rows),
  );
}

function findingList({ run }, seek) {
  if (!run.findings.length) {
    return element("p.empty", {}, "Nothing: plan and physics agreed wherever they were compared.");
  }
  const warnings = run.findings.filter(({ isWarning }) => isWarning);
  const notes = run.findings.filter(({ isWarning }) => !isWarning);
  return element(
    "ul.findings", {},
    ...[...warnings, ...notes].map(({ kind, message, time, step, isWarning }) =>
      element(
        isWarning ? "li.warning" : "li", {},
        element("b", {}, `${isWarning ? "warning" : "note"}: ${kind.replaceAll("_", " ")}`), element("p", {}, message),
        time === null ? null : element("button.link", { type: "button", onclick: () => seek(time) }, `t = ${seconds(time)}`),
        step ? element("span.what", {}, ` ${step}`) : null,
      ),
    ),
  );
}

const UNKNOWN = "not recorded";

/** @param {import("./payload.js").Payload} payload */
export function jointTable({ run }) {
  const head = ["joint", "reached", "limits", "peak speed", "peak effort"];
  return element(
    "table", {},
    element("thead", {}, element("tr", {}, ...head.map((name) => element("th", { scope: "col" }, name)))),
    element(
      "tbody", {},
      ...run.joints.map((joint) =>
        element(
          "tr", {},
          element("th", { scope: "row" }, joint.name),
          element("td", {}, joint.low === null ? UNKNOWN : `${number(joint.low)} … ${number(joint.high)} ${joint.unit}`),
          element("td", {}, joint.lower === null ? "none" : `${number(joint.lower)} … ${number(joint.upper)}`),
          element("td", {}, share(joint.speed, joint.speedLimit)),
          element("td", {}, share(joint.effort, joint.effortLimit)),
        ),
      ),
    ),
  );
}

function share(value, limit) {
  if (value === null) return UNKNOWN;
  if (limit === null || limit <= 0) return number(value);
  return element("span.share", { title: `${number(value)} of ${number(limit)}` }, `${number((100 * value) / limit)} %`);
}

/** @param {[string, string][]} rows */
export function pairTable(rows) {
  return element("table", {}, element("tbody", {}, ...rows.map(([name, value]) =>
    element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value)))));
}
