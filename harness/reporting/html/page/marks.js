// What is drawn into the 3D view besides bodies: TCP paths, frames of goals, points of a verdict.

import { rgba, themeColor } from "./dom.js";
import { indexAt } from "./payload.js";
import { poseMatrix } from "./vectors.js";

const AXIS = 0.09; // [m]
const AXES = [[1, 0, 0, "#dc2626"], [0, 1, 0, "#16a34a"], [0, 0, 1, "#2563eb"]];
const CROSS = 0.02; // half the size of a cross [m]

export class Marks {
  /**
   * @param {import("./payload.js").Payload} payload
   * @param {import("./viewer.js").Viewer} viewer
   */
  constructor(payload, viewer) {
    this.run = payload.run;
    this.viewer = viewer;
    const path = new Float32Array(payload.buffer("tcp"));
    this.tcp = { times: new Float32Array(payload.buffer("tcp.times")), path };
    this.walked = viewer.addLine(path, { color: rgba(themeColor("--accent")), width: 3.5 });
    this.whole = viewer.addLine(path, { color: rgba(themeColor("--accent"), 0.25), width: 1.8 });
    this.planned = this.run.steps.map((step) =>
      step.plan === null
        ? null
        : viewer.addLine(new Float32Array(payload.buffer(step.plan)), {
            color: rgba(themeColor("--plan")), width: 2.5, dash: 0.022,
          }),
    );
    this.raw = this.run.steps.map((step) =>
      step.rawPlan === null
        ? null
        : viewer.addLine(new Float32Array(payload.buffer(step.rawPlan)), {
            color: rgba(themeColor("--raw")), width: 2, dash: 0.012, visible: false,
          }),
    );
    this.tool = this.#frame(AXIS, 3);
    this.goal = this.#frame(AXIS * 1.35, 2);
    this.nearest = this.#cross("--warn");
    this.missed = viewer.addLine([], { color: rgba(themeColor("--warn")), width: 2.5, dash: 0.012, onTop: true });
    this.expected = this.#cross("--good");
    this.actual = this.#cross("--bad");
    this.between = viewer.addLine([], { color: rgba(themeColor("--bad")), width: 3, onTop: true });
    /** @type {Record<string, boolean>} what the viewer has switched on */
    this.enabled = { path: true, plan: true, frame: true, goal: true };
    this.verdict = null;
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
    this.#place(this.tool, enabled.frame ? toolPose : null);
    const { goal, nearest } = this.run.steps[step] ?? {};
    this.#place(this.goal, enabled.goal ? goal : null);
    this.#place(this.nearest, enabled.goal ? nearest?.place : null);
    const isMissed = enabled.goal && nearest?.place && nearest.target;
    this.missed.visible = Boolean(isMissed);
    if (isMissed && this.missedBy !== step) {
      this.missedBy = step;
      this.viewer.setPoints(this.missed, [...nearest.place.slice(0, 3), ...nearest.target.slice(0, 3)]);
    }
    this.viewer.redraw();
  }

  /** Draw expected against actual of a verdict. @param {{expected?: number[], actual?: number[], good?: boolean} | null} points */
  compare(points) {
    const { expected, actual } = points ?? {};
    this.#place(this.expected, expected ? [...expected.slice(0, 3), 1, 0, 0, 0] : null);
    this.#place(this.actual, actual ? [...actual.slice(0, 3), 1, 0, 0, 0] : null);
    this.viewer.setPoints(this.between, expected && actual ? [...expected.slice(0, 3), ...actual.slice(0, 3)] : []);
  }

  #frame(size, width) {
    return AXES.map(([x, y, z, color]) =>
      this.viewer.addLine([0, 0, 0, size * x, size * y, size * z], { color: rgba(color), width, onTop: width < 3 }),
    );
  }

  #cross(color) {
    return [0, 1, 2].map((axis) => {
      const end = [0, 0, 0];
      end[axis] = CROSS;
      return this.viewer.addLine([...end.map((value) => -value), ...end], {
        color: rgba(themeColor(color)), width: 3, onTop: true, visible: false,
      });
    });
  }

  /** @param {any[]} lines @param {number[] | null | undefined} pose */
  #place(lines, pose) {
    for (const line of lines) {
      line.visible = Boolean(pose);
      if (pose) line.model = poseMatrix(pose);
    }
  }
}
