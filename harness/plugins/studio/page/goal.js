// The goal of the TCP: its numbers, the ways to it, and the plan with its scrubber.

import { request, on } from "./connection.js";
import { $, element, icon } from "./dom.js";
import { followGizmo, holdGizmo, startGizmo } from "./gizmo.js";
import { amount, angleUnit, digits, nudge, onUnits, read, shown, unitName } from "./quantities.js";
import { previewWay, scene, select, showPlanned } from "./scene.js";
import { eulerOf } from "./turns.js";

const AXES = [["x", "m"], ["y", "m"], ["z", "m"], ["roll", "rad"], ["pitch", "rad"], ["yaw", "rad"]];
const fields = new Map();
let goal = null, plan = null, playing = 0, act = request, waiting = null, isSending = false;

/** Give the newest pose of a drag, once the one before it was answered. */
export async function sendDrag(keys) {
  waiting = keys;
  if (isSending) return;
  isSending = true;
  while (waiting) {
    const next = waiting;
    waiting = null;
    await act("drag", next);
  }
  isSending = false;
}

export function startGoal(action) {
  act = action;
  $("pose").replaceChildren(...AXES.map(([name, unit]) => {
    const field = element("input", { type: "number", step: "any", id: `goal-${name}` });
    fields.set(name, field);
    const by = (sign) => (event) => { field.value = digits(read(field.value || 0, unit) + sign * read(nudge(unit) * (event.shiftKey ? 10 : 1), unit), unit); setGoal(); };
    return element("span", { class: "axis" }, element("label", { for: field.id }, name),
      element("button", { "aria-label": `${name} less`, onclick: by(-1) }, icon("minus")), field,
      element("button", { "aria-label": `${name} more`, onclick: by(1) }, icon("plus")));
  }));
  for (const field of fields.values()) field.addEventListener("keydown", (event) => { if (event.key === "Enter") setGoal(); });
  startGizmo((held, what, isEnd) => {
    if (held.kind === "tcp") return sendDrag({ kind: "tcp", pose: held.pose, end: isEnd });
    if (what !== "size") return sendDrag({ kind: "object", name: held.kind, pose: held.pose, end: isEnd });
    if (isEnd) scene.labels?.show([]);
    else showSize(held);
    return isEnd ? sendDrag({ kind: "size", name: held.kind, half: held.half.map((each) => each ?? 0), pose: held.pose, end: true }) : null;
  });
  onUnits(() => {
    for (const [name, unit] of AXES) $(`goal-${name}`).parentElement.title = unitName(unit);
    if (goal) showGoal(goal.pose, goal.frame);
  });
  $("plan-time").addEventListener("input", () => { stopPlaying(); showPlanAt(Number($("plan-time").value)); });
  $("plan-play").addEventListener("click", () => (playing ? stopPlaying() : playPlan()));
  $("plan-close").addEventListener("click", () => act("discard"));
}

function showSize(held) {
  const sizes = held.half.filter((each) => each !== null).map((each) => amount(2 * each, "m"));
  scene.labels?.show([{ point: held.pose.slice(0, 3), text: sizes.join(" × "), tone: "accent" }]);
}

const values = (kind) => AXES.filter(([, unit]) => unit === kind).map(([name, unit]) => Number($(`goal-${name}`).value || 0) * (kind === "m" ? read(1, unit) : 1));

// the handles stay on what is selected, wherever it goes
on("frame", () => {
  const body = scene.objects.get(scene.selected);
  if (body?.pose && !followGizmo(body.name, body.pose)) showHandle();
});

/** Without a goal, the fields show where the TCP is. */
on("frame", (message) => { if (!goal && message.tcp && !$("pose").contains(document.activeElement)) fillPose(message.tcp); });

export const setGoal = () => act("goal", { xyz: values("m"), rpy: values("rad"), unit: angleUnit(), frame: $("frame").value });

function showGoal(pose, frame) {
  goal = { pose, frame };
  fillPose(pose);
  $("frame").value = frame;
}

function fillPose(pose) {
  pose.slice(0, 3).forEach((value, index) => { $(`goal-${AXES[index][0]}`).value = digits(value, "m"); });
  eulerOf(pose.slice(3)).forEach((angle, index) => { $(`goal-${AXES[3 + index][0]}`).value = Number(shown(angle, "rad").toFixed(angleUnit() === "deg" ? 2 : 5)); });
}

