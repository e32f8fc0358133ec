// Handles over the picture: arrows, rings and squares that move, turn and size what they are on.

import { addScaled, cross, dot, normalize, subtract } from "/view/vectors.js";
import { $ } from "./dom.js";
import { scene } from "./scene.js";
import { aboutAxis, axesOf, product } from "./turns.js";

const ARROW = 84, RING = 58, TIP = 13, SQUARE = 6, OUTSIDE = 16; // [pixels]; squares lie outside, so that bodies can be dragged
const NAMES = ["x", "y", "z"];
const EDGE_ON = 0.12; // cosine below which a plane is seen too flat to be dragged in
const RING_POINTS = 48;
const SVG = "http://www.w3.org/2000/svg";

/**
 * What the handles are on: its pose, the axes about which it turns, and half its sizes where it can be resized.
 * @type {{kind: string, pose: number[], turns: string, half: number[] | null} | null}
 */
let held = null, dragging = null;
let onDrag = () => {};
const layer = document.createElementNS(SVG, "svg");
layer.id = "gizmo";
const parts = new Map();

export function startGizmo(listener) {
  onDrag = listener;
  $("view").append(layer);
  scene.onDrawn = place;
}

/** Put the handles on something; null takes them away. While they are dragged, the pointer says where they are. */
export function holdGizmo(what) {
  if (dragging && what?.kind === held?.kind) return;
  held = what;
  dragging = null;
  layer.replaceChildren();
  parts.clear();
  if (!held) return;
  if (held.kind === "tcp") part("move freely", "free", ["circle", "hit point"], ["circle", "shown tip"]); // bodies are dragged themselves
  NAMES.forEach((name, axis) => {
    if (held.turns === "all" || (held.turns === "pitch" && axis === 1) || (held.turns === "yaw" && axis === 2)) part(`turn ${name}`, name, ["path", "hit"], ["path", "shown ring"]);
  });
  NAMES.forEach((name, axis) => {
    part(`move ${name}`, name, ["path", "hit"], ["path", "shown"], ["path", "shown tip"]);
    if (held.half?.[axis]) part(`size ${name}`, name, ["circle", "hit point"], ["rect", "shown tip"]);
  });
  scene.viewer?.redraw();
}

/** Move the handles with what they are on; whether they are on it. */
export function followGizmo(kind, pose) {
  if (held?.kind === kind && !dragging) held.pose = [...pose];
  return held?.kind === kind;
}

function part(label, tone, ...shapes) {
  const group = document.createElementNS(SVG, "g");
  group.setAttribute("class", tone);
  group.setAttribute("aria-label", label);
  const made = shapes.map(([tag, kind]) => {
    const shape = document.createElementNS(SVG, tag);
    shape.setAttribute("class", kind);
    if (kind === "shown ring" || kind === "shown") shape.setAttribute("fill", "none");
    return group.appendChild(shape);
  });
  made[0].addEventListener("pointerdown", (event) => begin(event, label, group));
  parts.set(label, made);
  layer.append(group);
}

/** Metres that a pixel is at the handles. */
function metres() {
  const { orbit, viewer } = scene;
  const depth = -dot(subtract(held.pose, orbit.eye), orbit.back);
  return (2 * orbit.tangent * Math.max(depth, 0.01)) / viewer.host.clientHeight;
}

const world = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
/** Objects and goals move along the world's axes and turn about their own; sizes are along their own. */
const turnAxes = () => axesOf(held.pose.slice(3));

function place() {
  if (!held || !scene.viewer) return;
  const unit = metres(), centre = held.pose.slice(0, 3);
  const at = (point) => scene.viewer.project(scene.orbit, point) ?? [-999, -999];
  const line = (points) => `M${points.map((point) => point.map((each) => each.toFixed(1)).join(" ")).join("L")}`;
  const [cx, cy] = at(centre);
  const own = turnAxes();
  for (const [label, [hit, shown, tip]] of parts) {
    const [what, name] = label.split(" ");
    const axis = NAMES.indexOf(name);
    if (what === "turn") {
      const [u, v] = [own[(axis + 1) % 3], own[(axis + 2) % 3]];
      const ring = Array.from({ length: RING_POINTS + 1 }, (_, i) => {
        const angle = (2 * Math.PI * i) / RING_POINTS;
        return at(addScaled(addScaled(centre, u, RING * unit * Math.cos(angle)), v, RING * unit * Math.sin(angle)));
      });
      for (const each of [hit, shown]) each.setAttribute("d", line(ring));
    } else if (label === "move freely") {
      for (const [each, radius] of [[hit, 11], [shown, 5]]) {
        for (const [key, value] of [["cx", cx], ["cy", cy], ["r", radius]]) each.setAttribute(key, value);
      }
    } else if (what === "move") {
      const [ex, ey] = at(addScaled(centre, world[axis], ARROW * unit));
      const long = Math.hypot(ex - cx, ey - cy) || 1;
      const [dx, dy] = [(ex - cx) / long, (ey - cy) / long];
      const isSeen = long > 0.2 * ARROW; // an arrow that points at the eye cannot be dragged
      const from = [cx + 9 * dx, cy + 9 * dy], to = [ex - TIP * dx, ey - TIP * dy];
      hit.setAttribute("d", isSeen ? line([[cx + 24 * dx, cy + 24 * dy], [ex, ey]]) : "");
      shown.setAttribute("d", isSeen ? line([from, to]) : "");
      tip.setAttribute("d", isSeen ? `${line([[ex, ey], [to[0] - 5.5 * dy, to[1] + 5.5 * dx], [to[0] + 5.5 * dy, to[1] - 5.5 * dx]])}Z` : "");
    } else {
      const [x, y] = at(addScaled(centre, own[axis], Math.max(held.half[axis], (ARROW + OUTSIDE) * unit)));
      for (const [key, value] of [["cx", x], ["cy", y], ["r", 11]]) hit.setAttribute(key, value);
      for (const [key, value] of [["x", x - SQUARE], ["y", y - SQUARE], ["width", 2 * SQUARE], ["height", 2 * SQUARE], ["rx", 2]]) shown.setAttribute(key, value);
    }
  }
}

