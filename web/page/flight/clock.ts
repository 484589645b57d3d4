// The time of the replay. Whoever draws listens to it: the view and the plots show the same instant.

type Listener = (time: number) => void;

export class Clock {
  time = 0;
  /** s, when the longest flight ends. */
  end = 0;
  /** Seconds of flight in a second. */
  speed = 1;
  playing = false;
  private readonly listeners: Listener[] = [];
  private last = 0;

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  set(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.tell();
  }

  play(): void {
    if (this.playing) return;
    if (this.time >= this.end) this.time = 0;
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame(this.step);
    this.tell();
  }

  pause(): void {
    this.playing = false;
    this.tell();
  }

  private readonly step = (now: number) => {
    if (!this.playing) return;
    const passed = Math.max(0, now - this.last) / 1000;
    this.last = now;
    this.time = Math.min(this.time + passed * this.speed, this.end);
    if (this.time >= this.end) this.playing = false;
    else requestAnimationFrame(this.step);
    this.tell();
  };

  private tell(): void {
    for (const listener of this.listeners) listener(this.time);
  }
}
