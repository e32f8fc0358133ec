// Words over the 3D view that stay at points of the scene.

import { element } from "./dom.js";

export class Labels {
  /** @param {import("./viewer.js").Viewer} viewer @param {import("./orbit.js").Orbit} orbit */
  constructor(viewer, orbit) {
    this.viewer = viewer;
    this.orbit = orbit;
    this.host = element("div.labels");
    viewer.host.append(this.host);
    /** @type {{point: number[], made: HTMLElement}[]} */
    this.shown = [];
    viewer.onDrawn = () => this.#place();
  }

  /** @param {{point: number[], text: string, tone?: string}[]} labels replaces those that were there */
  show(labels) {
    this.shown = labels.map(({ point, text, tone = "" }) => ({ point, made: element(tone ? `output.${tone}` : "output", {}, text) }));
    this.host.replaceChildren(...this.shown.map(({ made }) => made));
    this.#place();
  }

  #place() {
    const [width, height] = [this.viewer.host.clientWidth, this.viewer.host.clientHeight];
    for (const { point, made } of this.shown) {
      const at = this.viewer.project(this.orbit, point);
      made.hidden = !at;
      if (!at) continue;
      // a number is never hidden: at the edge of the picture it stays at the edge
      const inside = [at[0], at[1]].map((value, i) => Math.max(4, Math.min(value + 10, (i ? height - made.offsetHeight : width - made.offsetWidth) - 4)));
      made.style.transform = `translate(${inside[0]}px, ${inside[1]}px)`;
    }
  }
}
