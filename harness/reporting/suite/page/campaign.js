// Draws the runs over two parameters, or their failure rate, from the data in the page.

/** Draw the map where the page has one. */
export function drawCampaign() {
  const section = document.getElementById("map");
  if (!section) return;
  const data = JSON.parse(section.querySelector("script").textContent);
  const canvas = section.querySelector("canvas"), caption = section.querySelector("output");
  const [across, up, kind] = ["x", "y", "kind"].map((name) => section.querySelector(`select[name=${name}]`));
  const count = data.parameters.length, SHARE = count, CAUSE = count + 1, NAME = count + 2, LINK = count + 3;
  const axes = [...data.parameters, { name: "worst margin (share of its limit)", unit: "", words: [] }];
  const CELLS = 12, NEAR = 12, LEFT = 58, BOTTOM = 34, TOP = 20, RIGHT = 12;
  let placed = [], marked = null;

  for (const select of [across, up]) {
    axes.forEach((axis, index) => select.add(new Option(label(axis), index)));
  }
  /** An axis in words, with its unit. */
  function label({ name, unit }) { return unit ? `${name} [${unit}]` : name; }

  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  /** The colour of a cause; red tones first, none of them the green of what passed. */
  const causeColor = (cause) => color(["--s1", "--s3", "--s4", "--s0", "--s6", "--s9", "--s5", "--s8"][cause % 8]);

  function text(axis, value) {
    const { words, unit } = axes[axis];
    if (value === null) return "?";
    if (words.length) return words[Math.round(value)] ?? "";
    return `${Number(value.toPrecision(4))}${unit ? ` ${unit}` : ""}`;
  }

  /** Where an axis begins and ends. @param {number} axis */
  function range(axis) {
    let low = Infinity, high = -Infinity;
    for (const point of data.points) {
      if (point[axis] === null) continue;
      low = Math.min(low, point[axis]); high = Math.max(high, point[axis]);
    }
    if (axes[axis].words.length) return [-0.5, axes[axis].words.length - 0.5];
    if (axis === SHARE) { low = Math.min(low, 0); high = Math.max(high, 0); }
    const room = (high - low || 1) * 0.04;
    return [low - room, high + room];
  }

  function draw() {
    const width = canvas.clientWidth, height = canvas.clientHeight, scale = devicePixelRatio || 1;
    canvas.width = width * scale; canvas.height = height * scale;
    const pen = canvas.getContext("2d");
    pen.scale(scale, scale);
    pen.clearRect(0, 0, width, height);
    const x = Number(across.value), y = Number(up.value);
    const [left, right] = range(x), [low, high] = range(y);
    const px = (value) => LEFT + (value - left) / (right - left) * (width - LEFT - RIGHT);
    const py = (value) => height - BOTTOM - (value - low) / (high - low) * (height - BOTTOM - TOP);
    frame(pen, width, height, [x, left, right, px], [y, low, high, py]);
    placed = [];
    const points = data.points.filter((point) => point[x] !== null && point[y] !== null);
    legend(points);
    if (kind.value === "rate") rate(pen, width, height, points, x, y, [left, right], [low, high]);
    else runs(pen, points, x, y, px, py);
    if (marked) ring(pen);
  }

  function frame(pen, width, height, [x, left, right, px], [y, low, high, py]) {
    pen.font = "11px system-ui, sans-serif"; pen.strokeStyle = color("--grid"); pen.fillStyle = color("--muted");
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const value of ticks(x, left, right, Math.max(2, Math.floor(width / 110)))) {
      line(pen, px(value), TOP, px(value), height - BOTTOM);
      pen.fillText(text(x, value), px(value), height - BOTTOM + 5);
    }
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const value of ticks(y, low, high, 5)) {
      line(pen, LEFT, py(value), width - RIGHT, py(value));
      pen.fillText(text(y, value).slice(0, 9), LEFT - 5, py(value));
    }
    pen.textAlign = "center"; pen.textBaseline = "bottom";
    pen.fillText(`${label(axes[x])} →`, (width + LEFT) / 2, height - 2);
    pen.textAlign = "left"; pen.textBaseline = "top";
    pen.fillText(`↑ ${label(axes[y])}`, LEFT - 5, 2);
  }

  function ticks(axis, low, high, most) {
    if (axes[axis].words.length) return axes[axis].words.map((_, index) => index);
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough);
    const found = [];
    for (let index = Math.ceil(low / step); index * step <= high; index++) found.push(index * step);
    return found;
  }

  function line(pen, x1, y1, x2, y2) {
    pen.beginPath(); pen.moveTo(x1, y1); pen.lineTo(x2, y2); pen.stroke();
  }

  /** Passed runs first, so that failures are on top; words are spread a little. */
  function runs(pen, points, x, y, px, py) {
    const spread = (axis, index) => axes[axis].words.length ? ((index * 0.618) % 1 - 0.5) * 0.5 : 0;
    const order = points.map((point, index) => [point, index]).sort((a, b) => (a[0][CAUSE] >= 0) - (b[0][CAUSE] >= 0));
    for (const [point, index] of order) {
      const at = [px(point[x] + spread(x, index)), py(point[y] + spread(y, index + 7))];
      const isFailed = point[CAUSE] >= 0;
      pen.fillStyle = isFailed ? causeColor(point[CAUSE]) : color("--good");
      pen.globalAlpha = isFailed ? 0.95 : points.length > 2000 ? 0.25 : 0.5;
      pen.beginPath(); pen.arc(...at, isFailed ? 4 : 3, 0, 7); pen.fill();
      placed.push([...at, point]);
    }
    pen.globalAlpha = 1;
  }

  function rate(pen, width, height, points, x, y, [left, right], [low, high]) {
    const columns = axes[x].words.length || CELLS, rows = axes[y].words.length || CELLS;
    const cells = new Map();
    for (const point of points) {
      const column = Math.min(columns - 1, Math.floor((point[x] - left) / (right - left) * columns));
      const row = Math.min(rows - 1, Math.floor((point[y] - low) / (high - low) * rows));
      const cell = cells.get(row * columns + column) ?? { failed: 0, all: 0, row, column };
      const isFailed = point[CAUSE] >= 0, weight = data.weights[isFailed ? 1 : 0];
      cell.all += weight; cell.failed += isFailed ? weight : 0;
      cells.set(row * columns + column, cell);
    }
    const w = (width - LEFT - RIGHT) / columns, h = (height - BOTTOM - TOP) / rows;
    for (const cell of cells.values()) {
      const at = [LEFT + cell.column * w, height - BOTTOM - (cell.row + 1) * h], share = cell.failed / cell.all;
      pen.globalAlpha = cell.failed ? 0.25 + 0.75 * share : 0.18;
      pen.fillStyle = color(cell.failed ? "--bad" : "--good");
      pen.fillRect(at[0] + 0.5, at[1] + 0.5, w - 1, h - 1);
      pen.globalAlpha = 1; pen.fillStyle = color(share > 0.6 ? "--panel" : "--text"); pen.textAlign = "center"; pen.textBaseline = "middle";
      if (cell.failed && w > 28) pen.fillText(`${Math.round(100 * share)}%`, at[0] + w / 2, at[1] + h / 2);
      placed.push([at[0] + w / 2, at[1] + h / 2, cell, w / 2, h / 2]);
    }
  }

  function ring(pen) {
    const found = placed.find((each) => each[2] === marked);
    if (!found || kind.value === "rate") return;
    pen.strokeStyle = color("--text"); pen.lineWidth = 2;
    pen.beginPath(); pen.arc(found[0], found[1], 7, 0, 7); pen.stroke();
  }

  /** What is at a place of the canvas. @param {MouseEvent} event */
  function at(event) {
    const box = canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    if (kind.value === "rate") {
      return placed.find(([cx, cy, , w, h]) => Math.abs(cx - x) <= w && Math.abs(cy - y) <= h)?.[2] ?? null;
    }
    let best = null, nearest = NEAR;
    for (const [cx, cy, point] of placed) {
      const distance = Math.hypot(cx - x, cy - y) - (point[CAUSE] >= 0 ? 2 : 0);
      if (distance < nearest) { nearest = distance; best = point; }
    }
    return best;
  }

  function describe(found) {
    if (!found) return "Point at a run to read its values.";
    if (kind.value === "rate") return `${Math.round(found.failed)} of ${Math.round(found.all)} runs failed`;
    const values = data.parameters.map((each, index) => `${each.name} ${text(index, found[index])}`).join(", ");
    const why = found[CAUSE] < 0 ? "passed" : data.causes[found[CAUSE]] ?? "another cause";
    return `${found[NAME]}: ${why}; ${values}`;
  }

  canvas.addEventListener("pointermove", (event) => {
    marked = at(event);
    canvas.style.cursor = marked ? "pointer" : "";
    caption.textContent = describe(marked);
    draw();
  });
  canvas.addEventListener("click", (event) => {
    const found = at(event);
    if (!found || kind.value === "rate") return;
    if (found[LINK]) location.href = found[LINK];
    else {
      const search = document.querySelector("#search input");
      search.value = found[NAME];
      search.dispatchEvent(new Event("input"));
      document.getElementById("cases").scrollIntoView();
    }
  });
  for (const select of [across, up, kind]) select.addEventListener("change", draw);
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);

  /** The causes of the drawn runs, and how many have no place on these axes. */
  function legend(points) {
    const present = new Set(points.map((point) => point[CAUSE])), missing = data.points.length - points.length;
    const entries = [[-1, "passed"], ...data.causes.map((cause, index) => [index, cause]), [data.causes.length, "other causes"]];
    const shown = entries.filter(([index]) => present.has(index)).map(([index, name]) => {
      const entry = document.createElement("span"), dot = document.createElement("i");
      dot.style.background = index < 0 ? color("--good") : causeColor(index);
      entry.append(dot, name);
      return entry;
    });
    if (missing) shown.push(`${missing} of ${data.points.length} runs have no such values and are not drawn`);
    section.querySelector(".legend").replaceChildren(...shown);
  }

  section.hidden = false;
  caption.textContent = describe(null);
  up.value = count > 1 ? 1 : SHARE;
  draw();
}
