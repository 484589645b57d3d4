// What a replay shows at one moment: floor, paths, reference, vehicle with its thrusts, and the world's axes.

class Stage {
  constructor(canvas, camera, shape, floor, hoverThrust) {
    Object.assign(this, { canvas, camera, shape, floor, hoverThrust, scale: 1 });
  }

  /** Bodies in their poses, so many times as large as life, each with its path, and the reference path. */
  draw(bodies, poses, paths, asked, scale) {
    const { canvas, camera } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) return;
    this.scale = scale;
    const density = Math.max(devicePixelRatio || 1, document.documentElement.dataset.print === "" ? 3 : 1);
    if (canvas.width !== Math.round(width * density) || canvas.height !== Math.round(height * density)) {
      canvas.width = Math.round(width * density);
      canvas.height = Math.round(height * density);
    }
    const context = (this.context = canvas.getContext("2d"));
    context.setTransform(density, 0, 0, density, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineJoin = context.lineCap = "round";
    camera.aim(width, height);
    this.drawFloor();
    bodies.forEach((_, place) => this.drawShadow(paths[place], poses[place]));
    this.drawPath(asked, "orange", 4, 0.22, 0.75);
    bodies.forEach((body, place) => this.drawPath(paths[place], body.color, 2.2, 0.22, 1));
    if (asked.length > 0) this.drawReference(poses[0]);
    poses.forEach((pose) => this.drawVehicle(pose));
    this.drawAxes(height);
  }

