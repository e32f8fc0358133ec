// The page: what the buttons, sliders and keys do, and how the cell's numbers are shown.

import { request, connect, on } from "./connection.js";
import { $, element, list, log, numbers, options } from "./dom.js";
import * as editor from "./editor.js";
import { showScene } from "./scene.js";
import { eulerOf } from "./turns.js";
import "./verdicts.js";

let robot = null, state = null, reach = null, isMine = false;
const LIST = ":joints";
const sliders = new Map();
const degrees = (value, joint) => (joint.slides ? `${(1000 * value).toFixed(1)} mm` : `${(180 / Math.PI * value).toFixed(1)}°`);

async function act(name, keys = {}) {
  if (name !== "jog" && name !== "stop") await editor.flush();
  const reply = await request(name, keys);
  if (reply.error) {
    for (const line of (reply.explanation ?? []).toReversed()) log("explanation", line);  // the newest line is on top
    log("failed", reply.error);
  }
  return reply;
}

// -- what is shown --------------------------------------------------------------------------

on("robot", (message) => {
  const isOther = !robot || robot.name !== message.name || robot.joints.length !== message.joints.length;
  robot = message;
  $("title").textContent = `Studio: ${robot.name}`;
  document.title = `Studio: ${robot.name}`;
  if (isOther) showJoints();
  options($("goal-kind"), robot.states, [["", "the handle"], [LIST, "joint positions"]]);
  list("planners", robot.planners);
  list("worlds", robot.worlds);
  list("objects", robot.bodies);
  options($("verb"), robot.verbs);
  options($("frame"), robot.frames);
  options($("handle-name"), robot.bodies, [["", "none"]]);
  options($("camera"), robot.cameras);
  $("camera-box").hidden = !robot.cameras.length;
  showGripper();
  $("overlaps").replaceChildren(...robot.overlaps.map((overlap) => element("div", {}, `At the start ${overlap}: Play, and every motion, lets them be pushed apart.`)));
});

function showJoints() {
  sliders.clear();
  $("joints").replaceChildren(...robot.joints.map((joint) => {
    const keys = { min: joint.lower, max: joint.upper, step: 0.001, "aria-label": joint.name };
    const slider = element("input", { type: "range", ...keys });
    const field = element("input", { type: "number", ...keys, step: 0.01, "aria-label": `${joint.name} number` });
    const shown = element("output", {});
    const send = (value) => act("jog", { joint: joint.name, value: Number(value) });
    slider.addEventListener("input", () => { field.value = slider.value; send(slider.value); });
    field.addEventListener("change", () => { slider.value = field.value; send(field.value); });
    sliders.set(joint.name, { slider, field, shown, held: 0, joint });
    for (const input of [slider, field]) input.addEventListener("input", () => { sliders.get(joint.name).held = Date.now(); });
    return element("div", { class: "joint" }, element("span", {}, joint.name), slider, field, shown);
  }));
}

function showGripper() {
  const box = $("gripper");
  if (!robot.gripper) return box.replaceChildren("This robot has no gripper.");
  const width = element("input", { type: "number", id: "width", min: 0, max: robot.gripper.widest, step: 0.001, value: robot.gripper.widest.toFixed(3) });
  box.replaceChildren(
    ...Object.entries(robot.gripper.steps)
      .filter(([word]) => robot.gripper.widest || !["open", "close"].includes(word)) // of cups: the keys o and p alone
      .map(([word, step]) => element("button", { onclick: () => run(step) }, word)),
    ...(robot.gripper.widest ? [element("label", {}, " width [m] ", width), element("button", { onclick: () => run(`gripper: {width: ${Number(width.value)}}`) }, "Go")] : []),
    element("output", { id: "gap" }));
}

