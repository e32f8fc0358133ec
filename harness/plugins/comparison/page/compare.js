// The page of two runs: one clock, two replays, plots over each other, and what differs.

import { Address, readAddress } from "./address.js";
import { Clock } from "./clock.js";
import { makeControls } from "./controls.js";
import { Apart } from "./apart.js";
import { differencesView } from "./differences.js";
import { byId, element } from "./dom.js";
import { makeFilm } from "./film.js";
import { keepDrawing } from "./frames.js";
import { headline, showHeadline } from "./headline.js";
import { listenToKeys } from "./keys.js";
import { makeSides } from "./legend.js";
import { unpack } from "./payload.js";
import { makePairs } from "./step_pairs.js";
import { pairTable } from "./tables.js";
import { makeTabs } from "./tabs.js";
import { makeTimeline, stepAt } from "./timeline.js";
import { TwoPlots } from "./two_plots.js";
import { Alignment } from "./two_runs.js";
import { makeTwoScenes } from "./two_scenes.js";
import { verdictPairs } from "./verdict_table.js";

async function start() {
  const { run: facts } = await unpack(byId("facts"));
  const payloads = [await unpack(byId("first")), await unpack(byId("second"))];
  const runs = payloads.map(({ run }) => run);
  const pairs = facts.pairs.map((pair) => Object.fromEntries(["first", "second"].map((run, index) => [run, pair[index] < 0 ? null : pair[index]])));
  const verdicts = verdictPairs(facts, runs);
  const apart = new Apart(payloads);
  const sentences = headline(facts, runs, verdicts, apart);
  const alignment = new Alignment(runs[0].steps, runs[1].steps, pairs, runs.map(({ duration }) => duration));
  const clock = new Clock(alignment.duration);
  const since = Math.min(...apart.series().map(({ name }) => apart.since(name)));
  const parting = Number.isFinite(since) ? { time: since, text: "the runs come apart", status: "failed" } : facts.parting && { ...facts.parting, text: "numerically apart", status: "not reached" };
  const timeline = makeBothRows(runs, alignment, parting);
  const bands = runs[0].steps.filter(isLeaf).map(({ start, end, band }) => ({ start, end, tone: band }));
  const plots = TwoPlots.of(payloads, clock, bands, alignment, apart, verdicts);
  const scene = makeTwoScenes(payloads, alignment);
  const showPair = makePairs(runs.map(({ steps }) => steps), pairs, verdicts, apart, selectPair);
  const seek = (time) => clock.seek(time);
  showHeadline(sentences, seek);
  makeTabs([
    { id: "differences", title: "Differences", content: differencesView(facts, verdicts, apart, { seek, verdict: selectVerdict }) },
    { id: "first", title: "Setup of A", content: pairTable(runs[0].environment) },
    { id: "second", title: "Setup of B", content: pairTable(runs[1].environment) },
  ]);
  makeTimeline(timeline.run, clock, { step: () => {}, verdict: () => seek(parting.time) });
  const drawFilm = scene ? makeFilm(timeline.run.run, clock, drawAt) : () => {};
  new Address(clock);
  clock.onTime((time) => {
    scene?.pose(time);
    showPair(stepAt(runs[0].steps, time));
    const second = alignment.ofSecond(time);
    byId("readout").textContent = [time, second].map((each, index) => line("AB"[index], runs[index], each)).join("\n");
  });

  function drawAt(time, canvas) {
    const { viewer } = scene;
    const halves = viewer.halves;
    viewer.halves = null;
    scene.pose(time);
    viewer.copyTo(scene.film, canvas);
    viewer.halves = halves;
    scene.pose(clock.time);
  }

  function selectPair({ first, second }) {
    const step = first === null ? runs[1].steps[second] : runs[0].steps[first];
    if (step.status === "not reached") return;
    seek((first === null ? alignment.onClock(step.start) : step.start) + 1e-3);
  }

  function selectVerdict({ first, second }) {
    const verdict = second && (second.status !== "passed" || !first) ? second : first;
    if (verdict.time !== null) seek(verdict === second ? alignment.onClock(verdict.time) : verdict.time);
    if (verdict.plot) plots.reveal(verdict.plot);
  }

  /** Where the other verdict was decided, once things are apart; else where they are farthest apart. */
  function opens() {
    const [{ time }] = sentences;
    return time !== null && time >= since ? time : (facts.farthest[0] ?? parting)?.time ?? 0;
  }

  function nextStep(direction) {
    const starts = runs[0].steps.filter(({ status }) => status !== "not reached").map(({ start }) => start);
    const others = starts.filter((time) => direction * (time - clock.time) > 2e-3);
    if (others.length) seek((direction > 0 ? Math.min(...others) : Math.max(...others)) + 1e-3);
  }

  const switches = [
    [`A ${runs[0].outcome}`, true, (is) => scene && ((scene.shown[0] = is), scene.showBoth())],
    [`B ${runs[1].outcome}`, true, (is) => scene && ((scene.shown[1] = is), scene.showBoth())],
    ["side by side", false, (is) => scene?.putNextTo(is)],
    ["steps aligned", false, (is) => {
      alignment.bySteps = is;
      timeline.place();
      clock.duration = alignment.duration;
      plots.refill();
      clock.show();
      seek(Math.min(clock.time, clock.duration));
    }],
  ];
  for (const [title, isOn, set] of switches) {
    const button = element("button", { type: "button", "aria-pressed": isOn }, title);
    button.addEventListener("click", () => {
      const is = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", is);
      set(is);
    });
    byId("switches").append(button);
  }
  makeControls({ clock, scene, plots, drawFilm });
  if (scene) makeSides({ ...scene, follows: false, toolPosition: () => runs[0].focus.points[0] }, () => clock.time, "comparison", false);
  listenToKeys(clock, { nextStep, nextFailure: () => parting && seek(parting.time) });
  const place = readAddress(location.hash);
  seek(place.time ?? opens());
  keepDrawing(clock, scene);
}

function isLeaf({ status, hasChildren }) {
  return status !== "not reached" && !hasChildren;
}

function line(name, run, time) {
  const step = run.steps[stepAt(run.steps, time)];
  return `${name}  t ${Math.min(time, run.duration).toFixed(3)} s  ${step?.summary ?? ""}`;
}

/** The timeline's rows: steps of the first run above those of the second, and a mark where they part by what people see. */
function makeBothRows(runs, alignment, parting) {
  const rows = runs.map(({ steps }, depth) => steps.filter(isLeaf).map((step) => ({ ...step, depth, own: step })));
  const place = () => {
    for (const step of rows[1]) Object.assign(step, { start: alignment.onClock(step.own.start), end: alignment.onClock(step.own.end) });
  };
  const verdicts = parting ? [{ ...parting, used: null }] : [];
  return { place, run: { run: { steps: rows.flat(), verdicts } } };
}

start().catch((error) => {
  document.documentElement.classList.remove("scripted");
  throw error;
});
