// The page: what the buttons, sliders and keys do, and how the cell's numbers are shown.

import { request, connect, on } from "./connection.js";
import { $, element, list, log, numbers, options, segments } from "./dom.js";
import * as editor from "./editor.js";
import { choose, setGoal, startGoal } from "./goal.js";
import { jointRow, keepUnits } from "./joints.js";
import { pick, setObjects, startObjects } from "./objects.js";
import { plotJoints, startPlots } from "./plots.js";
import { amount, angleUnit, onUnits, read, system, toggleUnits } from "./quantities.js";
import { scene } from "./scene.js";
import "./verdicts.js";

let robot = null, state = null, isMine = false, tab = "arm", showLegend = () => {};
const LIST = ":joints";
const TABS = { arm: "Arm", objects: "Objects", sensors: "Sensors" };
const rows = new Map();

async function act(name, keys = {}) {
  if (!["jog", "drag", "stop"].includes(name)) await editor.flush();
  const reply = await request(name, keys);
  if (reply.error) {
    for (const line of (reply.explanation ?? []).toReversed()) log("explanation", line);  // the newest line is on top
    log("failed", reply.error);
  }
  return reply;
}

// -- what is shown --------------------------------------------------------------------------

on("robot", (message) => {
  const key = (each) => each && JSON.stringify([each.name, each.arm, each.joints, each.gripper]);
  const isOther = key(robot) !== key(message);
  robot = message;
  $("title").textContent = robot.title;
  document.title = `Studio: ${robot.title}`;
  if (isOther) showArm();
  options($("goal-kind"), robot.states, [["", "the handle"], [LIST, "joint positions"]]);
  list("planners", robot.planners);
  options($("verb"), robot.verbs);
  options($("frame"), robot.frames);
  options($("camera"), robot.cameras);
  $("camera-box").hidden = !robot.cameras.length;
  setObjects(robot);
  $("overlaps").replaceChildren(...robot.overlaps.map((overlap) => element("div", {}, `At the start ${overlap}: Play, and every motion, lets them be pushed apart.`)));
});

/** The rows of the selected arm and of its gripper. */
function showArm() {
  segments($("arms"), robot.arms, robot.arm, (name) => act("arm", { name }));
  const own = robot.joints.filter((joint) => robot.arm_joints.includes(joint.name));
  const joints = own.length ? own : robot.joints;
  rows.clear();
  for (const joint of joints) rows.set(joint.name, jointRow(joint, (value) => act("jog", { joint: joint.name, value })));
  $("joints").replaceChildren(...[...rows.values()].map(({ row }) => row));
  keepUnits([...rows.values()], $("joints"));
  plotJoints(joints.map(({ label }) => label), joints.map(({ name }) => robot.joints.findIndex((each) => each.name === name)));
  showLegend();
  showGripper();
}

let width = null;
function showGripper() {
  const box = $("gripper");
  width = null;
  if (!robot.gripper) return box.replaceChildren(element("p", {}, "This robot has no gripper."));
  const { steps, narrowest, widest } = robot.gripper;
  const buttons = Object.entries(steps)
    .filter(([word]) => widest || !["open", "close"].includes(word)) // of cups: the keys o and p alone
    .map(([word, text]) => element("button", { title: { open: "key o", close: "key p" }[word] ?? "", onclick: () => run(text) }, word));
  box.replaceChildren(element("div", { class: "row" }, ...buttons));
  if (!widest) return;
  width = jointRow({ name: "width", label: "width", lower: narrowest, upper: widest, slides: true, isCalm: true },
    (value, isLast) => isLast && run(`gripper: {width: ${value.toFixed(4)}}`));
  box.prepend(width.row);
  keepUnits([width], box);
}

