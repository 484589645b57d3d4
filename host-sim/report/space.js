// Space on a flat canvas: quaternions, a camera in perspective, and the vehicle's shape. World z up, body x ahead, y left, z up.

const add = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** The vector `v` turned by the unit quaternion `q` = (w, x, y, z). */
function turn([w, x, y, z], v) {
  const t = cross([x, y, z], v).map((value) => 2 * value);
  return add(add(v, t, w), cross([x, y, z], t));
}

/** Between two attitudes, the shorter way. */
function between(a, b, share) {
  const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
  const mixed = a.map((value, place) => value * (1 - share) + sign * share * b[place]);
  const length = Math.hypot(...mixed) || 1;
  return mixed.map((value) => value / length);
}

/** Looks at `target` from `distance` metres, angles in radians. */
class Camera {
  constructor() {
    Object.assign(this, { azimuth: -0.65, elevation: 0.38, distance: 10, target: [0, 0, 0] });
  }

  /** For a canvas of that size. */
  aim(width, height) {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    this.forward = [-ce * ca, -ce * sa, -se];
    this.right = [-sa, ca, 0];
    this.up = [-se * ca, -se * sa, ce];
    this.eye = add(this.target, this.forward, -this.distance);
    this.focal = 1.35 * Math.min(width, 1.25 * height);
    this.center = [width / 2, height / 2];
  }

  depth(point) {
    return dot(add(point, this.eye, -1), this.forward);
  }

  /** Where a point appears; none behind the camera. */
  project(point) {
    const from = add(point, this.eye, -1);
    const depth = dot(from, this.forward);
    if (depth < 0.02 * this.distance) return null;
    const scale = this.focal / depth;
    return [this.center[0] + scale * dot(from, this.right), this.center[1] - scale * dot(from, this.up)];
  }
}

/** The parts of a vehicle, in its own frame, in metres: arms, rotor discs, a body with a nose, legs. */
function shape(rotors) {
  const nominal = [[0.12, 0.12, 0], [0.12, -0.12, 0], [-0.12, -0.12, 0], [-0.12, 0.12, 0]];
  const hubs = rotors.length > 0 ? rotors : nominal;
  const arm = Math.max(...hubs.map((hub) => Math.hypot(...hub)), 1e-3);
  const apart = hubs.flatMap((a, i) => hubs.slice(i + 1).map((b) => Math.hypot(a[0] - b[0], a[1] - b[1])));
  const radius = 0.46 * Math.min(...apart.filter((distance) => distance > 0.05 * arm), 1.2 * arm);
  const lift = 0.1 * arm;
  const discs = hubs.map((hub) => ({
    front: hub[0] > 0.05 * arm,
    hub,
    rim: Array.from({ length: 28 }, (_, i) => {
      const angle = (2 * Math.PI * i) / 28;
      return [hub[0] + radius * Math.cos(angle), hub[1] + radius * Math.sin(angle), hub[2] + lift];
    }),
  }));
  const [l, w, h] = [0.4 * arm, 0.24 * arm, 0.11 * arm];
  const low = [[l, -w / 2, -h], [l, w / 2, -h], [0, w, -h], [-l, w, -h], [-l, -w, -h], [0, -w, -h]];
  const high = low.map(([x, y]) => [0.82 * x, 0.82 * y, h]);
  const sides = low.map((corner, i) => [corner, low[(i + 1) % 6], high[(i + 1) % 6], high[i]]);
  const faces = [...sides.map((points) => ({ points, part: "side" })), { points: high, part: "top" }, { points: [...low].reverse(), part: "bottom" }];
  return { hubs, arm, discs, faces, lift };
}

