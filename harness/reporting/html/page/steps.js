// The list of steps, folded where they passed: what each did, its line in the file, its verdicts, why it failed.

import { breakable, byId, element, scrollInto } from "./dom.js";
import { statusWord, tone } from "./units.js";

const ROOMY = 12; // steps in sight, up to which long titles take a second line

/**
 * @param {import("./payload.js").Payload} payload
 * @param {{step: (index: number) => void, verdict: (index: number) => void, time: (time: number) => void}} select
 * @returns {(index: number) => void} marks the step that runs
 */
export function makeSteps({ run }, select) {
  const parents = parentsOf(run.steps);
  const items = run.steps.map((step, index) => {
    const dots = run.verdicts.flatMap((verdict, number) => (verdict.step === step.id ? [dot(verdict, number, select.verdict)] : []));
    return element("li", { style: `--depth: ${step.depth}` }, row(step, index, select.step), element("span.dots", {}, ...dots), step.commands.length > 0 && commandList(step, select.time));
  });
  const folded = new Set(run.steps.flatMap((step, index) => (step.hasChildren && step.tone === "good" ? [index] : [])));
  const show = () => {
    items.forEach((item, index) => (item.hidden = ancestors(parents, index).some((each) => folded.has(each))));
    byId("steps").classList.toggle("short", items.filter(({ hidden }) => !hidden).length <= ROOMY);
  };
  run.steps.forEach((step, index) => {
    if (!step.hasChildren) return;
    const inside = run.steps.filter((_, other) => ancestors(parents, other).includes(index)).length;
    const fold = element("button.fold", { type: "button", "aria-expanded": !folded.has(index), "aria-label": `${inside} steps inside` });
    fold.addEventListener("click", () => {
      if (!folded.delete(index)) folded.add(index);
      fold.setAttribute("aria-expanded", String(!folded.has(index)));
      show();
      mark();
    });
    items[index].prepend(fold);
  });
  show();
  byId("steps").append(...items);
  let current = -1;
  /** A step that is folded away is marked at the one around it. */
  const mark = () => {
    const shown = [current, ...ancestors(parents, current)].find((each) => items[each] && !items[each].hidden);
    items.forEach((item, index) => (index === shown ? rowOf(item).setAttribute("aria-current", "step") : rowOf(item).removeAttribute("aria-current")));
    scrollInto(byId("steps"), items[shown]);
  };
  return (index) => {
    if (index === current) return;
    current = index;
    mark();
  };
}

/** The step around each; -1 for none. @param {any[]} steps */
function parentsOf(steps) {
  return steps.map((step, index) => {
    for (let before = index - 1; before >= 0; before--) if (steps[before].depth < step.depth) return before;
    return -1;
  });
}

function rowOf(item) {
  return item.querySelector(".step");
}

function ancestors(parents, index) {
  const found = [];
  for (let each = parents[index] ?? -1; each >= 0; each = parents[each]) found.push(each);
  return found;
}

function row(step, index, select) {
  const isNamed = !/^steps?[_[]/.test(step.id);
  const isFault = step.verb === "inject" && step.tone === "good";
  const failure = step.message && step.status !== "passed";
  const title = isNamed ? `${step.id}: ${step.summary}` : step.summary;
  return element(
    `button.step.${isFault ? "injected" : step.tone}`,
    { type: "button", onclick: () => select(index), title },
    element("i.sign", { role: "img", "aria-label": isFault ? "fault injected" : statusWord(step.status) }),
    element("span.title", {}, element("b", {}, ...breakable(isNamed ? step.id : step.summary)), isNamed ? element("span.what", {}, ...breakable(` ${step.summary}`)) : null),
    element("code.place", { title: "Line of the file" }, step.line ? `:${step.line}` : ""),
    element("span.took", {}, step.status === "not reached" ? "–" : duration(step)),
    failure && element("span.why", {}, step.errorCode && element("b", {}, step.errorCode), ` ${step.message}`),
    ...step.broken.map((text) => element("span.why", {}, text)),
    step.status === "expected error" && element("span.what.wide", {}, "failed as the file expects"),
  );
}

/** How long a step took; nothing where it took no time. */
function duration({ start, end }) {
  return end - start < 0.005 ? "" : `${(end - start).toFixed(2)} s`;
}

/** What programs outside commanded, folded where it went well. */
function commandList({ commands, tone }, seek) {
  const total = commands.reduce((sum, { count }) => sum + count, 0);
  const bad = commands.filter(({ isBad }) => isBad).length;
  const rows = commands.map(({ time, until, count, what, answer, isBad }) =>
    element(
      isBad ? "div.bad" : "div",
      {},
      element("button.link", { type: "button", onclick: () => seek(time), title: "Show this moment" }, `${time.toFixed(2)} s`),
      element("span", {}, count > 1 ? `${count} × ${what}, until ${until.toFixed(2)} s` : what, element("span.what", {}, ` ${answer}`)),
    ),
  );
  const title = `${total} ${total === 1 ? "command" : "commands"}${bad ? `, ${bad} without success` : ""}`;
  return element("details.commands", { open: tone === "bad" }, element("summary", {}, title), ...rows);
}

function dot(verdict, number, select) {
  return element(`button.dot.${tone(verdict.status)}`, {
    type: "button", tabindex: -1, title: `${verdict.text}: ${verdict.status}`, onclick: () => select(number),
  });
}
