// The recorded bodies in the 3D view, posed at any time.

import { CREASE, surfacesOf } from "./bodies.js";
import { creased } from "./normals.js";
import { decodeMesh } from "./payload.js";
import { Poses } from "./poses.js";
import { multiply, poseMatrix } from "./vectors.js";

export class Replay {
  /** @param {import("./payload.js").Payload} payload @param {import("./viewer.js").Viewer} viewer */
  constructor(payload, viewer) {
    this.viewer = viewer;
    this.run = payload.run;
    this.poses = new Poses(payload);
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
      body.isThere = body.shown.some(([from, to]) => time >= from && time <= to);
      const isShown = body.isThere && this.isShown(body);
      for (const { surface, local } of body.pieces) {
        surface.model = multiply(matrix, local);
        surface.visible = isShown;
      }
      for (const { surface, local } of this.hulls?.get(body) ?? []) {
        surface.model = multiply(matrix, local);
        surface.visible = isShown && this.showsHulls;
      }
    }
    if (this.showsPlan || this.planCopies) this.#posePlan(time);
    this.viewer.moved();
  }

  /** Draw the shapes that planner and physics collide with over what bodies look like. @param {boolean} isShown @param {number[]} color rgba */
  showHulls(isShown, color) {
    this.showsHulls = isShown;
    const options = { castsShadow: false, isUntouchable: true };
    this.hulls ??= new Map(
      this.bodies.map((body) => [body, body.collisions.flatMap((shape) => surfacesOf(this.viewer, { ...shape, color }, this.meshes, false, options))]),
    );
  }

  /** The robot as it was commanded, at the same time. */
  #posePlan(time) {
    this.planCopies ??= this.#copies([0.55, 0.36, 0.96]);
    this.plan ??= this.poses.commanded();
    for (const { body, copy, local } of this.planCopies) {
      copy.visible = Boolean(this.showsPlan);
      if (this.showsPlan) copy.model = multiply(poseMatrix(this.poses.of(body, time, this.plan)), local);
    }
  }

  /** Which bodies are switched on. */
  isShown(body) {
    return !(body.ghost && this.hidesGhosts);
  }

  /** Pose of a body at a time. @param {any} body @param {number} time [s] */
  poseOf(body, time) {
    return this.poses.of(body, time);
  }

  /** Let bodies that collide glow by how hard they do; all others keep their colour. @param {Map<string, number>} glows 0 to 1 by name */
  glow(glows) {
    for (const body of this.bodies) {
      for (const piece of body.pieces) piece.surface.glow = piece.surface.grid ? 0 : glows.get(body.name) ?? 0;
    }
  }

  /** A translucent robot in another state, next to the recorded one. @param {Record<string, number[]> | null} poses by body; null hides it */
  showState(poses) {
    this.state ??= this.#copies([0.95, 0.55, 0.1]);
    for (const { body, copy, local } of this.state) {
      copy.visible = Boolean(poses?.[body.name]);
      if (copy.visible) copy.model = multiply(poseMatrix(poses[body.name]), local);
    }
    this.viewer.redraw();
  }

  #copies(tint) {
    const tinted = (color) => [...tint.map((value, i) => 0.6 * value + 0.4 * color[i]), 0.6];
    return this.bodies.flatMap((body) =>
      !body.isLink ? [] : body.pieces.map(({ surface, local }) => ({
        body, local,
        copy: this.viewer.addCopy(surface, { color: tinted(surface.color), castsShadow: false, glow: 0, isUntouchable: true }),
      })),
    );
  }

  /** The body that a surface belongs to; null for none. @param {import("./surfaces.js").Surface | null} surface */
  bodyOf(surface) {
    return this.bodies.find(({ pieces }) => pieces.some((piece) => piece.surface === surface)) ?? null;
  }

  /** Colour of the floor: it goes with the theme. @param {number[]} color */
  paintFloor(color) {
    for (const body of this.bodies) {
      for (const piece of body.pieces) if (piece.surface.grid) piece.surface.color = color;
    }
  }

  #build(body) {
    const pieces = body.shapes.flatMap((shape) => surfacesOf(this.viewer, shape, this.meshes, body.ghost));
    return { ...body, pieces, pose: body.fixed, isThere: true };
  }
}
