// The failure rate over the map, in cells.

import { color } from "./map_frame.js";

const CELLS = 12; // along an axis of numbers

/** @typedef {{ x: number, y: number, width: number, height: number, failed: number, all: number }} Cell */

/** Draw the share of runs that failed in each cell. @returns {Cell[]} */
export function drawRate(pen, frame, points, causeColumn, weights) {
  const columns = frame.across.words.length || CELLS, rows = frame.up.words.length || CELLS;
  const size = { width: frame.inner.width / columns, height: frame.inner.height / rows };
  const cells = new Map();
  for (const point of points) {
    const column = place(point[frame.across.index], frame.left, frame.right, columns);
    const row = place(point[frame.up.index], frame.low, frame.high, rows), key = row * columns + column;
    if (!cells.has(key)) {
      const x = frame.x(frame.left) + column * size.width, y = frame.y(frame.low) - (row + 1) * size.height;
      cells.set(key, { x, y, ...size, failed: 0, all: 0 });
    }
    const cell = cells.get(key), isFailed = point[causeColumn] >= 0, weight = weights[isFailed ? 1 : 0];
    cell.all += weight; cell.failed += isFailed ? weight : 0;
  }
  for (const cell of cells.values()) drawCell(pen, cell);
  return [...cells.values()];
}

/** Which of so many equal parts of a range a value lies in. */
function place(value, low, high, parts) {
  return Math.min(parts - 1, Math.floor((value - low) / (high - low) * parts));
}

function drawCell(pen, { x, y, width, height, failed, all }) {
  const share = failed / all;
  pen.globalAlpha = failed ? 0.25 + 0.75 * share : 0.18;
  pen.fillStyle = color(failed ? "--bad" : "--good");
  pen.fillRect(x + 0.5, y + 0.5, width - 1, height - 1);
  pen.globalAlpha = 1;
  if (!failed || width <= 28) return;
  pen.fillStyle = color(share > 0.6 ? "--panel" : "--text"); pen.textAlign = "center"; pen.textBaseline = "middle";
  pen.fillText(`${Math.round(failed)}/${Math.round(all)}`, x + width / 2, y + height / 2);
}

/** The cell at a place. @param {Cell[]} cells @returns {Cell | null} */
export function cellAt(cells, x, y) {
  return cells.find((cell) => x >= cell.x && x <= cell.x + cell.width && y >= cell.y && y <= cell.y + cell.height) ?? null;
}
