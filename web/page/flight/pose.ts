// Where a flight's vehicle is at any time, between its ticks.

import type { Flown } from "../api";

export type Triple = [number, number, number];

export interface Pose {
  position: Triple;
  /** w, x, y, z. */
  attitude: [number, number, number, number];
  /** N. */
  rotors: number[];
  /** N. */
  thrust: number;
}

/** The tick at `time`, with its fraction. Ticks are equally far apart. */
export function tickAt(t: number[], time: number): number {
  const first = t[0] ?? 0;
  const last = t[t.length - 1] ?? 0;
  if (last <= first) return 0;
  return (Math.min(Math.max(time, first), last) - first) / (last - first) * (t.length - 1);
}

/** The pose at `time`. After the flight's end its last one stays. */
export function poseAt(flown: Flown, time: number): Pose {
  const tick = tickAt(flown.t, time);
  const i = Math.floor(tick);
  const j = Math.min(i + 1, flown.t.length - 1);
  const part = tick - i;
  const before = flown.attitude[i] ?? [1, 0, 0, 0];
  const after = flown.attitude[j] ?? before;
  // A quaternion and its negative are one attitude: blend towards the nearer one.
  const sign = before.reduce((sum, value, k) => sum + value * (after[k] ?? 0), 0) < 0 ? -1 : 1;
  const blend = before.map((value, k) => (1 - part) * value + part * sign * (after[k] ?? 0));
  const length = Math.hypot(...blend) || 1;
  return {
    position: between(flown.position, i, j, part),
    attitude: blend.map((value) => value / length) as Pose["attitude"],
    rotors: flown.rotors[i] ?? [],
    thrust: flown.thrust[i] ?? 0,
  };
}

/** A point of a path at `time`; the path has one row for each of these times. */
export function pointAt(path: Triple[], t: number[], time: number): Triple {
  const tick = tickAt(t, time);
  const i = Math.min(Math.floor(tick), path.length - 1);
  return between(path, i, Math.min(i + 1, path.length - 1), tick - Math.floor(tick));
}

function between(path: Triple[], i: number, j: number, part: number): Triple {
  const before = path[i] ?? [0, 0, 0];
  const after = path[j] ?? before;
  return before.map((value, k) => value + part * ((after[k] ?? 0) - value)) as Triple;
}

/** The body's z axis in the world. */
export function bodyZ([w, x, y, z]: Pose["attitude"]): Triple {
  return [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
}