// -- the handle, and what is selected ---------------------------------------------------------

let handle = null, stepsDone = 0;
on("state", (message) => {
  if (message.steps_done === stepsDone) return;
  stepsDone = message.steps_done;
  showHandle();
});
on("handle", (message) => { handle = message; showHandle(); });

/** The handles are on the object that is selected, else on the goal of the TCP. */
export function showHandle() {
  const body = scene.objects.get(scene.selected);
  if (body?.canMove && body.pose) {
    holdGizmo({ kind: body.name, pose: [...body.pose], turns: "all", half: (!stepsDone && body.half) || null });
  } else holdGizmo(handle && { kind: "tcp", pose: [...handle.pose], turns: handle.turns, half: null });
}

/** What a click on the picture selects: an object, or the joint of a link. */
export function choose(body) {
  select(body?.name === scene.selected ? "" : body?.name ?? "");
  showHandle();
  for (const row of document.querySelectorAll(".joint")) row.classList.toggle("named", Boolean(scene.selected) && row.dataset.joint === body?.joint);
  document.querySelector(".joint.named")?.scrollIntoView({ block: "nearest" });
}

// -- the ways to the goal ---------------------------------------------------------------------

on("reach", (message) => {
  const box = $("reach");
  box.classList.toggle("refused", Boolean(message.refusal));
  const count = message.ways.length === 1 ? "1 way" : `${message.ways.length} ways`;
  box.textContent = message.refusal || (message.ways.length ? `${count} to the handle` : "");
  $("ways").replaceChildren(...message.ways.map((way, index) => element("button", {
    class: `way${way.refusal ? " refused" : ""}${index === message.best ? " best" : ""}`, "aria-pressed": "false",
    onclick: () => act("choose", { way: index }), onpointerenter: () => previewWay(index), onpointerleave: () => previewWay(-1),
    onfocus: () => previewWay(index), onblur: () => previewWay(-1) },
  `${way.name}${way.refusal ? `: ${way.refusal}` : ""}`)));
  if (!message.pose) goal = null;
  if (message.pose) { $("goal-kind").value = ""; showGoal(message.pose, message.frame); }
});

on("chosen", (message) => {
  $("goal-kind").value = "";
  [...$("ways").children].forEach((button, index) => button.setAttribute("aria-pressed", String(index === message.way)));
});

// -- the plan ---------------------------------------------------------------------------------

on("plan", (message) => {
  stopPlaying();
  plan = message.frames.length ? message : null;
  $("plan-bar").hidden = !plan;
  if (!plan) return showPlanned(null, null);
  $("plan-time").value = 1;
  showPlanned(null, plan.path);
  showPlanAt(1);
});

/** Show the plan at a share of its time, between the positions that were sent. */
function showPlanAt(share) {
  const at = share * (plan.frames.length - 1), before = Math.floor(at), after = Math.min(before + 1, plan.frames.length - 1);
  const mix = at - before;
  showPlanned(plan.frames[before].map((pose, link) => {
    const next = plan.frames[after][link];
    const sign = pose.slice(3).reduce((sum, each, i) => sum + each * next[3 + i], 0) < 0 ? -1 : 1;
    return pose.map((each, i) => each + mix * ((i < 3 ? 1 : sign) * next[i] - each));
  }));
  $("plan-time").value = share;
  $("plan-clock").textContent = `${(share * plan.duration).toFixed(2)} / ${plan.duration.toFixed(2)} s`;
}

function stopPlaying() {
  cancelAnimationFrame(playing);
  playing = 0;
  $("plan-play").firstChild.firstChild.setAttribute("href", "#i-play");
}

function playPlan() {
  const from = Number($("plan-time").value) >= 1 ? 0 : Number($("plan-time").value);
  const begin = performance.now() - 1000 * from * plan.duration;
  $("plan-play").firstChild.firstChild.setAttribute("href", "#i-pause");
  const go = (now) => {
    const share = Math.min(1, (now - begin) / 1000 / plan.duration);
    showPlanAt(share);
    if (share >= 1) stopPlaying();
    else playing = requestAnimationFrame(go);
  };
  playing = requestAnimationFrame(go);
}
