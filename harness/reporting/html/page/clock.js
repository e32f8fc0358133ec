// The one time that everything on the page follows.

const SHORTEST = 1e-3; // [s]: one sample

export class Clock {
  /** @param {number} duration of the run [s] */
  constructor(duration) {
    this.duration = duration;
    this.time = 0;
    this.speed = 1;
    this.isPlaying = false;
    /** The stretch that timeline and plots show [s]. */
    this.span = { from: 0, to: Math.max(duration, SHORTEST) };
    /** @type {((span: {from: number, to: number}) => void)[]} */
    this.spanListeners = [];
    /** @type {((time: number) => void)[]} */
    this.timeListeners = [];
    /** @type {((isPlaying: boolean) => void)[]} */
    this.playListeners = [];
  }

  /** @param {(time: number) => void} listener called with every new time, and now */
  onTime(listener) {
    this.timeListeners.push(listener);
    listener(this.time);
  }

  /** @param {(isPlaying: boolean) => void} listener called when it starts, stops or changes speed */
  onPlay(listener) {
    this.playListeners.push(listener);
  }

  /** Go to a time and stay there. @param {number} time [s] */
  seek(time) {
    this.pause();
    this.#set(time);
  }

  /** @param {(span: {from: number, to: number}) => void} listener called with every new stretch, and now */
  onSpan(listener) {
    this.spanListeners.push(listener);
    listener(this.span);
  }

  /** Whether all of the run is shown. */
  get isWhole() {
    return this.span.to - this.span.from >= Math.max(this.duration, SHORTEST) - 1e-9;
  }

  /** Show a stretch of the run. @param {number} [from] @param {number} [to] [s]; the whole run without them */
  show(from = 0, to = Infinity) {
    const end = Math.max(this.duration, SHORTEST);
    const length = Math.max(SHORTEST, Math.min(end, to - from));
    const start = Math.max(0, Math.min(end - length, from));
    this.span = { from: start, to: start + length };
    for (const listener of this.spanListeners) listener(this.span);
  }

  /** Show more or less around a time, which stays where it is. @param {number} factor above 1 shows more @param {number} [around] [s] */
  zoom(factor, around = this.time) {
    const { from, to } = this.span;
    const center = Math.max(from, Math.min(to, around));
    this.show(center - (center - from) * factor, center + (to - center) * factor);
  }

  /** Show an earlier or later stretch. @param {number} share of what is shown */
  pan(share) {
    const { from, to } = this.span;
    this.show(from + share * (to - from), to + share * (to - from));
  }

  toggle() {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  play() {
    if (this.duration <= 0) return;
    if (this.time >= this.duration - 1e-6) this.#set(0);
    this.isPlaying = true;
    this.last = performance.now();
    this.#reportPlaying();
  }

  pause() {
    if (!this.isPlaying) return;
    this.isPlaying = false;
    this.#reportPlaying();
  }

  /** @param {number} speed 1 is real time */
  setSpeed(speed) {
    this.speed = speed;
    this.#reportPlaying();
  }

  /** Move on by the time that has passed. @param {number} now [ms] */
  tick(now) {
    if (!this.isPlaying) return;
    this.#set(this.time + (Math.max(0, now - this.last) / 1000) * this.speed);
    this.last = now;
    if (this.time >= this.duration) this.pause();
  }

  #set(time) {
    this.time = Math.max(0, Math.min(this.duration, Number.isFinite(time) ? time : 0));
    for (const listener of this.timeListeners) listener(this.time);
  }

  #reportPlaying() {
    for (const listener of this.playListeners) listener(this.isPlaying);
  }
}
