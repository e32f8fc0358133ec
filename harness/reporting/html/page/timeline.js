// The timeline: bands of steps, marks of verdicts, the cursor; a slider for keyboard and reader.

import { byId, element } from "./dom.js";
import { seconds, tone } from "./units.js";

const NARROWEST = 0.0; // share of the run that a step without duration takes
const SMALL_STEP = 0.1; // [s]
const LARGE_STEP = 1; // [s]

/**
 * @param {import("./payload.js").Payload} payload
 * @param {import("./clock.js").Clock} clock
 * @param {{step: (index: number) => void, verdict: (index: number) => void}} select
 */
export function makeTimeline({ run }, clock, select) {
  const track = byId("track");
  const share = (time) => (clock.duration > 0 ? (100 * time) / clock.duration : 0);
  run.steps.forEach((step, index) => {
    if (step.status === "not reached") return;
    const isInstant = step.end - step.start <= clock.duration * NARROWEST;
    const band = element(
      `span.band.${step.band}${isInstant ? ".instant" : ""}`,
      { title: `${index + 1}. ${step.summary}\n${seconds(step.start)} to ${seconds(step.end)}` },
      isInstant ? "" : element("span", {}, step.summary),
    );
    band.style.left = `${share(step.start)}%`;
    if (!isInstant) band.style.width = `calc(${share(step.end - step.start)}% - 1px)`;
    band.style.zIndex = step.depth;
    track.append(band);
  });
  const marks = byId("marks");
  run.verdicts.forEach((verdict, index) => {
    if (verdict.time === null) return;
    const mark = element(`button.mark.${tone(verdict.status)}`, {
      type: "button", tabindex: -1, title: `${verdict.text}: ${verdict.status}`,
      onclick: () => select.verdict(index),
    });
    mark.style.left = `${share(verdict.time)}%`;
    if (verdict.status !== "passed") mark.style.zIndex = 2;
    marks.append(mark);
  });
  dragToSeek(byId("timeline"), track, clock);
  seekByKeys(track, clock);
  clock.onTime((time) => {
    byId("cursor").style.left = `${share(time)}%`;
    byId("time").textContent = seconds(time);
    track.setAttribute("aria-valuenow", time.toFixed(3));
    const step = run.steps[stepAt(run.steps, time)];
    track.setAttribute("aria-valuetext", step ? `${seconds(time)}, ${step.summary}` : seconds(time));
  });
}

/** The innermost step that runs at a time: the last one that began; -1 when none did. @param {any[]} steps @param {number} time */
export function stepAt(steps, time) {
  let found = -1;
  steps.forEach((step, index) => {
    const isOver = time > step.end && step.end < time - 1e-9;
    if (step.status === "not reached" || step.start > time + 1e-9 || isOver) return;
    const isDeeper = found < 0 || step.depth >= steps[found].depth;
    const hasDuration = step.end > step.start || found < 0 || steps[found].end <= steps[found].start;
    if (isDeeper && (hasDuration || step.end >= time)) found = index;
  });
  return found;
}

function dragToSeek(area, track, clock) {
  const seek = (event) => {
    const box = track.getBoundingClientRect();
    clock.seek(((event.clientX - box.left) / box.width) * clock.duration);
  };
  area.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button") || event.button !== 0) return;
    area.setPointerCapture(event.pointerId);
    seek(event);
    area.addEventListener("pointermove", seek);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    area.addEventListener(end, () => area.removeEventListener("pointermove", seek));
  }
}

function seekByKeys(track, clock) {
  track.setAttribute("aria-valuemax", clock.duration.toFixed(3));
  track.addEventListener("keydown", (event) => {
    const moves = {
      ArrowLeft: -SMALL_STEP, ArrowRight: SMALL_STEP, ArrowDown: -SMALL_STEP, ArrowUp: SMALL_STEP,
      PageDown: -LARGE_STEP, PageUp: LARGE_STEP, Home: -Infinity, End: Infinity,
    };
    if (!(event.key in moves) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const move = moves[event.key] * (event.shiftKey ? 5 : 1);
    clock.seek(Number.isFinite(move) ? clock.time + move : move > 0 ? clock.duration : 0);
  });
}
