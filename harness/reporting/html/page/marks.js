// What is drawn into the 3D view besides bodies: TCP paths, frames of goals, and why a verdict is as it is.

import { rgba, themeColor } from "./dom.js";
import { indexAt } from "./payload.js";
import { poseMatrix } from "./vectors.js";

const FRAME = 46; // length of the axes of a frame [pixels]
const CROSS = 9; // half the size of a cross [pixels]
const DASH = { plan: 0.03, raw: 0.016, missed: 0.016 }; // shares of the arm's size
const AXES = [[1, 0, 0, "#dc2626"], [0, 1, 0, "#16a34a"], [0, 0, 1, "#2563eb"]];

export class Marks {
  /**
   * @param {import("./payload.js").Payload} payload
   * @param {import("./viewer.js").Viewer} viewer
   */
  constructor(payload, viewer) {
    this.run = payload.run;
    this.viewer = viewer;
    const path = new Float32Array(payload.buffer("tcp"));
    const dash = (kind) => DASH[kind] * this.run.focus.arm;
    this.tcp = { times: new Float32Array(payload.buffer("tcp.times")), path };
    this.walked = viewer.addLine(path, { color: rgba(themeColor("--accent")), width: 3.5 });
    this.whole = viewer.addLine(path, { color: rgba(themeColor("--accent"), 0.25), width: 1.8 });
    const planned = (buffer, color, more) =>
      buffer === null ? null : viewer.addLine(new Float32Array(payload.buffer(buffer)), { color: rgba(themeColor(color)), ...more });
    this.planned = this.run.steps.map(({ plan }) => planned(plan, "--plan", { width: 2.5, dash: dash("plan") }));
    this.raw = this.run.steps.map(({ rawPlan }) => planned(rawPlan, "--raw", { width: 2, dash: dash("raw"), visible: false }));
    this.tool = this.#frame(FRAME, 3);
    this.goal = this.#frame(1.3 * FRAME, 2);
    this.nearest = crossLines(viewer, "--warn");
    this.missed = viewer.addLine([], { color: rgba(themeColor("--warn")), width: 2.5, dash: dash("missed"), onTop: true });
    /** @type {Record<string, boolean>} what the viewer has switched on */
    this.enabled = { path: true, plan: true, frame: true, goal: true };
  }

  /** Draw what belongs to a time. @param {number} time @param {number} step index, -1 if none @param {number[]} toolPose */
  show(time, step, toolPose) {
    const { enabled } = this;
    const seen = indexAt(this.tcp.times, time);
    const { start } = this.run.steps[step] ?? { start: 0 };
    this.walked.first = Math.max(0, indexAt(this.tcp.times, start) - 1);
    this.walked.segments = Math.max(0, seen - this.walked.first);
    this.walked.visible = this.whole.visible = enabled.path && this.tcp.times.length > 1;
    for (const [index, line] of this.planned.entries()) if (line) line.visible = enabled.plan && index === step;
    for (const [index, line] of this.raw.entries()) if (line) line.visible = enabled.raw && index === step;
    place(this.tool, enabled.frame ? toolPose : null);
    const { goal, nearest } = this.run.steps[step] ?? {};
    place(this.goal, enabled.goal ? goal : null);
    place(this.nearest, enabled.goal ? nearest?.place : null);
    const isMissed = enabled.goal && nearest?.place && nearest.target;
    this.missed.visible = Boolean(isMissed);
    if (isMissed && this.missedBy !== step) {
      this.missedBy = step;
      this.viewer.setPoints(this.missed, [...nearest.place.slice(0, 3), ...nearest.target.slice(0, 3)]);
    }
    this.viewer.redraw();
  }

  #frame(pixels, width) {
    return AXES.map(([x, y, z, color]) =>
      this.viewer.addLine([0, 0, 0, x, y, z], { color: rgba(color), width, pixels, onTop: true }),
    );
  }
}

/** Three short lines through a point. @param {import("./viewer.js").Viewer} viewer @param {string} color of the theme @param {number} [pixels] half their length */
export function crossLines(viewer, color, pixels = CROSS) {
  return [0, 1, 2].map((axis) => {
    const end = [0, 0, 0];
    end[axis] = 1;
    return viewer.addLine([...end.map((value) => -value), ...end], {
      color: rgba(themeColor(color)), width: 3, pixels, onTop: true, visible: false,
    });
  });
}

/** Put lines at a pose, or hide them. @param {any[]} lines @param {number[] | null | undefined} pose */
export function place(lines, pose) {
  for (const line of lines) {
    line.visible = Boolean(pose);
    if (pose) line.model = poseMatrix(pose);
  }
}
