// The ground below a flight: a grid in metres, and the names of its lines.

import { BufferGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Vector3 } from "three";

/** About so many squares across the flight. */
const SQUARES = 8;

/** m: no grid is finer. */
const FINEST = 0.5;

/** A name every so many lines, so that about five stand along an edge. */
const NAMED = 5;

export class Ground extends Group {
  /** m, the side of a square. */
  readonly square: number;
  /** m, its height. */
  readonly height: number;
  readonly names: { text: string; at: Vector3 }[] = [];

  constructor(least: Vector3, most: Vector3, colour: string) {
    super();
    const across = Math.max(most.x - least.x, most.y - least.y, most.z - least.z);
    this.square = nice(across / SQUARES);
    this.height = least.z >= 0 ? 0 : Math.floor(least.z / this.square) * this.square;
    const [left, right] = this.span(least.x, most.x);
    const [near, far] = this.span(least.y, most.y);
    const points: number[] = [];
    for (let i = left; i <= right; i += 1) points.push(...this.at(i, near), ...this.at(i, far));
    for (let j = near; j <= far; j += 1) points.push(...this.at(left, j), ...this.at(right, j));
    const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3));
    this.add(new LineSegments(geometry, new LineBasicMaterial({ color: colour })));
    this.nameLines(left, right, "x", (i) => this.at(i, near - 0.5));
    this.nameLines(near, far, "y", (j) => this.at(left - 0.5, j));
  }

  /** From and to which line, with room around the flight. */
  private span(from: number, to: number): [number, number] {
    return [Math.floor(from / this.square) - 1, Math.ceil(to / this.square) + 1];
  }

  private at(i: number, j: number): [number, number, number] {
    return [i * this.square, j * this.square, this.height];
  }

  private nameLines(from: number, to: number, axis: string, place: (i: number) => [number, number, number]): void {
    const stride = Math.max(1, Math.ceil((to - from) / NAMED));
    for (let i = Math.ceil(from / stride) * stride; i <= to; i += stride) {
      const metres = Number((i * this.square).toPrecision(6));
      this.names.push({ text: `${axis} ${String(metres).replace("-", "−")} m`, at: new Vector3(...place(i)) });
    }
  }
}

/** The next of 0.5, 1, 2, 5, 10, 20, … m. */
function nice(length: number): number {
  let step = FINEST;
  for (const factors = [2, 2, 2.5]; step < length; step *= factors[0] ?? 2) factors.push(factors.shift() ?? 2);
  return step;
}
