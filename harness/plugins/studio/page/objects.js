// Objects: the list, the fields of a new one, and moving the selected one with the pointer in the picture.

import { $, element, list, numbers } from "./dom.js";
import { onPlane, rayAt } from "./gizmo.js";
import { choose, sendDrag, showHandle } from "./goal.js";
import { digits, onUnits, read, unitName } from "./quantities.js";
import { bodyAt, put, scene, select } from "./scene.js";

let robot = null, act = null;
const lengths = (text) => numbers(text).map((each) => read(each, "m"));
const fill = (id, values) => { $(id).value = values.map((each) => digits(each, "m")).join(" "); };
let kept = { size: [0.04, 0.04, 0.04], xyz: [0.2, 0, 0.02] }; // of the fields [m]

/** The object that the fields describe. */
function object() {
  kept = { size: lengths($("object-size").value), xyz: lengths($("object-xyz").value) };
  return { name: $("object-name").value.trim(), kind: $("object-kind").value, ...kept };
}

export function startObjects(action, run) {
  act = action;
  onUnits(() => {
    fill("object-size", kept.size);
    fill("object-xyz", kept.xyz);
    for (const each of document.querySelectorAll(".unit-m")) each.textContent = `[${unitName("m")}]`;
    showObjects();
  });
  for (const id of ["object-size", "object-xyz"]) $(id).addEventListener("change", object);
  $("object-name").addEventListener("change", () => fillFrom($("object-name").value.trim()));
  const name = () => scene.objects.has(scene.selected) ? scene.selected : $("object-name").value.trim();
  const click = (id, does) => $(id).addEventListener("click", does);
  click("object-add", () => act("add_object", object()));
  click("object-delete", () => act("delete_object", { name: name() }));
  click("object-attach", () => run(`attach_object: ${name()}`));
  click("object-detach", () => run(`detach_object: ${name()}`));
  click("world-load", () => act("world", { name: $("world").value.trim() }));
  dragBodies();
  scene.onBodies = () => { if (scene.selected) select(scene.selected); setSizes(); };
}

function fillFrom(name) {
  const known = robot?.objects.find((each) => each.name === name);
  if (!known?.kind) return;
  $("object-kind").value = known.kind;
  fill("object-size", known.size);
  fill("object-xyz", known.xyz);
  object();
}

export function setObjects(message) {
  robot = message;
  list("worlds", robot.worlds);
  list("objects", robot.bodies);
  setSizes();
  showObjects();
}

/** The sizes of objects that can be resized, for their handles. */
function setSizes() {
  for (const form of robot?.objects ?? []) if (scene.objects.has(form.name)) scene.objects.get(form.name).half = form.half;
  showHandle();
}

function showObjects() {
  if (!robot) return;
  const forms = new Map(robot.objects.map((each) => [each.name, each]));
  $("object-list").replaceChildren(...robot.bodies.map((name) => {
    const form = forms.get(name);
    const size = form?.kind ? `${form.kind} ${form.size.map((each) => digits(each, "m")).join(" × ")}` : "";
    const said = [size, robot.fixed.includes(name) ? "fixed" : ""].filter(Boolean).join(", ");
    return element("button", { class: "object", "aria-pressed": String(name === scene.selected), onclick: () => pick(name) }, element("span", {}, name), element("small", {}, said));
  }));
}

/** Select by name, in the list or in the picture. */
export function pick(name) {
  choose(scene.objects.get(name) ?? scene.links.find((each) => each.name === name) ?? null);
  if (scene.selected) { $("object-name").value = scene.selected; fillFrom(scene.selected); }
  showObjects();
}

/** The selected object follows the pointer in the horizontal plane through its middle. */
function dragBodies() {
  const view = $("view");
  const under = (event) => (event.target === scene.viewer?.canvas ? bodyAt(event.offsetX, event.offsetY) : null);
  let looked = 0;
  view.addEventListener("pointermove", (event) => {
    if (event.buttons || Date.now() - looked < 60) return;
    looked = Date.now();
    const body = under(event);
    view.classList.toggle("over-object", Boolean(body));
    view.classList.toggle("over-selected", Boolean(body?.canMove && body.name === scene.selected));
  });
  view.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.shiftKey || event.target !== scene.viewer?.canvas) return;
    const body = under(event);
    if (!body?.canMove || body.name !== scene.selected) return;
    const start = [...body.pose], centre = start.slice(0, 3);
    const first = onPlane(rayAt(event), centre, [0, 0, 1]);
    if (!first) return;
    event.stopPropagation();
    const canvas = scene.viewer.canvas;
    canvas.setPointerCapture(event.pointerId);
    let hasMoved = false;
    const poseAt = (moved) => {
      const now = onPlane(rayAt(moved), centre, [0, 0, 1]);
      return now ? [start[0] + now[0] - first[0], start[1] + now[1] - first[1], ...start.slice(2)] : start;
    };
    const move = (moved) => {
      hasMoved ||= Math.hypot(moved.clientX - event.clientX, moved.clientY - event.clientY) > 4;
      if (!hasMoved) return;
      const pose = poseAt(moved);
      put(body, pose);
      showHandle();
      scene.viewer.moved();
      sendDrag({ kind: "object", name: body.name, pose, end: false });
    };
    const end = (last) => {
      last.stopPropagation(); // it is no click on the picture
      for (const [name, listener] of [["pointermove", move], ["pointerup", end], ["pointercancel", end]]) view.removeEventListener(name, listener, true);
      if (hasMoved) sendDrag({ kind: "object", name: body.name, pose: poseAt(last), end: true });
      else pick(body.name);
    };
    for (const [name, listener] of [["pointermove", move], ["pointerup", end], ["pointercancel", end]]) view.addEventListener(name, listener, true);
  }, { capture: true });
}
