// The list of steps: what each did, how long it took, where it is in the file, why it failed.

import { byId, element, scrollInto } from "./dom.js";
import { STATUS } from "./units.js";

/**
 * @param {import("./payload.js").Payload} payload
 * @param {(index: number) => void} select
 * @returns {(index: number) => void} marks the step that runs
 */
export function makeSteps({ run }, select) {
  const items = run.steps.map((step, index) => {
    const state = STATUS[step.status]?.word ?? step.status;
    const place = step.line ? `line ${step.line}` : "";
    const isNamed = !/^steps?[_[]/.test(step.id);
    const failure = step.message && step.status !== "passed";
    return element(
      `button.step.${step.tone}`,
      { type: "button", onclick: () => select(index), style: `--depth: ${step.depth}` },
      element("i.sign", { role: "img", "aria-label": state }),
      element("b", {}, isNamed ? step.id : step.summary),
      element("span.took", {}, step.status === "not reached" ? "–" : `${(step.end - step.start).toFixed(2)} s`),
      element("span.what", {}, isNamed ? `${step.summary}  ` : "", element("code", {}, place)),
      failure && element("span.why", {}, step.errorCode && element("b", {}, step.errorCode), ` ${step.message}`),
      ...step.broken.map((text) => element("span.why", {}, text)),
      step.status === "expected error" && element("span.what", {}, "failed as the file expects"),
    );
  });
  byId("steps").append(...items.map((item) => element("li", {}, item)));
  let current = -1;
  return (index) => {
    if (index === current) return;
    items[current]?.removeAttribute("aria-current");
    items[index]?.setAttribute("aria-current", "step");
    scrollInto(byId("steps"), items[index]);
    current = index;
  };
}
