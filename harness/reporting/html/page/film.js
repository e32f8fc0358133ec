// A strip of small pictures over the timeline: the moments that decided, and others between them.

import { byId, element } from "./dom.js";
import { seconds, tone } from "./units.js";

const WIDTH = 84; // of a picture, in CSS pixels
const MOST = 18;
const SHARPNESS = 2;

/** Run something when the browser is idle. @param {() => void} task */
function whenIdle(task) {
  if ("requestIdleCallback" in window) window.requestIdleCallback(task, { timeout: 1000 });
  else setTimeout(task, 30);
}

/**
 * Moments that decided, the gravest first: failed steps, verdicts that do not hold, then those with the least room.
 * @param {any} run @returns {{time: number, title: string, tone: string}[]}
 */
export function decidingMoments(run) {
  const failed = run.steps
    .filter(({ status, hasChildren }) => status === "failed" && !hasChildren)
    .map((step) => ({ time: step.end, title: `${step.summary}: failed`, tone: "bad", room: -2 }));
  const judged = run.verdicts
    .filter(({ time }) => time !== null)
    .map((verdict) => ({
      time: verdict.time, title: `${verdict.text}: ${verdict.status}`, tone: tone(verdict.status),
      room: verdict.status === "passed" ? 1 - (verdict.used ?? 0) : -1,
    }));
  return [...failed, ...judged].sort((a, b) => a.room - b.room);
}

/** The moment that each place of the strip shows: the gravest one in its part of the time, or its middle. */
function chosen(moments, { from, to }, count) {
  return Array.from({ length: count }, (_, index) => {
    const [start, end] = [from + (index / count) * (to - from), from + ((index + 1) / count) * (to - from)];
    const isLast = index === count - 1;
    return moments.find(({ time }) => time >= start && (time < end || (isLast && time <= end + 1e-6))) ?? { time: (start + end) / 2, title: "", tone: "" };
  });
}

/**
 * @param {any} run
 * @param {import("./clock.js").Clock} clock
 * @param {(time: number, target: HTMLCanvasElement) => void} draw fills a canvas with the scene at a time
 */
export function makeFilm(run, clock, draw) {
  const strip = byId("film");
  const moments = decidingMoments(run);
  let request = 0;
  const fill = () => {
    const number = ++request;
    const most = clock.duration > 0 ? Math.min(MOST, Math.floor(strip.clientWidth / WIDTH)) : 1;
    const count = Math.max(1, most);
    const shown = chosen(moments, clock.span, count);
    const width = Math.min(strip.clientWidth / count, 2 * WIDTH);
    const pictures = shown.map(({ time, title, tone }) =>
      element(`canvas.waiting${tone && `.${tone}`}`, {
        width: Math.round(width * SHARPNESS), height: Math.round(strip.clientHeight * SHARPNESS),
        title: [title, seconds(time)].filter(Boolean).join("\n"), "data-time": time,
      }),
    );
    strip.replaceChildren(...pictures);
    const next = (index) => {
      if (index >= count || number !== request) return;
      if (clock.isPlaying) return void setTimeout(() => next(index), 500);
      draw(shown[index].time, pictures[index]);
      pictures[index].classList.remove("waiting");
      for (const later of pictures.slice(index + 1)) later.getContext("2d").drawImage(pictures[index], 0, 0);
      whenIdle(() => next(index + 1));
    };
    whenIdle(() => next(0));
  };
  let [last, due] = [0, 0];
  new ResizeObserver(() => {
    if (Math.abs(strip.clientWidth - last) < WIDTH / 2) return;
    last = strip.clientWidth;
    fill();
  }).observe(strip);
  clock.spanListeners.push(() => {
    clearTimeout(due);
    due = setTimeout(fill, 200); // when the zoom rests
  });
  return fill;
}
