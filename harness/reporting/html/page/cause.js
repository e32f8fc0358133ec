// Why a run failed, at the top of its page: the first cause, what happened before it, and how to run it again.

import { breakable, byId, element } from "./dom.js";
import { seconds } from "./units.js";

const RESTED = 0.01; // of its limit: what stayed below has not begun

/** The step that failed by itself, and the first expectation that does not hold. @param {any} run */
export function firstFailure(run) {
  const step = run.steps.findIndex(({ status, hasChildren }) => status === "failed" && !hasChildren);
  const verdict = run.verdicts.findIndex(({ status }) => status === "failed");
  return { step, verdict: step < 0 ? verdict : -1 };
}

/** When the physics lost what a failed verdict is about [s]; null where it did not while it was judged. @param {any} run @param {any} verdict */
export function lossOf(run, { bodies, ...verdict }) {
  const { start, end } = judgedSpan(run, verdict);
  const isIt = ({ kind, isWarning, time, message }) =>
    kind === "held" && isWarning && time !== null && time >= start && time <= end && bodies.some((name) => message.includes(name));
  return run.findings.find(isIt)?.time ?? null;
}

/** When to look at a verdict [s]: of what was to move and never did, when it was lost or the end of the step that was to move it. @param {any} run @param {any} verdict */
export function momentOf(run, verdict) {
  const [measure] = verdict.measures;
  const rested = verdict.status === "failed" && measure?.comparison === ">=" && Math.abs(measure.value) <= RESTED * Math.abs(measure.limit);
  const { start } = judgedSpan(run, verdict);
  if (!rested || verdict.time === null || verdict.time > start + 1e-3) return verdict.time;
  const loss = lossOf(run, verdict);
  if (loss !== null) return loss;
  const movers = run.steps.filter(({ summary, end, status }) => status !== "not reached" && end > verdict.time && verdict.bodies.some((name) => summary.includes(name)));
  return movers.find(({ verb }) => verb === "pick" || verb === "grasp")?.end ?? movers[0]?.end ?? verdict.time;
}

/** The time over which a verdict was judged: its step's, or the whole run's [s]. @param {any} run @param {any} verdict */
export function judgedSpan(run, verdict) {
  const step = run.steps.find(({ id }) => id && id === verdict.step);
  return { start: step?.start ?? 0, end: step?.end ?? run.duration, step: step ?? null };
}

/** Steps that injected a fault before a time. @param {any} run @param {number} time [s] @returns {number[]} */
export function faultsBefore(run, time) {
  return run.steps.flatMap(({ verb, status, end }, index) => (verb === "inject" && status === "passed" && end <= time + 1e-6 ? [index] : []));
}

/** @param {any} run @param {{step: (index: number) => void, verdict: (index: number) => void, time: (time: number) => void}} select */
export function showCause(run, select) {
  const first = firstFailure(run);
  if (run.outcome === "passed" || (first.step < 0 && first.verdict < 0)) return;
  const [step, verdict] = [run.steps[first.step], run.verdicts[first.verdict]];
  const time = step ? step.end : momentOf(run, verdict) ?? run.duration;
  const owner = verdict && judgedSpan(run, verdict).step;
  const where = (line) => (line ? element("span.what", {}, ` · line ${line}`) : null);
  const link = (title, onclick) => element("button.link", { type: "button", onclick }, ...breakable(title));
  const head = step
    ? [link(`${step.summary}: ${step.errorCode}`, () => select.step(first.step)), ` ${step.message}`, where(step.line)]
    : [link(`${owner ? `${owner.id || owner.summary}: ` : ""}${verdict.text}:`, () => select.verdict(first.verdict)), ` ${verdict.reason}`, where(verdict.line)];
  const faults = faultsBefore(run, time).map((index) => {
    const { summary, line, end } = run.steps[index];
    return row("Fault", link(summary, () => select.step(index)), element("span.what", {}, ` · injected at t = ${seconds(end)}`), where(line));
  });
  const advice = step?.explanation?.advice;
  const known = run.findings.filter((each) => each.isWarning && each.time !== null).map(({ message, time: at }) => row("Found", link(message, () => select.time(at))));
  const others = run.verdicts.filter(({ status }, index) => status === "failed" && index !== first.verdict).length;
  byId("cause").replaceChildren(
    ...row("Cause", element("b", {}, head[0]), ...head.slice(1), others > 0 && element("span.what", {}, ` · ${others} more expectation${others > 1 ? "s do" : " does"} not hold either`)),
    ...(advice ? row("To do", advice) : []), ...faults.flat(), ...known.slice(0, 2).flat(), ...commandRow(run),
  );
  byId("cause").hidden = false;
}

function row(title, ...children) {
  return [element("dt", {}, title), element("dd", {}, ...children)];
}

/** The command that runs this case; nothing for a recording, which no command repeats. */
function commandRow({ again: command }) {
  if (!command) return [];
  const code = element("code", {}, command);
  const copy = element("button.copy", { type: "button", title: "Copy the command" }, "copy");
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(command);
    } catch {
      getSelection().selectAllChildren(code);
      document.execCommand("copy");
    }
    copy.textContent = "copied";
  });
  return row("Again", code, " ", copy);
}
