// Where bodies were: the recorded poses, between their frames.

import { undoDifferences } from "./payload.js";

const POSE_SIZE = 7;

export class Poses {
  /** @param {import("./payload.js").Payload} payload */
  constructor(payload) {
    this.payload = payload;
    this.frames = payload.run.frames;
    this.columns = undoDifferences(payload.buffer("poses"), this.frames.count);
  }

  /** xyz and quaternion wxyz (not normalised) of a body at a time. @param {any} body @param {number} time [s] @param {ArrayLike<number>} [columns] */
  of(body, time, columns = this.columns) {
    if (body.fixed) return body.fixed;
    const { count, step, unit } = this.frames;
    const place = Math.max(0, Math.min(count - 1, time / step));
    const [before, part] = [Math.floor(place), place % 1];
    const after = Math.min(count - 1, before + 1);
    const pose = new Array(POSE_SIZE);
    for (let i = 0; i < POSE_SIZE; i++) {
      const column = (body.column * POSE_SIZE + i) * count;
      const value = (1 - part) * columns[column + before] + part * columns[column + after];
      pose[i] = i < 3 ? value * unit : value;
    }
    return pose;
  }

  /** Commanded poses of the links: what is stored of them is how far they are from the recorded ones. */
  commanded() {
    const apart = undoDifferences(this.payload.buffer("commanded"), this.frames.count);
    return this.columns.map((value, i) => (i < apart.length ? value + apart[i] : value));
  }
}
