// Keys that work wherever the focus is, unless it is in a control that uses them.

import { byId } from "./dom.js";

const FRAME = 0.02; // [s]

/**
 * @param {import("./clock.js").Clock} clock
 * @param {{nextStep: (direction: number) => void, nextFailure: () => void}} actions
 */
export function listenToKeys(clock, actions) {
  const help = byId("help");
  const keys = {
    " ": () => clock.toggle(),
    k: () => clock.toggle(),
    ArrowLeft: (event) => clock.seek(clock.time - (event.shiftKey ? 1 : FRAME)),
    ArrowRight: (event) => clock.seek(clock.time + (event.shiftKey ? 1 : FRAME)),
    Home: () => clock.seek(0),
    End: () => clock.seek(clock.duration),
    "[": () => actions.nextStep(-1),
    "]": () => actions.nextStep(1),
    n: () => actions.nextFailure(),
    "?": () => (help.open ? help.close() : help.showModal()),
  };
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (target instanceof HTMLSelectElement || target instanceof HTMLInputElement) return;
    if (event.key === " " && target instanceof HTMLButtonElement) return;
    const action = keys[event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
