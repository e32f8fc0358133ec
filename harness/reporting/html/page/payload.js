// The data that the page carries: gzip in base64; inside, a JSON head and named buffers.

/**
 * @typedef {object} Payload
 * @property {Run} run what the page shows
 * @property {(name: string) => ArrayBuffer} buffer bytes by name
 */

/** @param {HTMLElement} element holds the text; it is emptied @returns {Promise<Payload>} */
export async function unpack(element) {
  const packed = Uint8Array.from(atob(element.textContent.trim()), (char) => char.charCodeAt(0));
  element.remove();
  const unzipped = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = await new Response(unzipped).arrayBuffer();
  const headLength = new DataView(bytes).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, headLength)), withSigns);
  const start = 4 + headLength;
  return {
    run: head.run,
    buffer(name) {
      const [offset, length] = head.buffers[name];
      return bytes.slice(start + offset, start + offset + length);
    },
  };
}

const WRITTEN = ["source", "before", "after", "file", "case"]; // lines of files, which stay as they are

/** Sentences with the degree sign of tables and plots. */
function withSigns(key, value) {
  return typeof value === "string" && !WRITTEN.includes(key) ? value.replace(/(?<=[\d)]) deg\b/g, "°") : value;
}

/**
 * Columns of 16-bit numbers stored as differences down each column, modulo 65536.
 * @param {ArrayBuffer} bytes @param {number} rows @returns {Int16Array}
 */
export function undoDifferences(bytes, rows) {
  const values = new Int16Array(bytes);
  for (let start = 0; start < values.length; start += rows) {
    for (let row = start + 1; row < start + rows; row++) values[row] += values[row - 1];
  }
  return values;
}

/** Signed numbers stored as zigzag differences. @param {Uint16Array | Uint32Array} stored @returns {Uint32Array} */
export function undoZigzag(stored) {
  const values = new Uint32Array(stored.length);
  let last = 0;
  for (let i = 0; i < stored.length; i++) {
    last += (stored[i] >>> 1) ^ -(stored[i] & 1);
    values[i] = last;
  }
  return values;
}

/**
 * A mesh whose coordinates are 16-bit fractions of its bounds.
 * @param {Payload} payload @param {MeshHead} head @returns {{positions: Float32Array, indices: Uint32Array}}
 */
export function decodeMesh(payload, head) {
  const stored = new Uint16Array(payload.buffer(head.vertices));
  const count = stored.length / 3;
  const positions = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; axis++) {
    let value = 0;
    for (let i = 0; i < count; i++) {
      value = (value + stored[axis * count + i]) & 65535;
      positions[3 * i + axis] = head.low[axis] + (value / 65535) * head.size[axis];
    }
  }
  const bytes = payload.buffer(head.faces);
  return { positions, indices: undoZigzag(head.wide ? new Uint32Array(bytes) : new Uint16Array(bytes)) };
}

/**
 * @typedef {object} Series one drawn line: recorded samples, none of the extremes left out
 * @property {string} name
 * @property {Float64Array} times
 * @property {Float32Array} values NaN where there is none
 * @property {number} low the lowest of them @property {number} high the highest
 */

const MISSING = 65535;

/** The series of a plot group. @param {Payload} payload @param {GroupHead} group @returns {Series[]} */
export function decodeGroup(payload, group) {
  const { points, bin, timestep, start } = group;
  const offsets = undoDifferences(payload.buffer(`${group.id}.offsets`), points);
  const values = undoDifferences(payload.buffer(`${group.id}.values`), points);
  return group.series.map((head, number) => {
    const times = new Float64Array(points);
    const decoded = new Float32Array(points);
    for (let i = 0; i < points; i++) {
      const at = number * points + i;
      times[i] = start + timestep * ((i >> 1) * bin + (offsets[at] & 65535));
      const stored = values[at] & 65535;
      decoded[i] = stored === MISSING ? NaN : head.low + (stored / (MISSING - 1)) * head.size;
    }
    return { name: head.name, times, values: decoded, low: head.low, high: head.low + head.size };
  });
}

/** Where in sorted times a time falls: the first index whose time is not before it. @param {ArrayLike<number>} times @param {number} time */
export function indexAt(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Value of a series at a time, between its samples; NaN where there is none. @param {Series} series @param {number} time */
export function valueAt(series, time) {
  const after = indexAt(series.times, time);
  const before = Math.max(0, after - 1);
  const [t0, t1] = [series.times[before], series.times[after]];
  const [v0, v1] = [series.values[before], series.values[after]];
  if (Number.isNaN(v0)) return v1;
  if (Number.isNaN(v1) || t1 <= t0 || time >= t1) return time < t1 ? v0 : v1;
  return v0 + ((v1 - v0) * Math.max(0, time - t0)) / (t1 - t0);
}
