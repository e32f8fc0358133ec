// A strip of small pictures over the timeline, drawn by the 3D view when there is nothing else to do.

import { byId, element } from "./dom.js";

const WIDTH = 76; // of a picture, in CSS pixels
const MOST = 18;
const SHARPNESS = 2;

/** Run something when the browser is idle. @param {() => void} task */
function whenIdle(task) {
  if ("requestIdleCallback" in window) window.requestIdleCallback(task, { timeout: 1000 });
  else setTimeout(task, 30);
}

/**
 * @param {import("./clock.js").Clock} clock
 * @param {(time: number, target: HTMLCanvasElement) => void} draw fills a canvas with the scene at a time
 */
export function makeFilm(clock, draw) {
  const strip = byId("film");
  let request = 0;
  const fill = () => {
    const number = ++request;
    const most = clock.duration > 0 ? Math.min(MOST, Math.floor(strip.clientWidth / WIDTH)) : 1;
    const count = Math.max(1, most);
    const width = Math.min(strip.clientWidth / count, 2 * WIDTH);
    const pictures = Array.from({ length: count }, () =>
      element("canvas", { width: Math.round(width * SHARPNESS), height: Math.round(strip.clientHeight * SHARPNESS) }),
    );
    strip.replaceChildren(...pictures);
    const next = (index) => {
      if (index >= count || number !== request) return;
      if (clock.isPlaying) return void setTimeout(() => next(index), 500);
      draw(((index + 0.5) / count) * clock.duration, pictures[index]);
      whenIdle(() => next(index + 1));
    };
    whenIdle(() => next(0));
  };
  let last = 0;
  new ResizeObserver(() => {
    if (Math.abs(strip.clientWidth - last) < WIDTH / 2) return;
    last = strip.clientWidth;
    fill();
  }).observe(strip);
  return fill;
}
