// All plots of a flight. They share their range of time and their cursor, which is the time of the replay.

import "uplot/dist/uPlot.min.css";
import type { FlightAnswer } from "../api";
import { element } from "../dom";
import type { Clock } from "../flight/clock";
import { Chart } from "./chart";
import { plans } from "./plans";

export class Plots {
  private readonly place = element("plots", HTMLElement);
  private readonly choice = element("window", HTMLSelectElement);
  private readonly seen = new Set<Element>();
  private readonly watch = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) this.seen[isIntersecting ? "add" : "delete"](target);
    this.follow(this.clock.time);
  });
  private charts: Chart[] = [];

  constructor(private readonly clock: Clock) {
    clock.listen((time) => this.follow(time));
    this.choice.addEventListener("change", () => this.showWindow());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const chart of this.charts) chart.redraw();
    });
    new ResizeObserver(() => {
      const width = this.width();
      for (const chart of this.charts) chart.resize(width);
      this.follow(this.clock.time);
    }).observe(this.place);
  }

  show(answer: FlightAnswer): void {
    // The height stays while old plots go and new ones come.
    this.place.style.minBlockSize = `${this.place.offsetHeight}px`;
    this.watch.disconnect();
    this.seen.clear();
    for (const chart of this.charts) chart.destroy();
    this.place.replaceChildren();
    const width = this.width();
    this.charts = plans(answer).map((plan) => new Chart(plan, width, (time, pressed) => this.choose(time, pressed)));
    this.place.append(...this.charts.map(({ figure }) => figure));
    for (const { figure } of this.charts) this.watch.observe(figure);
    this.place.style.minBlockSize = "";
    this.showWindow();
  }

  /** While the flight plays, a mouse that passes over a plot does not stop it. */
  private choose(time: number, pressed: boolean): void {
    if (this.clock.playing && !pressed) return;
    if (this.clock.playing) this.clock.pause();
    this.clock.set(time);
  }

  private showWindow(): void {
    const end = Number(this.choice.value) || this.clock.end;
    for (const chart of this.charts) chart.window(Math.min(end, this.clock.end));
    this.follow(this.clock.time);
  }

  /** Only plots that are on the screen move their cursor. */
  private follow(time: number): void {
    for (const chart of this.charts) {
      if (this.seen.has(chart.figure)) chart.cursor(time);
    }
  }

  /** The width of a column of the grid, CSS pixels. */
  private width(): number {
    const style = getComputedStyle(this.place);
    const columns = style.gridTemplateColumns.split(" ");
    return Math.floor(parseFloat(columns[0] ?? "") || this.place.clientWidth);
  }
}