on("state", (message) => {
  state = message;
  $("clock").textContent = `${message.time.toFixed(3)} s`;
  $("overlaps").hidden = message.live > 0;
  $("record").checked = message.is_recording;
  $("follow").checked = message.follows;
  if (document.activeElement !== $("speed")) $("speed").value = message.speed;
  if (document.activeElement !== $("share")) $("share").value = Math.round(100 * message.share);
  $("play").setAttribute("aria-pressed", String(message.is_playing));
  $("play").setAttribute("aria-label", message.is_playing ? "Pause" : "Play");
  $("play").querySelector("use").setAttribute("href", message.is_playing ? "#i-pause" : "#i-play");
  document.body.classList.toggle("busy", Boolean(message.busy));
  $("status").textContent = message.busy ? message.busy
    : `${message.steps_done} of ${message.step_count} steps executed${message.is_by_hand ? "; then moved by hand" : message.is_run ? "" : ", from where the arm was moved by hand"}`;
  robot?.joints.forEach((joint, index) => rows.get(joint.name)?.show(message.positions[index]));
  if (width && message.width !== null) width.show(message.width);
  const near = message.nearest ? [[message.nearest[0], message.nearest[1], amount(message.nearest[2], "m")]] : [];
  const touching = message.contacts.map(([a, b, force]) => [a, b, `${force.toFixed(2)} N`]);
  const pairs = [...near, ...touching].map(([a, b, value], index) => [near.length && !index ? `nearest: ${a} – ${b}` : `${a} – ${b}`, value]);
  $("contacts").replaceChildren(...[...message.readings, ...pairs].map(([text, value]) => element("div", { class: "contact" },
    element("span", {}, text), element("output", {}, value))));
  editor.showDone(message.steps_done);
});

on("control", (message) => {
  isMine = message.is_mine;
  document.body.classList.toggle("spectator", !isMine);
  $("control-state").textContent = isMine ? (message.pages > 1 ? `you control; ${message.pages} pages` : "") : "you watch";
  $("control").hidden = isMine && message.pages < 2;
  $("control").textContent = isMine ? "Pass control on" : "Request control";
});

on("request", (message) => {
  if (!isMine) return;
  const line = element("div", { class: "entry warning", role: "alert" }, "Another page requests control. ",
    element("button", { onclick: () => { request("control", { word: message.page }); line.remove(); } }, "Hand over"),
    element("button", { onclick: () => line.remove() }, "Keep"));
  $("log").prepend(line);
});

on("note", (message) => log(message.kind, message.text));
on("lost", () => { document.body.classList.add("lost"); $("status").textContent = "connection lost; it comes back by itself"; });
on("connected", () => document.body.classList.remove("lost"));

function showTab(name) {
  tab = name;
  for (const each of Object.keys(TABS)) $(`tab-${each}`).hidden = each !== tab;
  for (const button of $("tabs").children) {
    button.setAttribute("aria-selected", String(button.id === `show-${tab}`));
  }
  look();
}
$("tabs").replaceChildren(...Object.entries(TABS).map(([name, text]) => element("button", { role: "tab", id: `show-${name}`, "aria-controls": `tab-${name}`, onclick: () => showTab(name) }, text)));

// -- what is done ---------------------------------------------------------------------------

async function run(step) {
  const reply = await act("execute", { step, if_moved: true });
  if (!reply.error) log(reply.note ? "warning" : "passed", reply.note ?? reply.step);
  return reply;
}

async function continueStep() {
  const text = $("step-text").value, before = text.replace(/[\w./-]*$/, "");
  const reply = await request("complete", { text: `steps:\n  - ${text}`, line: 1, column: 4 + text.length });
  list("continuations", (reply.options ?? []).map((each) => before + (each.kind === "key" ? `${each.text}: ` : each.text)));
}
for (const event of ["focus", "input"]) $("step-text").addEventListener(event, continueStep);

const goal = () => ({ verb: $("verb").value, state: $("goal-kind").value === LIST ? "" : $("goal-kind").value,
  joints: $("goal-kind").value === LIST ? numbers($("goal-joints").value) : [], unit: angleUnit(), planner: $("planner").value.trim(), frame: $("frame").value,
  interim: $("verb").value === "circ" ? numbers($("interim").value).map((each) => read(each, "m")) : [] });

function showPlan(reply) {
  $("plan-result").replaceChildren(reply.error
    ? element("div", { class: "failed" }, reply.error, ...(reply.explanation ?? []).map((l) => element("div", { class: "explanation" }, l)))
    : element("div", { title: reply.step }, reply.duration === undefined ? reply.note ?? `executed: ${reply.step}` : `takes ${reply.duration.toFixed(2)} s over ${amount(reply.length, "m")} (${reply.planner})`));
}

// a choice that is longer than its field is read under the pointer
addEventListener("pointerover", ({ target }) => { if (target instanceof HTMLSelectElement) target.title = target.selectedOptions[0]?.textContent ?? ""; });