// -- dragging -------------------------------------------------------------------------------

/** The ray from the eye through a place of the page. */
export function rayAt(event) {
  const { orbit, viewer } = scene;
  const box = viewer.canvas.getBoundingClientRect();
  const half = orbit.tangent / (box.height / 2);
  const right = normalize(cross([0, 0, 1], orbit.back)), up = cross(orbit.back, right);
  const [x, y] = [half * (event.clientX - box.x - box.width / 2), half * (box.y + box.height / 2 - event.clientY)];
  return { from: orbit.eye, along: normalize(addScaled(addScaled(addScaled([0, 0, 0], orbit.back, -1), right, x), up, y)) };
}

/** Where a ray meets a plane; null where it is seen too flat. */
export function onPlane({ from, along }, point, normal) {
  const facing = dot(along, normal);
  if (Math.abs(facing) < EDGE_ON) return null;
  return addScaled(from, along, dot(subtract(point, from), normal) / facing);
}

/** How far along an axis the point is that is nearest to a ray [m]. */
function alongAxis({ from, along }, point, axis) {
  const b = dot(axis, along), apart = subtract(point, from);
  return 1 - b * b < 1e-3 ? 0 : (b * dot(along, apart) - dot(axis, apart)) / (1 - b * b);
}

function begin(event, label, group) {
  if (event.button !== 0 || !scene.viewer) return;
  event.preventDefault();
  event.stopPropagation();
  const [what, name] = label.split(" ");
  const axis = NAMES.indexOf(name), start = [...held.pose], centre = start.slice(0, 3);
  const own = turnAxes();
  const direction = what === "move" ? world[axis] : own[axis];
  const first = rayAt(event);
  const target = event.currentTarget;
  const half = held.half && [...held.half];
  target.setPointerCapture(event.pointerId);
  group.classList.add("held");
  dragging = label;
  const at = (ray) => {
    if (label === "move freely") {
      const [a, b] = [onPlane(first, centre, scene.orbit.back), onPlane(ray, centre, scene.orbit.back)];
      return a && b ? [...addScaled(centre, subtract(b, a), 1), ...start.slice(3)] : start;
    }
    if (what === "turn") {
      const [a, b] = [onPlane(first, centre, direction), onPlane(ray, centre, direction)];
      if (!a || !b) return start;
      const [u, v] = [subtract(a, centre), subtract(b, centre)];
      return [...centre, ...product(aboutAxis(direction, Math.atan2(dot(cross(u, v), direction), dot(u, v))), start.slice(3))];
    }
    const by = alongAxis(ray, centre, direction) - alongAxis(first, centre, direction);
    if (what === "size") {
      held.half[axis] = Math.max(0.0025, half[axis] + by / 2);
      return [...addScaled(centre, direction, held.half[axis] - half[axis]), ...start.slice(3)];
    }
    return [...addScaled(centre, direction, by), ...start.slice(3)];
  };
  const send = (moved, isEnd) => {
    held.pose = at(rayAt(moved));
    onDrag(held, what, isEnd);
    scene.viewer.redraw();
  };
  const move = (moved) => send(moved, false);
  const end = (last) => {
    target.removeEventListener("pointermove", move);
    target.removeEventListener("pointerup", end);
    target.removeEventListener("pointercancel", end);
    group.classList.remove("held");
    dragging = null;
    send(last, true);
  };
  target.addEventListener("pointermove", move);
  target.addEventListener("pointerup", end);
  target.addEventListener("pointercancel", end);
}
