// The map of a campaign: its runs over two quantities, or their failure rate; a click opens a run.

import { axesOf } from "./map_axis.js";
import { drawFrame, frameOf } from "./map_frame.js";
import { cellAt, drawRate } from "./map_rate.js";
import { causeColor, dotAt, drawRing, drawRuns } from "./map_runs.js";

/** Draw the map where the page has one. */
export function drawCampaign() {
  const section = document.getElementById("map");
  if (!section) return;
  const data = JSON.parse(section.querySelector("script").textContent), axes = axesOf(data.parameters);
  const canvas = section.querySelector("canvas"), caption = section.querySelector("output"), legend = section.querySelector(".legend");
  const [across, up, kind] = ["x", "y", "kind"].map((name) => section.querySelector(`select[name=${name}]`));
  const count = data.parameters.length, columns = { cause: count + 1, name: count + 2, link: count + 3 };
  const opened = data.points.filter((point) => point[columns.link]).length;
  const click = opened === data.points.length ? "A click opens it." : `A click ${opened ? `opens one of the ${opened} with a report, in a ring, and ` : ""}shows the row of one without a report; ${caption.dataset.others}.`;
  const nothing = `Point at a run to read its values. ${click}`;
  let dots = [], cells = [], marked = null;

  for (const select of [across, up]) axes.forEach((axis) => select.add(new Option(axis.label, axis.index)));
  up.value = count > 1 ? 1 : count;

  function draw() {
    const width = canvas.clientWidth, height = canvas.clientHeight, scale = devicePixelRatio || 1;
    canvas.width = width * scale; canvas.height = height * scale;
    const pen = canvas.getContext("2d"), x = axes[across.value], y = axes[up.value];
    pen.scale(scale, scale);
    const points = data.points.filter((point) => point[x.index] !== null && point[y.index] !== null);
    const frame = frameOf(x, y, data.points, width, height);
    drawFrame(pen, frame);
    const hasCells = kind.value === "rate";
    cells = hasCells ? drawRate(pen, frame, points, columns.cause, data.weights) : [];
    dots = hasCells ? [] : drawRuns(pen, frame, points, columns);
    const ringed = dots.find(({ point }) => point === marked);
    if (ringed) drawRing(pen, ringed);
    legend.replaceChildren(...legendOf(data, points, columns.cause));
  }

  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect(), place = [event.clientX - box.left, event.clientY - box.top];
    const cell = cellAt(cells, ...place);
    marked = dotAt(dots, ...place)?.point ?? null;
    canvas.style.cursor = marked ? "pointer" : "";
    caption.textContent = cell ? `${Math.round(cell.failed)} of ${Math.round(cell.all)} runs failed` : marked ? valuesOf(data, axes, marked, columns) : nothing;
    draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (event.key === "Enter" && marked) open(marked[columns.link], marked[columns.name]);
    if (!step || !dots.length) return;
    event.preventDefault();
    const row = [...dots].sort((a, b) => a.x - b.x), place = row.findIndex(({ point }) => point === marked);
    marked = row.at((place + step) % row.length).point;
    caption.textContent = valuesOf(data, axes, marked, columns);
    draw();
  });
  canvas.addEventListener("click", () => marked && open(marked[columns.link], marked[columns.name]));
  for (const select of [across, up, kind]) select.addEventListener("change", draw);
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  section.hidden = false;
  caption.textContent = nothing;
  draw();
}

/** A run in words: why it ended as it did, and its values. */
function valuesOf(data, axes, point, columns) {
  const values = data.parameters.map(({ name }, index) => `${name} ${axes[index].text(point[index])}`).join(", ");
  const why = point[columns.cause] < 0 ? "passed" : data.causes[point[columns.cause]] ?? "another cause";
  return `${point[columns.name]}: ${why}; ${values}`;
}

/** Go to the page of a run, or to its row where it has none. */
function open(link, name) {
  if (link) { location.href = link; return; }
  const search = document.querySelector("#search input");
  search.value = name;
  search.dispatchEvent(new Event("input"));
  document.getElementById("cases").scrollIntoView();
}

/** The causes of the drawn runs, and how many have no place on these axes. */
function legendOf(data, points, causeColumn) {
  const present = new Set(points.map((point) => point[causeColumn])), missing = data.points.length - points.length;
  const entries = [[-1, "passed"], ...data.causes.map((cause, index) => [index, cause]), [data.causes.length, "other causes"]];
  const shown = entries.filter(([index]) => present.has(index)).map(([index, name]) => {
    const entry = document.createElement("span"), dot = document.createElement("i");
    dot.style.background = causeColor(index);
    entry.append(dot, name);
    return entry;
  });
  if (missing) shown.push(`${missing} of ${data.points.length} runs have no such values and are not drawn`);
  return shown;
}
