// The planner's requests and results, step by step.

import { element } from "./dom.js";
import { amount, degrees, number, seconds, tone } from "./units.js";

const SOLUTIONS_SHOWN = 8;
const LABELS = {
  planner_id: "planner", state_checks: "state checks", search_checks: "of these, by the search",
  path_length: "path length", raw_path_length: "before shortening", attempts: "attempts",
  waypoints: "waypoints", vertices: "tree vertices", resolution: "resolution", duration: "duration",
};
const UNITS = {
  path_length: "rad", raw_path_length: "rad", resolution: "rad", path_deviation: "rad", duration: "s", position_deviation: "m",
  orientation_deviation: "rad", link_velocity: "m/s", link_acceleration: "m/s^2", link_turning: "rad/s",
};
const DRAWN = ["path", "raw_path", "raw_waypoints", "waypoint_positions"];

/**
 * @param {import("./payload.js").Payload} payload
 * @param {(index: number) => void} select
 * @returns {HTMLElement}
 */
export function plannerView({ run }, select) {
  const requests = run.steps
    .map((step, index) => ({ step, index }))
    .filter(({ step }) => Object.keys(step.planner).length || Object.keys(step.explanation).length);
  if (!requests.length) return element("p.empty", {}, "No step used the planner.");
  const slides = run.joints?.some(({ unit }) => unit !== "°");
  return element("div.planner", {}, ...requests.map(({ step, index }) => planned(step, index, select, slides)));
}

/** @param {boolean} slides whether some joint is in metres, so that a row of positions has no one unit */
function planned(step, index, select, slides) {
  const { ik_solutions: solutions, ik_method: method, stages, advice, nearest, picture, ...rest } = step.explanation;
  return element(
    `section.${tone(step.status)}`, { "data-step": index },
    element("h3", {}, element("button.link", { type: "button", onclick: () => select(index) }, `${index + 1}. ${step.summary}`)),
    step.message && element("p.why", {}, step.message),
    shortening(step.planner),
    facts(step.planner, isShortened(step.planner) ? [...DRAWN, "path_length", "raw_path_length"] : [...DRAWN, "raw_path_length"]),
    stages?.length ? stageList(stages) : null,
    advice && element("p.advice", {}, element("b", {}, "What to do: "), advice),
    nearest?.shows && element("p.remark", {}, element("b", {}, "Drawn in orange: "), nearest.shows),
    solutions && solutionTable(method, solutions, slides),
    ...Object.entries(rest).map(([key, value]) => remark(key, value)),
  );
}

function isShortened({ path_length: after, raw_path_length: before }) {
  return after > 0 && before > after * (1 + 1e-6);
}

/** Bars of the path's length before and after it was shortened. */
function shortening(planner) {
  if (!isShortened(planner)) return null;
  const { path_length: after, raw_path_length: before } = planner;
  const row = (label, length) => {
    const bar = element("i");
    bar.style.width = `${(100 * length) / Math.max(before, after)}%`;
    return element("div.length", {}, element("span", {}, label), element("span.bar", {}, bar), element("code", {}, amount(length, "rad")));
  };
  return element("div.lengths", {}, row("as found", before), row("shortened", after));
}

const SIGNS = { passed: "good", failed: "bad", skipped: "open" };

/** What became of each stage of planning. */
function stageList(stages) {
  return element(
    "ol.stages", {},
    ...stages.map(({ stage, status, code, text, details }) =>
      element(
        `li.${SIGNS[status] ?? "open"}`, {},
        element("i.sign", { role: "img", "aria-label": status }),
        element("b", {}, stage), code && element("span.tag.bad", {}, code), element("span.reason", {}, text),
        ...details.map((line) => element("span.detail", {}, line)),
      ),
    ),
  );
}

/** @param {string[]} hidden keys that are shown in another way */
function facts(planner, hidden) {
  const shown = Object.entries(planner).filter(([key]) => !hidden.includes(key));
  if (!shown.length) return null;
  return element(
    "dl", {},
    ...shown.flatMap(([key, value]) => [element("dt", {}, LABELS[key] ?? words(key)), element("dd", {}, plain(value, UNITS[key]))]),
  );
}

function solutionTable(method, solutions, slides) {
  const count = `${solutions.length || "no"} solution${solutions.length === 1 ? "" : "s"}`;
  const head = `Inverse kinematics${method ? ` (${method})` : ""}: ${count}, ${slides ? "rad and m" : "degrees"}`;
  const positions = slides ? (values) => values.map(number).join("  ") : degrees;
  const rows = solutions.slice(0, SOLUTIONS_SHOWN).map((solution) => {
    const isGood = /^(chosen|free|reachable|valid)/.test(solution.status ?? "");
    const touches = (solution.touches ?? []).map(({ pair, distance }) => `${pair.join(" and ")} ${amount(distance, "m")}`);
    return element(
      "tr", {},
      element("td", {}, element(`span.tag.${isGood ? "good" : "bad"}`, {}, solution.status ?? "")),
      element("td", {}, element("code", {}, positions(solution.joint_positions ?? [])), touches.length ? element("div.touches", {}, touches.slice(0, 3).join("; ")) : null),
    );
  });
  return element("details", { open: solutions.length <= SOLUTIONS_SHOWN }, element("summary", {}, head), element("table.solutions", {}, element("tbody", {}, ...rows)));
}

function remark(key, value) {
  const isEmpty = value === null || (typeof value === "object" && !Object.keys(value).length);
  if (isEmpty) return null;
  const isLong = JSON.stringify(value).length > 300;
  const content = element("div.remark", {}, isLong ? "" : element("b", {}, `${words(key)}: `), plain(value));
  return isLong ? element("details", {}, element("summary", {}, words(key)), content) : content;
}

/** Plain data as text: numbers short, lists in a line. */
export function plain(value, unit = "") {
  if (typeof value === "number") {
    if (unit === "s") return seconds(value);
    return unit ? amount(value, unit) : Number.isInteger(value) ? String(value) : number(value);
  }
  if (Array.isArray(value)) return value.map((item) => plain(item)).join(", ");
  if (value && typeof value === "object") {
    return Object.entries(value).map(([key, item]) => `${words(key)} ${plain(item)}`).join(", ");
  }
  return String(value);
}

function words(key) {
  return LABELS[key] ?? key.replaceAll("_", " ");
}
