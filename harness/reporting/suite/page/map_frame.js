// The frame of the map of runs: where its axes lie in pixels, grid lines, and what they stand for.

const LEFT = 58, RIGHT = 12, TOP = 20, BOTTOM = 34;
const COLUMN = 110; // [pixels] of a label across

/** A colour of the page's theme. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/**
 * The frame of two axes in a canvas of a size.
 *
 * @param {import("./map_axis.js").Axis} across
 * @param {import("./map_axis.js").Axis} up
 */
export function frameOf(across, up, points, width, height) {
  const [left, right] = across.range(points), [low, high] = up.range(points);
  const inner = { width: width - LEFT - RIGHT, height: height - TOP - BOTTOM };
  const x = (value) => LEFT + (value - left) / (right - left) * inner.width;
  const y = (value) => height - BOTTOM - (value - low) / (high - low) * inner.height;
  return { across, up, left, right, low, high, width, height, inner, x, y };
}

/** Draw grid lines, their values, and the names of the axes. */
export function drawFrame(pen, { across, up, left, right, low, high, width, height, x, y }) {
  pen.font = "11px system-ui, sans-serif"; pen.strokeStyle = color("--grid"); pen.fillStyle = color("--muted");
  pen.textAlign = "center"; pen.textBaseline = "top";
  for (const value of across.ticks(left, right, Math.max(2, Math.floor(width / COLUMN)))) {
    line(pen, x(value), TOP, x(value), height - BOTTOM);
    pen.fillText(across.text(value), x(value), height - BOTTOM + 5);
  }
  pen.textAlign = "right"; pen.textBaseline = "middle";
  for (const value of up.ticks(low, high, 5)) {
    line(pen, LEFT, y(value), width - RIGHT, y(value));
    pen.fillText(up.text(value).slice(0, 9), LEFT - 5, y(value));
  }
  pen.textAlign = "center"; pen.textBaseline = "bottom";
  pen.fillText(`${across.label} →`, (width + LEFT) / 2, height - 2);
  pen.textAlign = "left"; pen.textBaseline = "top";
  pen.fillText(`↑ ${up.label}`, LEFT - 5, 2);
}

function line(pen, x1, y1, x2, y2) {
  pen.beginPath(); pen.moveTo(x1, y1); pen.lineTo(x2, y2); pen.stroke();
}
