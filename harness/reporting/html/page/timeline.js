// The timeline: steps and their parts, marks of verdicts, the cursor; a slider for keyboard and reader.

import { byId, element } from "./dom.js";
import { seconds, tone } from "./units.js";

const SMALL_STEP = 0.1; // [s]
const LARGE_STEP = 1; // [s]
const ZOOM = 1.3; // factor of a key or a notch of the wheel
const NOTCH = 100; // of a wheel [pixels]
const ROWS = 2; // steps, and what they are made of

/** One sign for each kind of step, where its words do not fit. */
const ICONS = {
  move_to: "↷", ptp: "↷", sequence: "↷", lin: "→", move_relative: "→", cartesian_path: "⇝", circ: "⌒",
  gripper: "⊓", grasp: "⊓", release: "⊔", pick: "↑", place: "↓", wait: "…", settle: "…", capture: "◉", inject: "!",
  add_object: "+", remove_object: "−", clear_objects: "−", move_object: "⇢", attach_object: "∞", detach_object: "∝",
  allow_collisions: "⊙", repeat: "↻", parallel: "∥", include: "▤", external: "⇄",
};
const OTHER = "•";

/**
 * @param {import("./payload.js").Payload} payload
 * @param {import("./clock.js").Clock} clock
 * @param {{step: (index: number) => void, verdict: (index: number) => void}} select
 */
export function makeTimeline({ run }, clock, select) {
  const track = byId("track");
  /** What lies at a time, with how to put it there. @type {((share: (time: number) => number) => void)[]} */
  const placed = [];
  run.steps.forEach((step, index) => step.status !== "not reached" && placed.push(band(track, step, index)));
  run.verdicts.forEach((verdict, index) => verdict.time !== null && placed.push(mark(verdict, () => select.verdict(index))));
  track.classList.toggle("flat", run.steps.every(({ depth }) => depth === 0));
  const share = (time) => (clock.duration > 0 ? (100 * (time - clock.span.from)) / (clock.span.to - clock.span.from) : 0);
  const point = (time) => {
    const at = share(time);
    byId("cursor").style.left = `${at}%`;
    byId("cursor").hidden = at < -0.01 || at > 100.01;
    byId("time").textContent = `${seconds(time)} / ${seconds(clock.duration)}`;
    track.setAttribute("aria-valuenow", time.toFixed(3));
    const step = run.steps[stepAt(run.steps, time)];
    track.setAttribute("aria-valuetext", step ? `${seconds(time)}, ${step.summary}` : seconds(time));
  };
  clock.onSpan(() => {
    for (const put of placed) put(share);
    point(clock.time);
  });
  clock.onTime(point);
  byId("unzoom").addEventListener("click", () => clock.show());
  clock.onSpan(() => (byId("unzoom").hidden = clock.isWhole));
  dragToSeek(byId("strip"), track, clock);
  seekByKeys(track, clock);
}

function band(track, step, index) {
  const isInstant = step.end <= step.start;
  const title = `${index + 1}. ${step.summary}\n${seconds(step.start)} to ${seconds(step.end)}`;
  const words = [element("span", {}, step.summary), element("i", { "aria-hidden": "true" }, ICONS[step.verb] ?? OTHER)];
  const made = element(`span.band.${step.tone}${isInstant ? ".instant" : ""}${step.verb === "inject" ? ".injected" : ""}`, { title }, ...(isInstant ? [] : words));
  made.style.setProperty("--row", String(Math.min(step.depth, ROWS - 1)));
  made.style.zIndex = step.depth;
  track.append(made);
  return (share) => {
    made.style.left = `${share(step.start)}%`;
    if (!isInstant) made.style.width = `calc(${share(step.end) - share(step.start)}% - 1px)`;
  };
}

function mark(verdict, select) {
  const made = element(`button.mark.${tone(verdict.status)}`, {
    type: "button", tabindex: -1, title: `${verdict.text}: ${verdict.status}`, onclick: select,
  });
  if (verdict.status !== "passed") made.style.zIndex = 2;
  byId("marks").append(made);
  return (share) => {
    const at = share(verdict.time);
    made.style.left = `${at}%`;
    made.hidden = at < -0.01 || at > 100.01;
  };
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

/** Drag to seek; the wheel zooms, sideways or with shift it moves what is shown. */
function dragToSeek(area, track, clock) {
  const timeAt = (event) => {
    const box = track.getBoundingClientRect();
    return clock.span.from + ((event.clientX - box.left) / box.width) * (clock.span.to - clock.span.from);
  };
  const seek = (event) => clock.seek(timeAt(event));
  area.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button") || event.button !== 0) return;
    area.setPointerCapture(event.pointerId);
    seek(event);
    area.addEventListener("pointermove", seek);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    area.addEventListener(end, () => area.removeEventListener("pointermove", seek));
  }
  area.addEventListener(
    "wheel",
    (event) => {
      if (clock.duration <= 0) return;
      event.preventDefault();
      const sideways = event.shiftKey ? event.deltaY || event.deltaX : event.deltaX;
      if (sideways) clock.pan(sideways / area.clientWidth);
      else clock.zoom(ZOOM ** (event.deltaY / NOTCH), timeAt(event));
    },
    { passive: false },
  );
}

function seekByKeys(track, clock) {
  track.setAttribute("aria-valuemax", clock.duration.toFixed(3));
  track.addEventListener("keydown", (event) => {
    const moves = {
      ArrowLeft: -SMALL_STEP, ArrowRight: SMALL_STEP, ArrowDown: -SMALL_STEP, ArrowUp: SMALL_STEP,
      PageDown: -LARGE_STEP, PageUp: LARGE_STEP, Home: -Infinity, End: Infinity,
    };
    const views = {
      "+": () => clock.zoom(1 / ZOOM), "=": () => clock.zoom(1 / ZOOM), "-": () => clock.zoom(ZOOM),
      0: () => clock.show(), "<": () => clock.pan(-0.25), ">": () => clock.pan(0.25),
    };
    if (!(event.key in moves || event.key in views) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    if (event.key in views) return void views[event.key]();
    const move = moves[event.key] * (event.shiftKey ? 5 : 1);
    clock.seek(Number.isFinite(move) ? clock.time + move : move > 0 ? clock.duration : 0);
  });
}
