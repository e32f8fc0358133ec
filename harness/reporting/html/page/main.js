// Puts the page together: one clock, and everything that follows it.

import { Address, readAddress } from "./address.js";
import { firstFailure, judgedSpan, lossOf, momentOf, showCause } from "./cause.js";
import { Clock } from "./clock.js";
import { makeControls } from "./controls.js";
import { byId, scrollInto, scrollToTop } from "./dom.js";
import { makeFilm } from "./film.js";
import { keepDrawing } from "./frames.js";
import { listenToKeys } from "./keys.js";
import { makeLegend, makeSides } from "./legend.js";
import { unpack, valueAt } from "./payload.js";
import { missGroups } from "./misses.js";
import { makePictures } from "./pictures.js";
import { plannerView } from "./planner.js";
import { Plots, plotOf } from "./plots.js";
import { makeScene } from "./scene.js";
import { makeSteps } from "./steps.js";
import { findingsView, jointTable, markLines, pairTable, sourceView } from "./tables.js";
import { makeTabs } from "./tabs.js";
import { makeTimeline, stepAt } from "./timeline.js";
import { verdictList } from "./verdicts.js";

const ROUNDING = 0.0051; // of times in an address [s]
const MOST_PRESSES_SHOWN = 3;

async function start() {
  const payload = await unpack(byId("data"));
  const { run } = payload;
  const clock = new Clock(run.duration);
  const bands = run.steps
    .filter((step) => step.status !== "not reached" && !step.hasChildren)
    .map((step) => ({ start: step.start, end: step.end, tone: step.tone }));

  run.groups.push(...missGroups(payload));
  const missed = run.verdicts.filter(({ status }) => status === "failed").flatMap(({ measures }) => measures.slice(0, 1).map((measure) => plotOf(run, measure)));
  for (const { id, limits } of run.groups) if (missed.includes(id)) for (const limit of limits) limit.stretches ||= limit.series === null;
  const plots = new Plots(payload, clock, bands, missed);
  const scene = makeScene(payload, () => plots.panelData("contact"));
  const showCurrentStep = makeSteps(payload, { step: selectStep, verdict: selectVerdict, time: (time) => clock.seek(time) });
  const source = sourceView(payload, selectLine);
  const verdicts = verdictList(payload, selectVerdict);
  const passed = run.verdicts.filter(({ status }) => status === "passed").length;
  const showTab = makeTabs([
    { id: "expect", title: "Verdicts", badge: run.verdicts.length ? `${passed}/${run.verdicts.length}` : "", content: verdicts },
    { id: "planner", title: "Planner", content: plannerView(payload, selectStep) },
    { id: "findings", title: "Findings", badge: String(run.findings.filter(({ isWarning }) => isWarning).length || ""), content: findingsView(payload, (time) => clock.seek(time)) },
    { id: "source", title: "Source", content: source },
    { id: "joints", title: "Joints", content: jointTable(payload) },
    { id: "environment", title: "Setup", content: pairTable(run.environment) },
  ]);
  showCause(run, { step: selectStep, verdict: selectVerdict, time: (time) => clock.seek(time) });
  makeTimeline(payload, clock, { step: selectStep, verdict: selectVerdict });
  const hasPictures = makePictures(payload, clock);
  const drawFilm = scene ? makeFilm(run, clock, drawAt) : () => {};
  const address = new Address(clock);

  let currentStep = -2;
  let chosen = { step: -1, time: NaN }; // several steps may share a moment
  const stepNow = (time) => (time === chosen.time ? chosen.step : stepAt(run.steps, time));
  clock.onTime((time) => {
    const step = stepNow(time);
    scene?.pose(time, step);
    showReadout(time, step);
    if (step === currentStep) return;
    currentStep = step;
    showCurrentStep(step);
    const { line, lastLine } = run.steps[step] ?? { line: 0, lastLine: 0 };
    markLines(source, line, line ? lastLine + 1 : 0);
  });

  function showReadout(time, step) {
    const tool = scene?.toolPosition(time) ?? null;
    const place = tool ? `TCP ${tool.map((value) => (1000 * value).toFixed(1).padStart(7)).join(" ")} mm` : "";
    const loads = ["velocity", "effort"].flatMap((id) => {
      const data = plots.panelData(id);
      if (!data) return [];
      const worst = Math.max(...data.series.map((series) => Math.abs(valueAt(series, time)) || 0));
      return [`${id} ${worst.toFixed(1)} %`];
    });
    const name = run.steps[step]?.summary ?? "";
    const presses = scene?.showsContacts ? scene.arrows.at(time).slice(0, MOST_PRESSES_SHOWN) : [];
    const touches = presses.map(({ link, body, size }) => `${link} presses ${body} ${size.toFixed(1)} N`);
    byId("readout").textContent = [`t ${time.toFixed(3)} s  ${name}`, place, loads.join("   "), ...touches].filter(Boolean).join("\n");
  }

  function drawAt(time, canvas) {
    const { viewer } = scene;
    const wasDirty = viewer.isDirty;
    scene.pose(time, stepAt(run.steps, time));
    viewer.copyTo(scene.film, canvas);
    scene.pose(clock.time, stepNow(clock.time));
    viewer.isDirty = wasDirty; // the view's own canvas has not changed
  }

  function selectStep(index) {
    const step = run.steps[index];
    if (step.status === "not reached") return;
    const isFailure = step.status === "failed";
    scene?.why.show(null);
    chosen = { step: index, time: isFailure ? step.end : Math.min(step.start + 1e-3, step.end) };
    clock.seek(chosen.time);
    scrollToTop(byId("panels"), document.querySelector(`#panel-planner:not([hidden]) [data-step="${index}"]`));
    address.select({ step: index + 1 });
  }

  function selectVerdict(index) {
    const verdict = run.verdicts[index];
    for (const button of verdicts.querySelectorAll("[data-verdict]")) {
      button.toggleAttribute("aria-current", Number(button.dataset.verdict) === index);
    }
    const time = momentOf(run, verdict);
    if (time !== null) {
      const owner = run.steps.findIndex(({ id, hasChildren }) => id === verdict.step && !hasChildren);
      chosen = { step: owner >= 0 ? owner : stepAt(run.steps, time), time };
      clock.seek(time);
    }
    scene?.why.show(verdict);
    scene?.pose(clock.time, stepNow(clock.time));
    plots.judge(judgedSpan(run, verdict), verdict.measures.map((measure) => ({ ...measure, plot: plotOf(run, measure) })));
    showTab("expect");
    scrollInto(verdicts.closest(".scroll"), verdicts.querySelector(`[data-verdict="${index}"]`));
    address.select({ expect: index + 1 });
  }

  function selectLine(line) {
    const verdict = run.verdicts.findIndex((each) => each.line === line);
    const step = run.steps.findIndex((each) => each.line === line);
    if (verdict >= 0) selectVerdict(verdict);
    else if (step >= 0) selectStep(step);
  }

  function nextStep(direction) {
    const starts = run.steps.filter(({ status }) => status !== "not reached").map((step) => step.start);
    const others = direction > 0 ? starts.filter((time) => time > clock.time + 2e-3) : starts.filter((time) => time < clock.time - 2e-3);
    if (others.length) clock.seek((direction > 0 ? Math.min(...others) : Math.max(...others)) + 1e-3);
  }

  function nextFailure() {
    const failures = run.verdicts.flatMap(({ status, time }, index) => (status !== "passed" && time !== null ? [index] : []));
    if (!failures.length) return;
    const shown = Number(verdicts.querySelector("[aria-current]")?.dataset.verdict ?? -1);
    selectVerdict(failures.find((index) => index > shown) ?? failures[0]);
  }

  /** Without a place in the address: open at the failure, or at the failure that was expected. */
  function openAtFailure() {
    const { step: failed, verdict } = firstFailure(run);
    if (failed >= 0 || (!run.verdicts.length && run.steps.some(({ status }) => status === "expected error"))) showTab("planner");
    if (failed >= 0) selectStep(failed);
    else nextFailure();
    const loss = verdict < 0 ? null : lossOf(run, run.verdicts[verdict]);
    if (loss !== null) clock.seek(loss);
  }

  /** The step that failed at a time that the terminal rounded. */
  function selectFailureAt(time) {
    const failed = run.steps.findIndex(({ status, hasChildren, end }) => status === "failed" && !hasChildren && Math.abs(end - time) <= ROUNDING);
    if (time === null || failed < 0) return false;
    selectStep(failed);
    return true;
  }

  function goTo(hash) {
    const place = readAddress(hash);
    if (place.tab && document.getElementById(`tab-${place.tab}`)) showTab(place.tab);
    if (place.expect !== null && run.verdicts[place.expect]) selectVerdict(place.expect);
    else if (place.step !== null && run.steps[place.step]) selectStep(place.step);
    else if (selectFailureAt(place.time)) return;
    const verdict = run.verdicts[place.expect ?? -1];
    const isDecided = verdict && Math.abs(verdict.time - place.time) <= ROUNDING; // the page knows where to look
    if (place.time !== null && !isDecided) clock.seek(place.time);
  }

  const again = () => clock.timeListeners.forEach((listener) => listener(clock.time));
  makeControls({ clock, scene, plots, drawFilm });
  document.addEventListener("contextrestored", () => plots.redraw(), true); // as in pictures.js
  if (scene) {
    makeLegend(run, scene, hasPictures, again);
    makeSides(scene, () => clock.time, run.title);
    scene.inspector.onChange = again;
    scene.inspector.onLine = (line) => {
      showTab("source");
      selectLine(line);
      source.children[line - 1]?.scrollIntoView({ block: "center" });
    };
  }
  listenToKeys(clock, { nextStep, nextFailure });
  addEventListener("hashchange", () => goTo(location.hash));
  if (location.hash) goTo(location.hash);
  else openAtFailure();
  keepDrawing(clock, scene);
}

start().catch((error) => {
  document.documentElement.classList.remove("scripted");
  throw error;
});
