// The flight seen from the side, in two dimensions, for browsers without WebGL.

import { make } from "../dom";
import { LAWS } from "./figures";
import { bodyZ, poseAt, tickAt, type Triple } from "./pose";
import { colour, extent, type Shown, type View } from "./view";

/** CSS pixels. */
const MARGIN = 36;
const HALF_VEHICLE = 14;
const ARROW = 26;
const TRAIL_WIDTH = 2;
const NAME_BELOW = { ours: 22, indi: -14 };

/** m: a flight that stays in one place is seen this wide. */
const LEAST_WIDTH = 1.5;
const FOLLOWED_WIDTH = 2;

export class SideView implements View {
  private readonly canvas = make("canvas", { role: "img", "aria-label": "The flight from the side, x and z" });
  private shown: Shown | null = null;
  private following = false;
  private time = 0;
  private scale = 1;
  private middle: Triple = [0, 0, 0];

  constructor(private readonly place: HTMLElement) {
    place.replaceChildren(this.canvas);
    new ResizeObserver(() => this.draw(this.time)).observe(place);
  }

  show(shown: Shown): void {
    this.shown = shown;
  }

  follow(on: boolean): void {
    this.following = on;
    this.draw(this.time);
  }

  draw(time: number): void {
    this.time = time;
    const context = this.canvas.getContext("2d");
    if (this.shown === null || context === null) return;
    const [width, height] = [this.place.clientWidth, this.place.clientHeight];
    this.canvas.width = width * devicePixelRatio;
    this.canvas.height = height * devicePixelRatio;
    context.scale(devicePixelRatio, devicePixelRatio);
    this.frame(this.shown, width, height);
    context.fillStyle = colour("--sky");
    context.fillRect(0, 0, width, height);
    this.metres(context, width, height);
    this.path(context, this.shown.answer.reference, colour("--reference"));
    for (const flown of this.shown.answer.flights) {
      const tint = colour(`--${flown.law}`);
      this.path(context, flown.position.slice(0, Math.ceil(tickAt(flown.t, time)) + 1), tint);
      const { position, attitude } = poseAt(flown, time);
      this.vehicle(context, position, bodyZ(attitude), tint, LAWS[flown.law], NAME_BELOW[flown.law]);
    }
  }

  private frame(shown: Shown, width: number, height: number): void {
    const { least, most } = extent(shown);
    const across = this.following ? FOLLOWED_WIDTH : Math.max(most[0] - least[0], LEAST_WIDTH);
    const up = this.following ? FOLLOWED_WIDTH : Math.max(most[2] - least[2], LEAST_WIDTH);
    this.scale = Math.min((width - 2 * MARGIN) / across, (height - 2 * MARGIN) / up);
    const first = shown.answer.flights[0];
    this.middle = this.following && first
      ? poseAt(first, this.time).position
      : [(least[0] + most[0]) / 2, 0, (least[2] + most[2]) / 2];
  }

  private at([x, , z]: Triple): [number, number] {
    const [width, height] = [this.place.clientWidth, this.place.clientHeight];
    return [width / 2 + (x - this.middle[0]) * this.scale, height / 2 - (z - this.middle[2]) * this.scale];
  }

  /** Lines of whole metres, and their heights. */
  private metres(context: CanvasRenderingContext2D, width: number, height: number): void {
    const step = Math.max(1, 10 ** Math.ceil(Math.log10(height / this.scale / 8)));
    context.strokeStyle = colour("--grid");
    context.fillStyle = colour("--quiet");
    context.font = "11px system-ui, sans-serif";
    context.beginPath();
    const from = Math.ceil((this.middle[2] - height / 2 / this.scale) / step) * step;
    for (let z = from; this.at([0, 0, z])[1] > 0; z += step) {
      const y = this.at([0, 0, z])[1];
      context.moveTo(0, y);
      context.lineTo(width, y);
      context.fillText(`z ${z} m`, 4, y - 3);
    }
    context.stroke();
  }

  private path(context: CanvasRenderingContext2D, points: Triple[], stroke: string): void {
    context.strokeStyle = stroke;
    context.lineWidth = TRAIL_WIDTH;
    context.beginPath();
    for (const point of points) context.lineTo(...this.at(point));
    context.stroke();
  }

  /** A line across the body's z axis, and an arrow along it. */
  private vehicle(
    context: CanvasRenderingContext2D, position: Triple, z: Triple, tint: string, name: string, below: number,
  ): void {
    const [x, y] = this.at(position);
    const [across, up] = [z[0], -z[2]];
    context.strokeStyle = tint;
    context.fillStyle = tint;
    context.lineWidth = 4;
    context.beginPath();
    context.moveTo(x - HALF_VEHICLE * up, y + HALF_VEHICLE * across);
    context.lineTo(x + HALF_VEHICLE * up, y - HALF_VEHICLE * across);
    context.stroke();
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + ARROW * across, y + ARROW * up);
    context.stroke();
    context.fillText(name, x + HALF_VEHICLE + 4, y + below);
  }
}
