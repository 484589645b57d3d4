// One plot: lines over time, limits and proven bounds across it, and a cursor at the time of the replay.

import uPlot from "uplot";
import { make } from "../dom";
import { colour } from "../flight/view";
import { quantity, short } from "../numbers";
import type { Bound, Plan } from "./plans";

/** CSS pixels. */
const HEIGHT = 150;
const AXIS_WIDTH = 62;
const AXIS_HEIGHT = 30;
const LINE_WIDTH = 2;

const DASHES = [7, 4];
const BOUND_DASHES: Record<Bound["kind"], number[]> = { limit: [], proven: [2, 3] };

/** A bound so many times beyond the values is not drawn: the lines would be flat. The words still say it. */
const FAR = 3;

/** Of the range of values, above and below them. */
const ROOM = 0.08;

/** Of the greatest value: less is written as zero. */
const NOTHING = 1e-4;

const FONT = "11px system-ui, sans-serif";

/** The reader pressed the plot at this time, or only points at it. */
type Choose = (time: number, pressed: boolean) => void;

export class Chart {
  readonly figure: HTMLElement;
  private readonly plot: uPlot;
  private readonly place = make("div", { class: "plot" });

  constructor(private readonly plan: Plan, width: number, choose: Choose) {
    const head = make("figcaption", {}, make("strong", {}, plan.title), `, ${plan.unit} `);
    if (plan.words) head.append(make("span", { class: "bounds" }, plan.words));
    this.figure = make("figure", {}, head, this.place);
    this.place.setAttribute("role", "img");
    this.place.setAttribute("aria-label", summary(plan));
    this.plot = new uPlot(this.options(width), [plan.times, ...plan.lines.map(({ values }) => values)], this.place);
    this.plot.ctx.canvas.setAttribute("aria-hidden", "true");
    const pick = (event: PointerEvent) => {
      const { left } = this.plot.over.getBoundingClientRect();
      choose(this.plot.posToVal(event.clientX - left, "x"), event.buttons > 0);
    };
    this.plot.over.addEventListener("pointerdown", pick);
    this.plot.over.addEventListener("pointermove", pick);
  }

  /** Moves the cursor, and shows the values there in the legend. */
  cursor(time: number): void {
    this.plot.setCursor({ left: this.plot.valToPos(time, "x"), top: 0 }, false);
  }

  /** Shows the first seconds, or everything. */
  window(end: number): void {
    this.plot.setScale("x", { min: this.plan.times[0] ?? 0, max: end });
  }

  resize(width: number): void {
    this.plot.setSize({ width, height: HEIGHT });
  }

  /** Takes the colours anew. */
  redraw(): void {
    this.plot.redraw(false, true);
  }

  destroy(): void {
    this.plot.destroy();
  }

  private options(width: number): uPlot.Options {
    const { plan } = this;
    const ink = () => colour("--quiet");
    const nothing = NOTHING * greatest(plan);
    const grid = { stroke: () => colour("--line"), width: 1 };
    const axis = { stroke: ink, grid, ticks: { show: false }, font: FONT };
    return {
      width,
      height: HEIGHT,
      padding: [8, 16, 0, 0],
      cursor: {
        y: false,
        points: { size: 6 },
        drag: { x: false, y: false },
        bind: { mousedown: () => null, mousemove: () => null, mouseleave: () => null, dblclick: () => null },
      },
      scales: { x: { time: false }, y: { range: () => range(plan) } },
      axes: [
        { ...axis, size: AXIS_HEIGHT, values: (_, splits) => splits.map((value) => `${short(value)} s`) },
        { ...axis, size: AXIS_WIDTH, values: (_, splits) => splits.map((value) => quantity(value, plan.unit)) },
      ],
      legend: { markers: { dash: (_, i) => (plan.lines[i - 1]?.dashed ? "dashed" : "solid") } },
      series: [
        { label: "time", value: (_, value) => (value === null ? "" : `${value.toFixed(2)} s`) },
        ...plan.lines.map((line) => ({
          label: line.label,
          stroke: () => colour(line.colour),
          width: LINE_WIDTH,
          ...(line.dashed && { dash: DASHES }),
          points: { show: false },
          value: (_: uPlot, value: number | null) => {
            if (value === null) return "–";
            return quantity(Math.abs(value) < nothing ? 0 : value, plan.unit);
          },
        })),
      ],
      hooks: { drawAxes: [(plot) => drawBounds(plot, plan)] },
    };
  }
}

/** From the least to the greatest value, with the bounds that are not far beyond. */
function range({ lines, bounds, within }: Plan): [number, number] {
  let [least, most] = within;
  for (const { values } of lines) {
    for (const value of values) {
      if (value === null) continue;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  const reach = FAR * Math.max(Math.abs(least), Math.abs(most));
  for (const { value } of bounds) {
    if (Math.abs(value) > reach) continue;
    least = Math.min(least, value);
    most = Math.max(most, value);
  }
  const room = ROOM * (most - least || 1);
  return [least < 0 ? least - room : least, most + room];
}

function greatest({ lines }: Plan): number {
  return lines.reduce((most, { values }) => values.reduce<number>((a, b) => Math.max(a, Math.abs(b ?? 0)), most), 0);
}

/** Draws every bound as a line of its own pattern, named where it begins. */
function drawBounds(plot: uPlot, { bounds }: Plan): void {
  const { ctx, bbox } = plot;
  const [least, most] = [plot.scales["y"]?.min ?? 0, plot.scales["y"]?.max ?? 0];
  ctx.save();
  ctx.lineWidth = devicePixelRatio;
  for (const { value, kind } of bounds) {
    if (value < least || value > most) continue;
    const y = Math.round(plot.valToPos(value, "y", true));
    ctx.strokeStyle = colour(kind === "limit" ? "--limit" : "--proven");
    ctx.setLineDash(BOUND_DASHES[kind].map((length) => length * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  }
  ctx.restore();
}

/** What a plot shows, for whoever does not see it. */
function summary({ title, unit, lines, words }: Plan): string {
  const each = lines.map(({ label, values }) => {
    const known = values.filter((value) => value !== null);
    const least = known.reduce((a, b) => Math.min(a, b), Infinity);
    const most = known.reduce((a, b) => Math.max(a, b), -Infinity);
    return `${label}: from ${short(least)} to ${short(most)}, at the end ${short(known.at(-1) ?? 0)}`;
  });
  return `${title} over time, ${unit}. ${each.join(". ")}.${words ? ` Bounds: ${words}.` : ""}`;
}
