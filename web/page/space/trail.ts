// A path in space: all of it, or as much as has been flown.

import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { Vector3 } from "three";
import { tickAt, type Triple } from "../flight/pose";

/** A path has no more points than this; more would not be seen. */
const GREATEST_POINTS = 1500;

export class Trail extends Line2 {
  private readonly segments: number;

  /** `width` in CSS pixels. */
  constructor(path: Triple[], colour: string, width: number) {
    const stride = Math.max(1, Math.ceil(path.length / GREATEST_POINTS));
    const kept = path.filter((_, i) => i % stride === 0 || i === path.length - 1);
    // A line needs two points, and a path that stands still is a point.
    const points = kept.length > 1 ? kept : [...kept, ...kept];
    const geometry = new LineGeometry();
    geometry.setFromPoints(points.map((point) => new Vector3(...point)));
    super(geometry, new LineMaterial({ color: colour, linewidth: width }));
    this.segments = points.length - 1;
    this.frustumCulled = false;
  }

  /** Shows what has been flown by `time`. */
  until(t: number[], time: number): void {
    const part = tickAt(t, time) / Math.max(1, t.length - 1);
    this.geometry.instanceCount = Math.ceil(part * this.segments);
  }
}