const click = (id, action) => $(id).addEventListener("click", action);
click("play", () => act("play", { on: !state.is_playing }));
click("advance", () => act("advance", { seconds: 0.01 }));
click("reset", () => act("reset"));
click("stop", () => act("stop"));
click("units", toggleUnits);
click("plan", async () => showPlan(await act("plan", goal())));
click("execute", async () => showPlan(await act("execute", goal())));
click("record-joints", async () => showPlan(await act("execute", { here: true, record: true })));
click("run-all", () => act("run", { until: "end" }));
click("run-line", () => act("run", { until: "line", line: editor.line() }));
click("run-breakpoint", () => act("run", { until: "line", line: editor.breakpoint() }));
click("run-next", () => act("run", { until: "next" }));
click("back", () => act("back"));
click("undo", () => act("undo"));
click("step-run", async () => { const reply = await act("execute", { step: $("step-text").value }); if (!reply.error) log("passed", reply.step); });
click("control", () => request("control", { word: isMine ? "release" : "request" }));
click("goal-here", () => act("goal", { here: true, frame: $("frame").value }));
click("goal-set", setGoal);
const look = () => { if (robot?.cameras.length) act("camera", { name: tab === "sensors" ? $("camera").value : "" }); };
$("camera").addEventListener("change", look);
on("camera", (message) => { $("camera-image").src = `data:image/jpeg;base64,${message.image}`; });
$("speed").addEventListener("change", () => act("speed", { value: Number($("speed").value) }));
$("follow").addEventListener("change", () => act("follow", { on: $("follow").checked }));
$("record").addEventListener("change", () => act("recording", { on: $("record").checked }));
$("share").addEventListener("change", () => act("share", { value: Number($("share").value) / 100 }));
$("verb").addEventListener("change", () => { $("interim-label").hidden = $("verb").value !== "circ"; });
$("goal-kind").addEventListener("change", () => { $("goal-joints-row").hidden = $("goal-kind").value !== LIST; });
onUnits(() => { $("units").textContent = system(); });

click("save", save);
async function save() {
  const reply = await act("save", { name: $("file").value.replace(editor.SUFFIX, "") + editor.SUFFIX });
  if (reply.file) log("passed", `saved ${reply.file}${reply.digest ? `; its digest is ${reply.digest.slice(0, 16)}` : "; run all steps to see its digest"}`);
}

click("expect-seen", async () => {
  const reply = await act("expect_seen");
  const box = $("proposals");
  box.hidden = Boolean(reply.error);
  if (reply.error) return;
  const boxes = reply.proposals.map((each) => [element("input", { type: "checkbox", checked: true }), each.text, each.why]);
  box.replaceChildren(element("div", {}, boxes.length ? "These hold now, as the judge of a run has them:" : "Nothing was found that can be expected here."),
    ...boxes.map(([input, text, why]) => element("label", { class: "proposal" }, input, ` ${text} `, element("small", {}, why))),
    element("button", { onclick: async () => {
      box.hidden = true;
      const texts = boxes.filter(([input]) => input.checked).map(([, text]) => text);
      if (texts.length) await act("expect", { texts });
    } }, "Add to the last step"),
    element("button", { onclick: () => { box.hidden = true; } }, "Cancel"));
});

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey && event.key === "s") { event.preventDefault(); return save(); }
  if (event.key === "F10") { event.preventDefault(); return act(event.shiftKey ? "back" : "run", { until: "next" }); }
  if (event.key === "F9") { event.preventDefault(); return editor.toggleBreakpoint(editor.line() - 1); }
  if (event.key === "F5" && !event.shiftKey) { event.preventDefault(); return $("run-breakpoint").click(); }
  const isTyping = event.target.matches?.("input:not([type=range], [type=checkbox]), textarea, select, .ace_text-input");
  if (event.key === "Escape" && !event.target.matches?.(".ace_text-input")) { choose(null); return act("stop"); }
  if (isTyping || event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.key === "o" && robot?.gripper) run(robot.gripper.steps.open);
  if (event.key === "p" && robot?.gripper) run(robot.gripper.steps.close);
  if (event.key === "Delete" && scene.objects.has(scene.selected)) $("object-delete").click();
  if (event.key === " " && !event.target.matches?.("button, summary, [type=checkbox]")) { event.preventDefault(); $("play").click(); }
});

if (location.search) history.replaceState(null, "", location.pathname);
scene.onSelect = (body) => pick(body?.name ?? "");
startGoal(act);
startObjects(act, run);
showLegend = startPlots();
showTab("arm");
editor.start();
connect();
