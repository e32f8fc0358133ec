// Plots of the last seconds while the cell moves, drawn by the plot of the report page.

import { Plot } from "/view/plot.js";
import { on } from "./connection.js";
import { $, element } from "./dom.js";
import { onUnits, shown, unitName } from "./quantities.js";

const SPAN = 12; // [s] that are shown
const KEPT = 1500; // samples
const REDRAWN = 90; // [ms] between two drawings
const SMOOTH = 3; // samples over which a speed is taken

/** Times, and the values of each series by its name. */
const recorded = { joints: [], positions: [], tcp: [], forces: [], gaps: [] };
let names = [], plot = null, due = 0, kind = "Joint positions";

const column = (samples, index) => ({ times: samples.map((each) => each[0]), values: samples.map((each) => each[1][index]) });
const speeds = (samples, of) => samples.slice(SMOOTH).map(([time, value], i) => {
  const [before, old] = samples[i];
  return [time, time > before ? of(value, old).map((each) => each / (time - before)) : [0]];
});
const difference = (a, b) => a.map((each, i) => each - b[i]);

const KINDS = {
  "Joint positions": ["rad", () => names.map((name, index) => [name, column(recorded.positions, index)])],
  "Joint speeds": ["rad/s", () => { const rows = speeds(recorded.positions, difference); return names.map((name, index) => [name, column(rows, index)]); }],
  "TCP position": ["m", () => ["x", "y", "z"].map((name, index) => [name, column(recorded.tcp, index)])],
  "TCP speed": ["m/s", () => [["TCP", column(speeds(recorded.tcp, (a, b) => [Math.hypot(...difference(a, b))]), 0)]]],
  "Smallest clearance": ["m", () => [["clearance", column(recorded.gaps, 0)]]],
  "Contact force": ["N", () => [["all contacts", column(recorded.forces, 0)]]],
};
const LEAST = { rad: 0.02, "rad/s": 0.02, m: 0.005, "m/s": 0.005, N: 0.1 };

function keep(list, time, value) {
  if (list.length && time < list.at(-1)[0]) return; // it stood still
  list.push([time, value]);
  if (list.length > KEPT) list.splice(0, list.length - KEPT);
}

/** Joints whose positions are plotted: of the arm that is selected. */
export function plotJoints(labels, index) {
  names = labels;
  recorded.index = index;
  recorded.positions = [];
}

on("frame", (message) => {
  if (!recorded.index || !message.positions) return;
  keep(recorded.positions, message.live, recorded.index.map((each) => message.positions[each]));
  keep(recorded.tcp, message.live, message.tcp.slice(0, 3));
  draw(message.live);
});
on("state", (message) => {
  keep(recorded.forces, message.live, [message.contacts.reduce((sum, [, , force]) => sum + force, 0)]);
  if (message.nearest) keep(recorded.gaps, message.live, [message.nearest[2]]);
  draw(message.live);
});

function draw(now) {
  if (!plot || $("plots").classList.contains("folded") || Date.now() < due) return;
  due = Date.now() + REDRAWN;
  const [unit, made] = KINDS[kind];
  const from = now - SPAN;
  const series = made().filter(([, { times }]) => times.length).map(([name, { times, values }]) => {
    const first = Math.max(0, times.findIndex((time) => time >= from) - 1);
    const kept = Float32Array.from(values.slice(first), (value) => shown(value, unit));
    const [low, high] = kept.reduce(([a, b], each) => [Math.min(a, each), Math.max(b, each)], [Infinity, -Infinity]);
    // up to now: what stands still is sent once
    return { name, times: Float64Array.from([...times.slice(first), now], (time) => time - now), values: Float32Array.from([...kept, kept.at(-1)]), low, high };
  });
  if (!series.length) return;
  plot.from = -SPAN; // times are before now: the clock of the scenario stands still between its steps
  plot.to = 0;
  plot.cursor = 1;
  plot.show({ title: kind, unit: unitName(unit), series, limits: [], least: shown(LEAST[unit] ?? 0.1, unit) });
}

const COLORED = (name, index) => {
  const sign = element("i", {});
  sign.style.background = `var(--s${index % 12})`;
  return element("span", {}, sign, name);
};

/** The newest value of each line, as it is drawn; for tests and for readers of the screen. */
export const latest = () => plot?.data && Object.fromEntries(plot.data.series.map(({ name, values }) => [name, values.at(-1)]));

/** The times that are drawn [s], 0 is now; for tests. */
export const times = () => plot?.data && [plot.from, plot.to, ...plot.data.series.map((each) => each.times.at(-1))];

export function startPlots() {
  plot = new Plot([], { onSeek() {}, onZoom() {}, onReset() {} });
  $("plot").append(plot.canvas);
  $("plot-kind").replaceChildren(...Object.keys(KINDS).map((each) => element("option", {}, each)));
  const change = () => {
    kind = $("plot-kind").value;
    const [unit, made] = KINDS[kind];
    $("plot-legend").replaceChildren(element("span", {}, `[${unitName(unit)}]`), ...made().map(([name], index) => COLORED(name, index)));
    due = 0;
  };
  $("plot-kind").addEventListener("change", change);
  onUnits(change);
  const fold = (isFolded) => {
    $("plots").classList.toggle("folded", isFolded);
    $("plots-toggle").setAttribute("aria-expanded", String(!isFolded));
  };
  fold(localStorage.plots ? localStorage.plots === "folded" : innerHeight < 760);
  $("plots-toggle").addEventListener("click", () => {
    const isFolded = !$("plots").classList.contains("folded");
    localStorage.plots = isFolded ? "folded" : "shown";
    fold(isFolded);
  });
  return change;
}