on("state", (message) => {
  state = message;
  $("clock").textContent = `${message.time.toFixed(3)} s`;
  $("overlaps").hidden = message.time > 0;
  $("record").checked = message.is_recording;
  $("follow").checked = message.follows;
  for (const id of ["speed", "share"]) if (document.activeElement !== $(id)) $(id).value = message[id];
  $("play").textContent = message.is_playing ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", message.is_playing);
  document.body.classList.toggle("busy", Boolean(message.busy));
  $("status").textContent = message.busy ? message.busy
    : `${message.steps_done} of ${message.step_count} steps executed${message.is_run ? "" : "; then moved by hand"}`;
  robot?.joints.forEach((joint, index) => {
    const { slider, field, shown, held } = sliders.get(joint.name);
    const value = message.positions[index];
    shown.textContent = degrees(value, joint);
    if (Date.now() - held < 1500) return;
    if (document.activeElement !== field) field.value = value.toFixed(3);
    slider.value = value;
  });
  if ($("gap") && message.width !== null) $("gap").textContent = ` now ${(1000 * message.width).toFixed(1)} mm`;
  const rows = message.contacts.map(([a, b, force]) => element("div", {}, `${a} – ${b}: ${force.toFixed(2)} N`));
  const near = message.nearest ? `nearest pair: ${message.nearest[0]} – ${message.nearest[1]}, ${(1000 * message.nearest[2]).toFixed(1)} mm` : "";
  $("contacts").replaceChildren(element("div", { class: "near" }, near), ...rows);
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

on("chosen", (message) => {
  $("goal-kind").value = "";
  [...$("ways").children].forEach((button, index) => button.setAttribute("aria-pressed", index === message.way));
});

on("reach", (message) => {
  reach = message;
  const box = $("reach");
  box.classList.toggle("refused", Boolean(message.refusal));
  box.textContent = message.refusal || (message.ways.length ? `${message.ways.length === 1 ? "1 way" : `${message.ways.length} ways`} to the handle` : "");
  $("ways").replaceChildren(...message.ways.map((way, index) => element("button", {
    class: `way${way.refusal ? " refused" : ""}${index === message.best ? " best" : ""}`,
    onclick: () => act("choose", { way: index }) },
  `${way.name}${way.refusal ? `: ${way.refusal}` : ""}`)));
  if (message.pose) { $("goal-kind").value = ""; showGoal(message.pose, message.frame); }
});

function showGoal(pose, frame = "world") {
  const [factor, digits] = $("unit").value === "deg" ? [180 / Math.PI, 3] : [1, 5];
  ["x", "y", "z"].forEach((name, index) => { $(`goal-${name}`).value = Number(pose[index].toFixed(4)); });
  eulerOf(pose.slice(3)).forEach((angle, index) => { $(`goal-${["roll", "pitch", "yaw"][index]}`).value = Number((factor * angle).toFixed(digits)); });
  $("frame").value = frame;
}

$("unit").addEventListener("change", () => {
  const factor = $("unit").value === "deg" ? 180 / Math.PI : Math.PI / 180;
  for (const name of ["roll", "pitch", "yaw"]) {
    const field = $(`goal-${name}`);
    if (field.value) field.value = Number((factor * field.value).toFixed(5));
  }
});

on("note", (message) => log(message.kind, message.text));
on("lost", () => { document.body.classList.add("lost"); $("status").textContent = "connection lost; it comes back by itself"; });
on("connected", () => document.body.classList.remove("lost"));

// -- what is done ---------------------------------------------------------------------------

async function run(step) {
  const reply = await act("execute", { step, if_moved: true });
  if (!reply.error) log("passed", reply.note ?? reply.step);
  return reply;
}

async function continueStep() {
  const text = $("step-text").value, before = text.replace(/[\w./-]*$/, "");
  const reply = await request("complete", { text: `steps:\n  - ${text}`, line: 1, column: 4 + text.length });
  list("continuations", (reply.options ?? []).map((each) => before + (each.kind === "key" ? `${each.text}: ` : each.text)));
}
for (const event of ["focus", "input"]) $("step-text").addEventListener(event, continueStep);

const goal = () => ({ verb: $("verb").value, state: $("goal-kind").value === LIST ? "" : $("goal-kind").value,
  joints: $("goal-kind").value === LIST ? numbers($("goal-joints").value) : [], unit: $("unit").value, planner: $("planner").value.trim(), frame: $("frame").value,
  interim: $("verb").value === "circ" ? numbers($("interim").value) : [] });

function showPlan(reply) {
  $("plan-result").replaceChildren(reply.error
    ? element("div", { class: "failed" }, reply.error, ...(reply.explanation ?? []).map((l) => element("div", { class: "explanation" }, l)))
    : element("div", {}, reply.duration === undefined ? reply.note ?? `executed: ${reply.step}` : `${reply.step} takes ${reply.duration} s over ${(1000 * reply.length).toFixed(0)} mm (${reply.planner})`));
}

const click = (id, action) => $(id).addEventListener("click", action);
click("play", () => act("play", { on: !state.is_playing }));
click("advance", () => act("advance", { seconds: 0.01 }));
click("reset", () => act("reset"));
click("stop", () => act("stop"));
click("plan", async () => showPlan(await act("plan", goal())));
click("execute", async () => showPlan(await act("execute", goal())));
click("record-joints", async () => showPlan(await act("execute", { here: true, record: true })));
click("run-all", () => act("run", { until: "end" }));
click("run-line", () => act("run", { until: "line", line: editor.line() }));
click("run-breakpoint", () => act("run", { until: "line", line: editor.breakpoint() }));
click("run-next", () => act("run", { until: "next" }));
click("back", () => act("back"));
click("undo", () => act("undo"));
click("step-run", () => run($("step-text").value));
click("control", () => request("control", { word: isMine ? "release" : "request" }));
click("goal-here", () => act("goal", { here: true, frame: $("frame").value }));
click("goal-set", () => setGoal());
const look = () => { if (robot?.cameras.length) act("camera", { name: $("camera-box").open ? $("camera").value : "" }); };
$("camera-box").addEventListener("toggle", look);
$("camera").addEventListener("change", look);
on("camera", (message) => { $("camera-image").src = `data:image/jpeg;base64,${message.image}`; });
$("speed").addEventListener("change", () => act("speed", { value: Number($("speed").value) }));
$("follow").addEventListener("change", () => act("follow", { on: $("follow").checked }));
$("record").addEventListener("change", () => act("recording", { on: $("record").checked }));
$("share").addEventListener("change", () => act("share", { value: Number($("share").value) }));
$("verb").addEventListener("change", () => { $("interim-label").hidden = $("verb").value !== "circ"; });

function setGoal() {
  const value = (name) => Number($(`goal-${name}`).value);
  return act("goal", { xyz: ["x", "y", "z"].map(value), rpy: ["roll", "pitch", "yaw"].map(value), unit: $("unit").value, frame: $("frame").value });
}

const object = () => ({ name: $("object-name").value.trim(), kind: $("object-kind").value, size: numbers($("object-size").value), xyz: numbers($("object-xyz").value) });
$("goal-kind").addEventListener("change", () => { $("goal-joints-row").hidden = $("goal-kind").value !== LIST; });
$("object-name").addEventListener("change", () => {
  const known = robot?.objects.find((each) => each.name === $("object-name").value.trim());
  if (!known?.kind) return;
  $("object-kind").value = known.kind;
  $("object-size").value = known.size.join(" ");
  $("object-xyz").value = known.xyz.join(" ");
});
click("world-load", () => act("world", { name: $("world").value.trim() }));
click("object-attach", () => run(`attach_object: ${$("object-name").value.trim()}`));
click("object-detach", () => run(`detach_object: ${$("object-name").value.trim()}`));
click("object-add", () => act("add_object", object()));
click("object-handle", () => act("handle", { name: $("handle-name").value }));
click("object-delete", () => act("delete_object", object()));

click("save", save);
async function save() {
  const reply = await act("save", { name: $("file").value });
  if (reply.file) log("passed", `saved ${reply.file}${reply.digest ? `; its digest is ${reply.digest.slice(0, 16)}` : "; run all steps to see its digest"}`);
}

click("expect-seen", async () => {
  const reply = await act("expect_seen");
  const box = $("proposals");
  box.hidden = Boolean(reply.error);
  if (reply.error) return;
  const boxes = reply.proposals.map((each) => [element("input", { type: "checkbox", checked: true }), each.text, each.why]);
  box.replaceChildren(element("div", {}, boxes.length ? "These hold now, as the judge of a run has them:" : "Nothing was found that can be expected here."),
    ...boxes.map(([input, text, why]) => element("label", { class: "proposal" }, input, `${text}  (${why})`)),
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
  if (event.key === "Escape" && !event.target.matches?.(".ace_text-input")) return act("stop");
  if (isTyping || event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.key === "o" && robot?.gripper) run(robot.gripper.steps.open);
  if (event.key === "p" && robot?.gripper) run(robot.gripper.steps.close);
  if (event.key === " " && !event.target.matches?.("button, summary, [type=checkbox]")) { event.preventDefault(); $("play").click(); }
});

showScene();
if (location.search) history.replaceState(null, "", location.pathname);
editor.start();
connect();
