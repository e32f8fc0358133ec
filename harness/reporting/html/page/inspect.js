// What a click on a body shows: its name, pose, mass, contacts, and where the file defines it.

import { byId, element } from "./dom.js";
import { amount } from "./units.js";

const DEGREES = 180 / Math.PI;

/** Roll, pitch and yaw about fixed axes [rad], as in URDF. @param {number[]} pose xyz, quaternion wxyz of any length */
export function rollPitchYaw(pose) {
  const length = Math.hypot(...pose.slice(3)) || 1;
  const [w, x, y, z] = pose.slice(3).map((value) => value / length);
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(sine), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

export class Inspector {
  /**
   * @param {any} run @param {import("./contacts.js").Contacts} arrows
   * @param {(time: number) => {first: string, second: string, force: number}[]} touching pairs in contact
   */
  constructor(run, arrows, touching) {
    Object.assign(this, { run, arrows, touching });
    this.onChange = () => {}; // another body was chosen
    this.onLine = (_line) => {}; // the place in the file is to be shown
    this.body = null;
    this.card = element("section.card", { hidden: "", "aria-label": "Chosen body" });
    byId("view").append(this.card);
  }

  /** @param {any} body of the replay; null closes the card @param {number} time [s] */
  choose(body, time) {
    this.body = body === this.body ? null : body;
    this.card.hidden = !this.body;
    this.show(time);
    this.onChange();
  }

  /** @param {number} time [s] */
  show(time) {
    const { body } = this;
    if (!body) return;
    const pose = body.pose;
    const position = pose.slice(0, 3).map((value) => (1000 * value).toFixed(1)).join("  ");
    const turn = rollPitchYaw(pose).map((value) => (value * DEGREES).toFixed(1)).join("  ");
    const rows = [
      ["xyz", `${position} mm`],
      ["rpy", `${turn} °`],
      body.mass && ["mass", amount(body.mass, "kg")],
      ...this.#contacts(time).map((text) => ["contact", text]),
    ].filter(Boolean);
    const close = element("button.link", { type: "button", "aria-label": "Close", onclick: () => this.choose(null, time) }, "✕");
    this.card.replaceChildren(
      element("h3", {}, body.name, " ", close),
      element("p.what", {}, this.#owner()),
      element("dl", {}, ...rows.flatMap(([name, text]) => [element("dt", {}, name), element("dd", {}, text)])),
    );
  }

  #owner() {
    const { body, run } = this;
    if (body.isLink) return `link of ${run.robot}`;
    const kind = body.ghost ? "object of the planning scene alone" : "object";
    if (!body.line) return `${kind}, not defined in this file`;
    return element("button.link", { type: "button", onclick: () => this.onLine(body.line) }, `${kind}, line ${body.line}`);
  }

  #contacts(time) {
    const { name } = this.body;
    const pressed = this.arrows.at(time).filter(({ link, body }) => link === name || body === name);
    const others = pressed.map(({ link, body }) => (link === name ? body : link));
    const touched = this.touching(time).filter(({ first, second }) => first === name || second === name);
    const more = touched.map(({ first, second, force }) => [first === name ? second : first, force]).filter(([other]) => !others.includes(other));
    return [...pressed.map(({ size }, i) => [others[i], size]), ...more].map(([other, force]) => `${other} ${force.toFixed(1)} N`);
  }
}
