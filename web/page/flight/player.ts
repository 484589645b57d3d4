// The controls of the replay's time: play, pause, a slider, speed.

import { element } from "../dom";
import type { Clock } from "./clock";

export class Player {
  private readonly button = element("play", HTMLButtonElement);
  private readonly slider = element("time", HTMLInputElement);
  private readonly said = element("time-said", HTMLOutputElement);

  constructor(private readonly clock: Clock) {
    const speed = element("speed", HTMLSelectElement);
    this.button.addEventListener("click", () => (clock.playing ? clock.pause() : clock.play()));
    this.slider.addEventListener("input", () => {
      const chosen = Number(this.slider.value);
      clock.pause();
      clock.set(chosen);
    });
    speed.addEventListener("change", () => (clock.speed = Number(speed.value)));
    clock.listen((time) => this.show(time));
  }

  /** A flight of this length is shown; it begins to play unless the reader wants no motion. */
  begin(end: number): void {
    const { clock } = this;
    clock.end = end;
    this.slider.max = String(end);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (clock.time >= end) clock.time = 0;
    if (calm || clock.playing) clock.set(clock.time);
    else clock.play();
  }

  private show(time: number): void {
    this.button.textContent = this.clock.playing ? "Pause" : "Play";
    this.slider.value = String(time);
    const words = `${time.toFixed(2)} s`;
    this.slider.setAttribute("aria-valuetext", words);
    this.said.value = words;
  }
}
