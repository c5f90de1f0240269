// Where playing stands. Frame k is shown from k / rate until (k + 1) / rate.

export class PlayClock {
  constructor() {
    this.frames = 1;
    this.rate = 30;
    this.time = 0;
    this.speed = 1;
    this.isLooping = true;
    this.isPlaying = false;
  }

  get duration() {
    return this.frames / this.rate;
  }

  get frame() {
    // A little more, so that 37 / 30 * 30 is frame 37 and not 36.
    return Math.min(Math.floor(this.time * this.rate + 1e-6), this.frames - 1);
  }

  /** Go to a time, s, kept within the motion. */
  seek(time) {
    this.time = Math.min(Math.max(time, 0), (this.frames - 1) / this.rate);
  }

  seekFrame(frame) {
    this.seek(frame / this.rate);
  }

  /** Let real seconds pass; gives whether playing came to its end. */
  advance(seconds) {
    this.time += seconds * this.speed;
    if (this.time < this.duration) return false;
    if (this.isLooping) {
      this.time %= this.duration;
      return false;
    }
    this.seekFrame(this.frames - 1);
    this.isPlaying = false;
    return true;
  }
}
