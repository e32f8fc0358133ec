// The runs of the map as dots, in the colours of their causes.

import { color } from "./map_frame.js";

const NEAR = 12; // [pixels] from a dot's centre, in which the pointer is at it
const CAUSE_COLORS = ["--s1", "--s3", "--s4", "--s0", "--s6", "--s9", "--s5", "--s8"]; // red tones first, none the green of what passed
const MANY = 2000; // runs, from which those that passed are drawn faint

/** @typedef {{ x: number, y: number, point: any[], isFailed: boolean }} Dot */

/** The colour of a cause by its number; below 0 of runs that passed. */
export function causeColor(cause) {
  return color(cause < 0 ? "--good" : CAUSE_COLORS[cause % CAUSE_COLORS.length]);
}

/** Draw the runs, those that passed first, in a ring where they have a report and others have none; words are spread a little. @returns {Dot[]} */
export function drawRuns(pen, frame, points, { cause: causeColumn, link }) {
  const hasRings = points.some((point) => !point[link]);
  const spread = (axis, index) => axis.words.length ? ((index * 0.618) % 1 - 0.5) * 0.5 : 0;
  const dots = points.map((point, index) => ({
    x: frame.x(point[frame.across.index] + spread(frame.across, index)),
    y: frame.y(point[frame.up.index] + spread(frame.up, index + 7)),
    point, isFailed: point[causeColumn] >= 0,
  }));
  dots.sort((a, b) => a.isFailed - b.isFailed);
  for (const { x, y, point, isFailed } of dots) {
    pen.fillStyle = causeColor(point[causeColumn]);
    pen.globalAlpha = isFailed ? 0.95 : points.length > MANY ? 0.25 : 0.5;
    pen.beginPath(); pen.arc(x, y, isFailed ? 4 : 3, 0, 7); pen.fill();
    if (!hasRings || !point[link]) continue;
    pen.strokeStyle = pen.fillStyle; pen.lineWidth = 1.5;
    pen.beginPath(); pen.arc(x, y, 6.5, 0, 7); pen.stroke();
  }
  pen.globalAlpha = 1;
  return dots;
}

/** Mark a dot with a ring. @param {Dot} dot */
export function drawRing(pen, { x, y }) {
  pen.strokeStyle = color("--text"); pen.lineWidth = 2;
  pen.beginPath(); pen.arc(x, y, 7, 0, 7); pen.stroke();
}

/** The dot at a place, a failed one rather than one that passed. @param {Dot[]} dots @returns {Dot | null} */
export function dotAt(dots, x, y) {
  let best = null, nearest = NEAR;
  for (const dot of dots) {
    const distance = Math.hypot(dot.x - x, dot.y - y) - (dot.isFailed ? 2 : 0);
    if (distance < nearest) { nearest = distance; best = dot; }
  }
  return best;
}
