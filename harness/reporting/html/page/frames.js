// Draws when something has changed, and while time passes.

/** @param {import("./clock.js").Clock} clock @param {any} scene null where there is none */
export function keepDrawing(clock, scene) {
  let isFrameDue = false;
  function requestFrame() {
    if (isFrameDue) return;
    isFrameDue = true;
    requestAnimationFrame((now) => {
      isFrameDue = false;
      clock.tick(now);
      scene?.viewer.draw(scene.orbit, clock.isPlaying || scene.orbit.isHeld);
      if (clock.isPlaying) requestFrame();
    });
  }
  clock.onPlay(requestFrame);
  if (scene) scene.viewer.onChange = requestFrame;
  requestFrame();
  window.readyAfter = performance.now(); // [ms] since the page was requested
  document.documentElement.dataset.ready = "yes";
}
