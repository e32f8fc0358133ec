// Normals that are smooth on curved surfaces and sharp at edges.

const SAME = 1e-3; // difference of normals that is not visible

/**
 * The normal at a corner of a triangle is the mean, weighted by area, of the faces around its vertex
 * that meet its own face at less than the crease angle. Corners of a vertex with the same normal
 * share one vertex of the result.
 *
 * @param {ArrayLike<number>} positions shape (V, 3)
 * @param {ArrayLike<number>} indices corners of triangles
 * @param {number} creaseCosine cosine of the largest angle that is smoothed
 * @returns {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}}
 */
export function creased(positions, indices, creaseCosine) {
  const corners = indices.length;
  const faceNormals = areaNormals(positions, indices);
  const { start, faces } = facesAround(indices, positions.length / 3);
  const made = { positions: new Float32Array(3 * corners), normals: new Float32Array(3 * corners), count: 0 };
  const outIndices = new Uint32Array(corners);
  const newest = new Int32Array(positions.length / 3).fill(-1); // made vertex of each vertex
  const older = new Int32Array(corners); // the one before it, made of the same vertex
  for (let corner = 0; corner < corners; corner++) {
    const vertex = indices[corner];
    const own = 3 * Math.floor(corner / 3);
    const [nx, ny, nz] = [faceNormals[own], faceNormals[own + 1], faceNormals[own + 2]];
    const ownLength = Math.hypot(nx, ny, nz) || 1;
    let [x, y, z] = [0, 0, 0];
    for (let i = start[vertex]; i < start[vertex + 1]; i++) {
      const face = 3 * faces[i];
      const [fx, fy, fz] = [faceNormals[face], faceNormals[face + 1], faceNormals[face + 2]];
      const length = Math.hypot(fx, fy, fz);
      if (fx * nx + fy * ny + fz * nz >= creaseCosine * length * ownLength) {
        x += fx;
        y += fy;
        z += fz;
      }
    }
    const scale = 1 / (Math.hypot(x, y, z) || 1);
    [x, y, z] = [x * scale, y * scale, z * scale];
    let same = newest[vertex];
    while (same >= 0 && !isSame(made.normals, 3 * same, x, y, z)) same = older[same];
    if (same < 0) {
      same = made.count++;
      older[same] = newest[vertex];
      newest[vertex] = same;
      made.normals.set([x, y, z], 3 * same);
      made.positions.set([positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]], 3 * same);
    }
    outIndices[corner] = same;
  }
  const length = 3 * made.count;
  return { positions: made.positions.slice(0, length), normals: made.normals.slice(0, length), indices: outIndices };
}

function isSame(normals, at, x, y, z) {
  return Math.abs(normals[at] - x) + Math.abs(normals[at + 1] - y) + Math.abs(normals[at + 2] - z) < SAME;
}

/** Normals of triangles, as long as twice their area. */
function areaNormals(positions, indices) {
  const normals = new Float32Array(indices.length);
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [3 * indices[i], 3 * indices[i + 1], 3 * indices[i + 2]];
    const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
    const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
    normals[i] = uy * vz - uz * vy;
    normals[i + 1] = uz * vx - ux * vz;
    normals[i + 2] = ux * vy - uy * vx;
  }
  return normals;
}

/** Faces around every vertex: those of vertex v are faces[start[v]] ... faces[start[v + 1] - 1]. */
function facesAround(indices, vertexCount) {
  const start = new Uint32Array(vertexCount + 1);
  for (let i = 0; i < indices.length; i++) start[indices[i] + 1]++;
  for (let v = 0; v < vertexCount; v++) start[v + 1] += start[v];
  const next = start.slice();
  const faces = new Uint32Array(indices.length);
  for (let i = 0; i < indices.length; i++) faces[next[indices[i]]++] = Math.floor(i / 3);
  return { start, faces };
}
