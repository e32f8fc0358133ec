// Rows of joints: a slider with its limits, buttons that nudge, and a number.

import { element, icon } from "./dom.js";
import { amount, digits, nudge, onUnits, read, unitName } from "./quantities.js";

const HELD = 1500; // [ms]: so long the row shows what was requested and not what is measured
const NEAR = 0.06, AT = 0.006; // shares of a joint's range that are near its limit, and at it
const FREE = 4 * Math.PI - 1e-6; // [rad]: a range that is as good as none

/**
 * @param {{name: string, label: string, lower: number, upper: number, slides: boolean, isCalm?: boolean}} joint
 *   a calm one is not coloured near its ends
 * @param {(value: number, isLast: boolean) => void} send is given the value in rad or m
 */
export function jointRow(joint, send) {
  const unit = joint.slides ? "m" : "rad";
  const range = joint.upper - joint.lower;
  const isFree = joint.isCalm || (!joint.slides && range >= FREE);
  const slider = element("input", { type: "range", min: joint.lower, max: joint.upper, step: range / 4000, "aria-label": joint.name });
  const field = element("input", { type: "number", step: "any", id: `value-${joint.name}`, "aria-label": `${joint.name} number` });
  const name = element("span", {}), low = element("span", { class: "end" }), high = element("span", { class: "end" });
  const track = element("span", { class: isFree ? "track free" : "track" }, slider);
  track.style.setProperty("--edge", `${100 * NEAR}%`);
  let held = 0, value = 0, isEditing = false;

  const mark = () => {
    const left = Math.min(value - joint.lower, joint.upper - value) / range;
    row.classList.toggle("near", !isFree && left < NEAR && left >= AT);
    row.classList.toggle("at-limit", !isFree && left < AT);
  };
  const request = (requested, isLast) => {
    held = Date.now();
    value = Number(slider.value = requested);
    if (document.activeElement !== field) field.value = digits(value, unit);
    mark();
    send(requested, isLast);
  };
  const by = (sign) => (event) => request(clamp(value + sign * read(nudge(unit) * (event.shiftKey ? 10 : 1), unit)), true);
  const clamp = (number) => Math.max(joint.lower, Math.min(joint.upper, number));
  slider.addEventListener("input", () => request(Number(slider.value), false));
  slider.addEventListener("change", () => request(Number(slider.value), true));
  field.addEventListener("input", () => { isEditing = true; });
  field.addEventListener("blur", () => { isEditing = false; });
  field.addEventListener("change", () => { isEditing = false; if (field.value !== "") request(read(field.value, unit), true); });
  const minus = element("button", { title: "", "aria-label": `${joint.name} less`, onclick: by(-1) }, icon("minus"));
  const plus = element("button", { title: "", "aria-label": `${joint.name} more`, onclick: by(1) }, icon("plus"));
  const row = element("div", { class: "joint", "data-joint": joint.name },
    element("label", { for: field.id, title: joint.name }, joint.label), element("span", { class: "value" }, minus, field, name, plus),
    element("span", { class: "range" }, low, track, high));

  return {
    row,
    units() {
      name.textContent = unitName(unit);
      minus.title = plus.title = `${nudge(unit)} ${unitName(unit)}; with shift ten times as much`;
      low.textContent = amount(joint.lower, unit, 0);
      high.textContent = amount(joint.upper, unit, 0);
      field.value = digits(value, unit);
    },
    /** Show what is measured: the mark under the thumb at once, the rest once the row is not being used. */
    show(measured) {
      track.style.setProperty("--at", String((measured - joint.lower) / range));
      if (Date.now() - held < HELD) return;
      value = measured;
      slider.value = measured;
      if (!isEditing) field.value = digits(measured, unit);
      mark();
    },
  };
}

const rows = [];
/** Keep rows in the units of the page. */
export const keepUnits = (list, box) => { rows.push(...list.filter(({ row }) => box.contains(row))); list.forEach((each) => each.units()); };
onUnits(() => { for (const each of rows.filter(({ row }) => row.isConnected)) each.units(); });
