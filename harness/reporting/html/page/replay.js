// The recorded bodies in the 3D view, posed at any time.

import { creased } from "./normals.js";
import { decodeMesh, undoDifferences } from "./payload.js";
import { primitive, square } from "./shapes.js";
import { multiply, poseMatrix } from "./vectors.js";

const CREASE = { mesh: 0.76, shape: 0.9 }; // cosines
const FLOOR_SIZE = 12; // half its side [m]
const POSE_SIZE = 7;

export class Replay {
  /** @param {import("./payload.js").Payload} payload @param {import("./viewer.js").Viewer} viewer */
  constructor(payload, viewer) {
    this.viewer = viewer;
    this.run = payload.run;
    this.frames = payload.run.frames;
    this.columns = undoDifferences(payload.buffer("poses"), this.frames.count);
    this.meshes = payload.run.meshes.map((head) => {
      const { positions, indices } = decodeMesh(payload, head);
      return creased(positions, indices, CREASE.mesh);
    });
    this.bodies = payload.run.bodies.map((body) => this.#build(body));
    this.byName = new Map(this.bodies.map((body) => [body.name, body]));
  }

  /** Put every body where it was. @param {number} time [s] */
  pose(time) {
    for (const body of this.bodies) {
      body.pose = this.poseOf(body, time);
      const matrix = poseMatrix(body.pose);
      const isThere = body.shown.some(([from, to]) => time >= from && time <= to);
      for (const piece of body.pieces) {
        piece.surface.model = multiply(matrix, piece.local);
        piece.surface.visible = isThere && this.isShown(body);
      }
      body.isThere = isThere;
    }
    this.viewer.moved();
  }

  /** Which bodies are switched on. */
  isShown(body) {
    return !(body.ghost && this.hidesGhosts);
  }

  /** xyz and quaternion wxyz (not normalised) of a body at a time. */
  poseOf(body, time) {
    if (body.fixed) return body.fixed;
    const { count, step } = this.frames;
    const place = Math.max(0, Math.min(count - 1, time / step));
    const [before, part] = [Math.floor(place), place % 1];
    const after = Math.min(count - 1, before + 1);
    const pose = new Array(POSE_SIZE);
    for (let i = 0; i < POSE_SIZE; i++) {
      const column = (body.column * POSE_SIZE + i) * count;
      const value = (1 - part) * this.columns[column + before] + part * this.columns[column + after];
      pose[i] = i < 3 ? value * this.frames.unit : value;
    }
    return pose;
  }

  /** Let bodies that collide glow by how hard they do; all others keep their colour. @param {Map<string, number>} glows 0 to 1 by name */
  glow(glows) {
    for (const body of this.bodies) {
      for (const piece of body.pieces) piece.surface.glow = piece.surface.grid ? 0 : glows.get(body.name) ?? 0;
    }
  }

  /** A translucent robot in another state, next to the recorded one. @param {Record<string, number[]> | null} poses by body; null hides it */
  showState(poses) {
    this.state ??= this.#copies();
    for (const { name, copy, local } of this.state) {
      copy.visible = Boolean(poses?.[name]);
      if (poses?.[name]) copy.model = multiply(poseMatrix(poses[name]), local);
    }
    this.viewer.redraw();
  }

  #copies() {
    const tinted = (color) => [...[0.95, 0.55, 0.1].map((tint, i) => 0.6 * tint + 0.4 * color[i]), 0.6];
    return this.bodies.flatMap(({ name, pieces, isLink }) =>
      !isLink ? [] : pieces.map(({ surface, local }) => ({
        name, local,
        copy: this.viewer.addCopy(surface, { color: tinted(surface.color), castsShadow: false, glow: 0 }),
      })),
    );
  }

  /** Colour of the floor: it goes with the theme. @param {number[]} color */
  paintFloor(color) {
    for (const body of this.bodies) {
      for (const piece of body.pieces) if (piece.surface.grid) piece.surface.color = color;
    }
  }

  #build(body) {
    const pieces = body.shapes.flatMap((shape) => this.#surfaces(shape, body.ghost));
    return { ...body, pieces, pose: body.fixed, isThere: true };
  }

  #surfaces(shape, isGhost) {
    const local = poseMatrix(shape.pose);
    const color = [...shape.color];
    if (isGhost) color[3] = Math.min(color[3], 0.34);
    const options = { castsShadow: !isGhost && color[3] > 0.99 };
    const add = (mesh, tint, more = {}) => ({
      local,
      surface: this.viewer.addSurface(mesh, tint, { ...options, ...more }),
    });
    if (shape.kind === "mesh") {
      return shape.parts.map(([mesh, tint]) =>
        add(this.meshes[mesh], tint && !isGhost ? tint : [...(tint ?? color).slice(0, 3), color[3]]),
      );
    }
    if (shape.kind === "plane") {
      const { positions, indices } = square(FLOOR_SIZE);
      return [add(creased(positions, indices, 0), [...color.slice(0, 3), 1], { grid: 1, castsShadow: false })];
    }
    const { positions, indices } = primitive(shape);
    return [add(creased(positions, indices, CREASE.shape), color)];
  }
}
