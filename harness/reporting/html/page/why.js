// Why a verdict is as it is, drawn into the scene: nearest points, a pair, a joint, a path's deviation.

import { rgba, themeColor } from "./dom.js";
import { crossLines, place } from "./marks.js";
import { indexAt } from "./payload.js";
import { amount, tone } from "./units.js";
import { addScaled, dot, subtract } from "./vectors.js";

const HIGHLIGHT = 0.7; // glow of the bodies that a verdict is about
const SEEN = 0.06; // of the arm's size: how long the largest deviation is drawn
const AGREED = 1.5; // factor within which the drawn deviation is the measured one
const MOST_EXAGGERATED = 1000;
const POINT = 4; // half the size of a point [pixels]: two that are near stay apart

export class Why {
  /** @param {import("./payload.js").Payload} payload @param {import("./viewer.js").Viewer} viewer @param {import("./labels.js").Labels} labels @param {import("./marks.js").Marks} marks @param {import("./replay.js").Replay} replay */
  constructor(payload, viewer, labels, marks, replay) {
    Object.assign(this, { payload, viewer, labels, replay, tcp: marks.tcp });
    this.run = payload.run;
    this.expected = crossLines(viewer, "--good", POINT);
    this.actual = crossLines(viewer, "--bad", POINT);
    this.between = viewer.addLine([], { color: rgba(themeColor("--bad")), width: 3, onTop: true });
    this.reference = viewer.addLine([], { color: rgba(themeColor("--good")), width: 2.5, onTop: true });
    this.deviation = viewer.addLine([], { color: rgba(themeColor("--warn")), width: 2.5, onTop: true });
    /** Glow of bodies by name. @type {Map<string, number>} */
    this.glows = new Map();
  }

  /** @param {any} verdict one of the run's; null for none */
  show(verdict) {
    const points = verdict?.points ?? verdict?.nearest ?? null;
    this.glows = new Map((verdict?.bodies ?? []).map((name) => [name, HIGHLIGHT]));
    const at = (point) => (point ? [...point.slice(0, 3), 1, 0, 0, 0] : null);
    place(this.expected, at(points?.expected));
    place(this.actual, at(points?.actual));
    this.viewer.setPoints(this.between, points ? [...points.expected.slice(0, 3), ...points.actual.slice(0, 3)] : []);
    const path = verdict ? this.#path(verdict) : null;
    this.viewer.setPoints(this.reference, path?.reference ?? []);
    this.viewer.setPoints(this.deviation, path?.exaggerated ?? []);
    this.labels.show([...this.#labels(verdict, points), ...(path?.labels ?? [])]);
  }

  #labels(verdict, points) {
    const measure = verdict?.measures[0];
    if (!measure) return [];
    const number = amount(measure.value, measure.unit);
    const color = tone(verdict.status);
    if (points) return [{ point: addScaled(points.expected, subtract(points.actual, points.expected), 0.5), text: `${measure.name} ${number}`, tone: color }];
    const body = this.replay.byName.get(verdict.bodies[0]);
    return body ? [{ point: body.pose.slice(0, 3), text: `${measure.detail} ${measure.name} ${number}`, tone: color }] : [];
  }

  /** The planned path and the recorded one, with what lies between them made large enough to be seen. */
  #path(verdict) {
    const measure = verdict.measures.find(({ name }) => name.startsWith("deviation from"));
    const step = this.run.steps.find(({ id }) => id === verdict.step);
    if (!measure || !step?.plan) return null;
    const reference = new Float32Array(this.payload.buffer(step.plan));
    const { times, path } = this.tcp;
    const [first, last] = [indexAt(times, step.start), indexAt(times, step.end)];
    const recorded = Array.from({ length: last - first + 1 }, (_, i) => path.subarray(3 * (first + i), 3 * (first + i) + 3));
    const apart = recorded.map((point) => {
      const nearest = nearestOn(reference, point);
      return { nearest, away: subtract(point, nearest) };
    });
    const largest = apart.reduce((most, each) => (Math.hypot(...each.away) > Math.hypot(...most.away) ? each : most), apart[0]);
    const size = Math.hypot(...largest.away);
    const isMeasured = size < AGREED * measure.value && measure.value < AGREED * size;
    if (!isMeasured) {
      // the path of the page has too few points to show what was measured on all of them
      const text = `${amount(measure.value, "m")} off the path`;
      return { reference, exaggerated: [], labels: [{ point: this.replay.byName.get(this.run.toolBody).pose.slice(0, 3), text, tone: "warn" }] };
    }
    const factor = Math.max(1, Math.min(MOST_EXAGGERATED, roundDown((SEEN * this.run.focus.arm) / (size || 1))));
    const exaggerated = apart.flatMap(({ nearest, away }) => addScaled(nearest, away, factor));
    const label = { point: addScaled(largest.nearest, largest.away, factor), text: `${amount(measure.value, "m")} off the path, drawn ${factor} ×`, tone: "warn" };
    return { reference, exaggerated, labels: [label] };
  }
}

/** The nearest point of a polyline. @param {ArrayLike<number>} line x, y, z of each corner @param {ArrayLike<number>} point */
export function nearestOn(line, point) {
  let [best, least] = [[line[0], line[1], line[2]], Infinity];
  for (let i = 0; i + 5 < line.length; i += 3) {
    const start = [line[i], line[i + 1], line[i + 2]];
    const along = subtract([line[i + 3], line[i + 4], line[i + 5]], start);
    const share = Math.max(0, Math.min(1, dot(subtract(point, start), along) / (dot(along, along) || 1)));
    const candidate = addScaled(start, along, share);
    const distance = Math.hypot(...subtract(point, candidate));
    if (distance < least) [best, least] = [candidate, distance];
  }
  return best;
}

/** 1, 2 or 5 times a power of ten. */
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((digit) => digit * power <= value) * power;
}
