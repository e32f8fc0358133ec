// Pointer, wheel and keys of the 3D view.

import { placeOf } from "./orbit.js";

const CLICK = 4; // pixels within which a press is no drag

/**
 * @param {HTMLCanvasElement} canvas @param {import("./orbit.js").Orbit} orbit
 * @param {(x: number, y: number) => void} onClick gets CSS pixels from the left top
 */
export function controlOrbit(canvas, orbit, onClick) {
  const pointers = new Map();
  let [spread, travelled] = [0, 0];
  canvas.style.touchAction = "none";
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => orbit.look("iso"));
  canvas.addEventListener("pointerdown", (event) => {
    if (!pointers.size) travelled = 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    orbit.isHeld = true;
    canvas.setPointerCapture(event.pointerId);
  });
  const release = (event) => {
    pointers.delete(event.pointerId);
    orbit.isHeld = pointers.size > 0;
    spread = 0;
    if (event.type === "pointerup" && travelled < CLICK && event.button === 0) onClick(event.offsetX, event.offsetY);
    orbit.changed();
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const [right, down] = [event.clientX - last[0], event.clientY - last[1]];
    travelled += Math.abs(right) + Math.abs(down);
    if (travelled < CLICK && pointers.size === 1) return;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()];
      const distance = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (spread > 0) orbit.zoom(spread / distance);
      spread = distance;
      orbit.pan(right / 2, down / 2, canvas.clientHeight);
    } else if (event.buttons === 2 || event.shiftKey) {
      orbit.pan(right, down, canvas.clientHeight);
    } else {
      orbit.turn(right, down);
    }
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      orbit.zoom(Math.exp(event.deltaY * 0.001), placeOf(canvas, event));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] };
    if (turns[event.key]) orbit.turn(...turns[event.key]);
    else if (event.key === "+") orbit.zoom(0.9);
    else if (event.key === "-") orbit.zoom(1.1);
    else if (event.key === "Enter") onClick(canvas.clientWidth / 2, canvas.clientHeight / 2);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}
