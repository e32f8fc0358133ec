// The one time that everything on the page follows.

export class Clock {
  /** @param {number} duration of the run [s] */
  constructor(duration) {
    this.duration = duration;
    this.time = 0;
    this.speed = 1;
    this.isPlaying = false;
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