  stroke(points, name, width, alpha = 1) {
    const { context } = this;
    context.strokeStyle = color(name);
    context.lineWidth = width;
    context.globalAlpha = alpha;
    context.beginPath();
    let drawing = false;
    for (const point of points) {
      const at = this.camera.project(point);
      if (!at) drawing = false;
      else if (drawing) context.lineTo(at[0], at[1]);
      else {
        context.moveTo(at[0], at[1]);
        drawing = true;
      }
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  fill(points, style, alpha = 1) {
    const { context } = this;
    const at = points.map((point) => this.camera.project(point));
    if (at.includes(null)) return;
    context.fillStyle = style;
    context.globalAlpha = alpha;
    context.beginPath();
    at.forEach(([x, y], place) => (place === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.closePath();
    context.fill();
    context.globalAlpha = 1;
  }

  drawFloor() {
    const { square, z, x, y } = this.floor;
    const at = (i, j) => [i * square, j * square, z];
    this.fill([at(x[0], y[0]), at(x[1], y[0]), at(x[1], y[1]), at(x[0], y[1])], color("floor"));
    for (let i = x[0]; i <= x[1]; i += 1) this.stroke([at(i, y[0]), at(i, y[1])], "grid", 1);
    for (let j = y[0]; j <= y[1]; j += 1) this.stroke([at(x[0], j), at(x[1], j)], "grid", 1);
  }

  drawShadow(path, { position }) {
    const down = ([x, y]) => [x, y, this.floor.z];
    this.stroke(path.filter(({ time }) => time <= clock.time).map(({ at }) => down(at)), "shadow", 1.5);
    this.stroke([position, down(position)], "shadow", 1);
    const radius = 0.9 * this.shape.arm * this.scale;
    const rim = Array.from({ length: 24 }, (_, i) => add(down(position), [Math.cos((i * Math.PI) / 12) * radius, Math.sin((i * Math.PI) / 12) * radius, 0]));
    this.fill(rim, color("shadow"), 0.6);
  }

  /** What is past strongly, what is to come faintly. */
  drawPath(path, name, width, faint, strong) {
    this.stroke(path.map(({ at }) => at), name, width, faint);
    this.stroke(path.filter(({ time }) => time <= clock.time + 1e-9).map(({ at }) => at), name, width, strong);
  }

  /** A ring where the vehicle is to be, with a hand towards the heading. */
  drawReference({ asked, yawAsked }) {
    const radius = 0.5 * this.shape.arm * this.scale;
    const towards = (angle, length) => add(asked, [length * Math.cos(angle), length * Math.sin(angle), 0]);
    const ring = Array.from({ length: 33 }, (_, i) => towards((i * Math.PI) / 16, radius));
    this.stroke(ring, "orange", 2);
    if (Number.isFinite(yawAsked)) this.stroke([asked, towards((yawAsked * Math.PI) / 180, 2.2 * radius)], "orange", 2);
  }

  /** Farthest parts first. */
  drawVehicle({ position, attitude, thrust, rotors }) {
    const { hubs, arm, discs, faces, lift } = this.shape;
    const world = (point) => add(position, turn(attitude, point), this.scale);
    const parts = [];
    const part = (middle, draw) => parts.push({ depth: this.camera.depth(middle), draw });
    for (const hub of hubs) {
      const [from, to] = [world([0, 0, 0]), world(hub)];
      part(add(from, add(to, from, -1), 0.5), () => this.stroke([from, to, world(add(hub, [0, 0, lift]))], "ink", 3));
    }
    for (const { hub, front, rim } of discs) {
      const points = rim.map(world);
      const name = front ? "vermilion" : "ink";
      part(world(add(hub, [0, 0, lift])), () => {
        this.fill(points, color(name), front ? 0.34 : 0.2);
        this.stroke([...points, points[0]], name, 1.4);
      });
    }
    for (const { points, part: name } of faces) {
      const at = points.map(world);
      const middle = at.reduce((sum, point) => add(sum, point, 1 / at.length), [0, 0, 0]);
      const normal = cross(add(at[1], at[0], -1), add(at[2], at[0], -1));
      if (dot(normal, add(this.camera.eye, middle, -1)) < 0) continue;
      part(middle, () => this.fill(at, color({ top: "hull-top", side: "hull", bottom: "hull-bottom" }[name])));
    }
    const top = world([0, 0, (1.9 * arm * thrust) / this.hoverThrust]);
    part(top, () => this.arrow(world([0, 0, 0]), top, "vermilion", 3));
    hubs.forEach((hub, rotor) => {
      if (!Number.isFinite(rotors[rotor])) return;
      const from = world(add(hub, [0, 0, lift]));
      const to = world(add(hub, [0, 0, lift + (0.8 * arm * rotors[rotor] * hubs.length) / this.hoverThrust]));
      part(to, () => this.stroke([from, to], "sky", 2.5));
    });
    parts.sort((a, b) => b.depth - a.depth).forEach(({ draw }) => draw());
  }

  arrow(from, to, name, width) {
    this.stroke([from, to], name, width);
    const [a, b] = [this.camera.project(from), this.camera.project(to)];
    if (!a || !b) return;
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const length = Math.hypot(dx, dy);
    if (length < 6) return;
    const [ux, uy, head] = [dx / length, dy / length, Math.min(9, length / 2)];
    this.context.fillStyle = color(name);
    this.context.beginPath();
    this.context.moveTo(b[0] + 3 * ux, b[1] + 3 * uy);
    this.context.lineTo(b[0] - head * ux - 0.5 * head * uy, b[1] - head * uy + 0.5 * head * ux);
    this.context.lineTo(b[0] - head * ux + 0.5 * head * uy, b[1] - head * uy - 0.5 * head * ux);
    this.context.fill();
  }

  /** The world's axes, in a corner, and the size of the floor's squares. */
  drawAxes(height) {
    const { context, camera } = this;
    const origin = [34, height - 34];
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 1.5;
    context.strokeStyle = context.fillStyle = color("muted");
    [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]].forEach(([name, axis]) => {
      const [dx, dy] = [20 * dot(axis, camera.right), -20 * dot(axis, camera.up)];
      context.beginPath();
      context.moveTo(...origin);
      context.lineTo(origin[0] + dx, origin[1] + dy);
      context.stroke();
      if (Math.hypot(dx, dy) > 5) context.fillText(name, origin[0] + 1.45 * dx, origin[1] + 1.45 * dy);
    });
    context.textAlign = "left";
    context.fillText(`squares of ${short(this.floor.square)} m`, 70, height - 16);
  }
}
