// Camera images and videos, shown at the moment they were taken. When the browser's graphics process
// ended, canvases come back empty (`contextrestored`) and are drawn again.

import { byId, element } from "./dom.js";
import { indexAt } from "./payload.js";
import { seconds } from "./units.js";

/**
 * @typedef {object} CameraHead
 * @property {string} name
 * @property {string} note what rendered it
 * @property {{buffer: string, type: string, start: number} | null} video
 * @property {{time: number, buffer: string, type: string, label: string}[]} images
 */

/**
 * @param {import("./payload.js").Payload} payload
 * @param {import("./clock.js").Clock} clock
 * @returns {boolean} whether there is anything to show
 */
export function makePictures(payload, clock) {
  const cameras = payload.run.cameras;
  const place = byId("cameras");
  place.style.setProperty("--count", String(cameras.length));
  for (const camera of cameras) place.append(cameraView(payload, clock, camera));
  return cameras.length > 0;
}

function cameraView(payload, clock, camera) {
  const canvas = element("canvas", { width: 320, height: 240, role: "img", "aria-label": `Camera ${camera.name}` });
  const caption = element("figcaption", {}, camera.name);
  if (camera.video) followVideo(payload, clock, camera.video, canvas);
  else followImages(payload, clock, camera, canvas, caption);
  const button = element("button", { type: "button", "aria-pressed": false, title: "Enlarge", "aria-label": `Enlarge camera ${camera.name}` }, canvas);
  const figure = element("figure.camera", { title: camera.note }, button, caption);
  button.addEventListener("click", () => button.setAttribute("aria-pressed", String(figure.classList.toggle("large"))));
  return figure;
}

/** A video is drawn to a canvas: laid over WebGL it leaves holes where compositing is in software. */
function followVideo(payload, clock, { buffer, type, start }, canvas) {
  const video = element("video", { preload: "auto", playsinline: "" });
  video.muted = true;
  video.src = URL.createObjectURL(new Blob([payload.buffer(buffer)], { type }));
  const draw = () => fit(canvas, video, video.videoWidth, video.videoHeight);
  for (const event of ["loadeddata", "seeked", "timeupdate"]) video.addEventListener(event, draw);
  canvas.addEventListener("contextrestored", draw);
  if (video.requestVideoFrameCallback) {
    const again = () => {
      draw();
      video.requestVideoFrameCallback(again);
    };
    video.requestVideoFrameCallback(again);
  }
  const follow = () => {
    const videoTime = Math.max(0, clock.time - start);
    if (Math.abs(video.currentTime - videoTime) > (clock.isPlaying ? 0.25 : 0.02)) video.currentTime = videoTime;
  };
  clock.onTime(follow);
  clock.onPlay((isPlaying) => {
    video.playbackRate = Math.max(0.1, Math.min(16, clock.speed));
    if (isPlaying) video.play().catch(() => {});
    else video.pause();
    follow();
  });
}

function followImages(payload, clock, camera, canvas, caption) {
  const times = camera.images.map(({ time }) => time);
  const pictures = camera.images.map(({ buffer, type }) => {
    const image = new Image();
    image.src = URL.createObjectURL(new Blob([payload.buffer(buffer)], { type }));
    image.addEventListener("load", () => show());
    return image;
  });
  let shown = -2; // index of a picture; -1 before the first is taken
  const show = () => {
    let index = indexAt(times, clock.time);
    if (times[index] > clock.time + 1e-6) index = Math.max(0, index - 1);
    const isTaken = times[index] <= clock.time + 1e-6;
    const place = isTaken ? index : -1;
    const picture = pictures[index];
    if (!picture?.complete || shown === place) return;
    shown = place;
    fit(canvas, picture, picture.naturalWidth, picture.naturalHeight);
    canvas.classList.toggle("not-yet", !isTaken);
    const label = isTaken ? camera.images[index].label : `not before ${seconds(times[index])}`;
    caption.textContent = [camera.name, label].filter(Boolean).join(" · ");
  };
  canvas.addEventListener("contextrestored", () => {
    shown = -2;
    show();
  });
  clock.onTime(show);
}

function fit(canvas, source, width, height) {
  if (!width || !height) return;
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  canvas.getContext("2d").drawImage(source, 0, 0, width, height);
}
