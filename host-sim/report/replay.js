// The flight again, in space: a clock to play, a camera to orbit, and what is read at the clock's time.

class Replay {
  constructor(place, { bodies, rotors, hoverThrust }) {
    this.bodies = bodies.map((body) => ({ ...body, source: tracks[body.track] })).filter(({ source }) => source.rows > 0);
    Object.assign(this, { place, hoverThrust, shape: shape(rotors), camera: new Camera(), playing: false, follow: false });
    if (this.bodies.length === 0) return;
    this.paths = this.bodies.map(({ source }) => this.path(source, ["px", "py", "pz"]));
    this.asked = this.path(this.bodies[0].source, ["pdx", "pdy", "pdz"]);
    this.measureRoom();
    this.build();
    this.reset();
    clock.listeners.push(() => this.update());
    repaints.push(() => this.draw());
    this.update();
  }

  /** A polyline of at most some 1200 points, each with its time. */
  path(source, names) {
    const columns = names.map((name) => source.column(name));
    if (columns.includes(null)) return [];
    const stride = Math.max(1, Math.ceil(source.rows / 1200));
    const points = [];
    for (let row = 0; row < source.rows; row += stride) {
      points.push({ time: source.time(row), at: columns.map((column) => column[row]) });
    }
    return points;
  }

  /** The box that holds everything, a floor of round squares below it, and how large the vehicle is drawn. */
  measureRoom() {
    const points = [...this.paths.flat(), ...this.asked].map(({ at }) => at);
    const least = [0, 1, 2].map((axis) => Math.min(...points.map((at) => at[axis])));
    const greatest = [0, 1, 2].map((axis) => Math.max(...points.map((at) => at[axis])));
    this.middle = least.map((value, axis) => (value + greatest[axis]) / 2);
    this.extent = Math.max(...least.map((value, axis) => greatest[axis] - value), 6 * this.shape.arm);
    const square = ticks(0, this.extent, 14)[1];
    this.floor = { square, z: Math.floor(least[2] / square) * square };
    this.floor.x = [Math.floor(least[0] / square) - 1, Math.ceil(greatest[0] / square) + 1];
    this.floor.y = [Math.floor(least[1] / square) - 1, Math.ceil(greatest[1] / square) + 1];
    this.largest = Math.max(1, (0.25 * this.extent) / this.shape.arm);
    this.scale = Math.max(1, (0.07 * this.extent) / this.shape.arm);
  }

  build() {
    this.canvas = make("canvas", {
      class: "stage", tabindex: "0", role: "application",
      "aria-label": "Replay of the flight in space. Space plays, arrows orbit, plus and minus zoom, comma and full stop step, F follows, R resets the view.",
    });
    this.playButton = make("button", { type: "button", class: "play", click: () => this.play(!this.playing) }, "▶ Play");
    this.slider = make("input", { type: "range", min: "0", max: String(flightEnd), step: "any", value: "0", class: "time", "aria-label": "Time",
      input: () => clock.set(Number(this.slider.value)) });
    this.timeText = make("output", { class: "now" });
    this.speed = make("select", { id: "speed" });
    for (const speed of [0.1, 0.25, 0.5, 1, 2, 4, 8]) this.speed.append(make("option", { value: String(speed) }, `${speed}×`));
    this.speed.value = "1";
    this.size = make("input", { type: "range", id: "size", min: "0", max: "1", step: "any", value: String(Math.log(this.scale) / Math.log(this.largest) || 0) });
    this.sizeText = make("output", { for: "size" });
    this.size.disabled = this.largest <= 1;
    this.size.addEventListener("input", () => {
      this.scale = this.largest ** Number(this.size.value);
      this.update();
    });
    this.followButton = make("button", { type: "button", "aria-pressed": "false", click: () => this.setFollow(!this.follow) }, "Follow");
    this.readings = make("dl", { class: "readings" });
    this.reading = ["height", "speed", "tilt", "thrust", "from reference"].map((name) => {
      const value = make("dd");
      this.readings.append(make("div", {}, make("dt", {}, name), value));
      return value;
    });
    this.stage = new Stage(this.canvas, this.camera, this.shape, this.floor, this.hoverThrust);
    const frame = make("div", { class: "frame" }, this.canvas, this.key());
    const transport = make("div", { class: "transport" }, this.playButton, this.slider, this.timeText);
    const controls = make("div", { class: "controls" },
      make("label", { for: "speed" }, "Speed ", this.speed),
      make("label", { for: "size" }, "Vehicle ", this.size, this.sizeText),
      make("span", { class: "group" },
        button("−", "Farther away", () => this.approach(1 / 1.25)),
        button("+", "Closer", () => this.approach(1.25)),
        this.followButton,
        make("button", { type: "button", click: () => this.reset() }, "Reset view")));
    this.place.append(frame, transport, controls, this.readings);
    this.slider.addEventListener("keydown", (event) => {
      if (event.key === " ") {
        event.preventDefault();
        this.play(!this.playing);
      }
    });
    this.listen();
    new ResizeObserver(() => {
      if (this.untouched) this.frame();
      this.draw();
    }).observe(frame);
  }

  /** What the lines mean. */
  key() {
    const entry = (name, text, dashed = false) => {
      const swatch = make("span", { class: `swatch ${dashed ? "dashed" : ""}` });
      swatch.style.borderColor = `var(--${name})`;
      return make("li", {}, swatch, text);
    };
    const paths = this.bodies.map(({ color: name, label }) => entry(name, this.bodies.length > 1 ? label : "flown"));
    return make("ul", { class: "key" }, ...paths, entry("orange", "reference"), entry("vermilion", "thrust; front rotors"),
      ...(Number.isFinite(this.bodies[0].source.value("rotor_1", 0)) ? [entry("sky", "rotor thrusts")] : []));
  }

  reset() {
    Object.assign(this.camera, { azimuth: -0.65, elevation: 0.36 });
    this.setFollow(false);
  }

  /** Comes as close as lets everything be seen, floor and vehicle included, and centres it. */
  frame() {
    const { camera, canvas, floor } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) return;
    const corners = floor.x.flatMap((x) => floor.y.map((y) => [x * floor.square, y * floor.square, floor.z]));
    const points = [...corners, ...[...this.paths.flat(), ...this.asked].map(({ at }) => at)];
    const room = Math.min(24, 0.06 * width);
    camera.target = [...this.middle];
    for (camera.distance = 0.7 * this.extent; camera.distance < 8 * this.extent; camera.distance *= 1.04) {
      camera.aim(width, height);
      let at = points.map((point) => camera.project(point));
      if (at.includes(null)) continue;
      const span = (axis) => [Math.min(...at.map((point) => point[axis])), Math.max(...at.map((point) => point[axis]))];
      const [[left, right], [top, bottom]] = [span(0), span(1)];
      if (right - left > width - 2 * room || bottom - top > height - 44 - 2 * room) continue;
      const metres = camera.distance / camera.focal;
      camera.target = add(camera.target, camera.right, ((left + right - width) / 2) * metres);
      camera.target = add(camera.target, camera.up, (-(top + bottom - height - 30) / 2) * metres);
      return;
    }
  }

  setFollow(follow) {
    this.follow = follow;
    this.followButton.setAttribute("aria-pressed", follow);
    this.untouched = !follow;
    if (follow) this.camera.distance = Math.max(9 * this.shape.arm * this.scale, 0.3 * this.extent);
    else this.frame();
    this.draw();
  }

  approach(factor) {
    this.untouched = false;
    this.camera.distance = Math.min(Math.max(this.camera.distance / factor, 3 * this.shape.arm), 6 * this.extent);
    this.draw();
  }

  orbit(right, up) {
    this.untouched = false;
    this.camera.azimuth -= right;
    this.camera.elevation = Math.min(Math.max(this.camera.elevation + up, -0.2), 1.55);
    this.draw();
  }

  play(playing) {
    this.playing = playing;
    this.playButton.textContent = playing ? "❚❚ Pause" : "▶ Play";
    if (!playing) return;
    if (clock.time >= flightEnd - 1e-9) clock.set(0);
    let before = performance.now();
    const next = (now) => {
      if (!this.playing) return;
      clock.set(clock.time + (Number(this.speed.value) * (now - before)) / 1000);
      before = now;
      if (clock.time >= flightEnd) this.play(false);
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  /** Drag to orbit; two fingers or Ctrl and wheel to come closer; keys for everything. */
  listen() {
    const fingers = new Map();
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      if (fingers.size === 1) this.orbit((event.clientX - before[0]) / 160, (event.clientY - before[1]) / 160);
      else {
        const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
        const apart = ([x, y]) => Math.max(Math.hypot(x - other[0], y - other[1]), 12);
        this.approach(apart([event.clientX, event.clientY]) / apart(before));
      }
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== canvas) return;
      event.preventDefault();
      this.approach(Math.exp(-event.deltaY / 300));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const step = this.bodies[0].source.step;
      const actions = {
        " ": () => this.play(!this.playing),
        ArrowLeft: () => this.orbit(0.12, 0),
        ArrowRight: () => this.orbit(-0.12, 0),
        ArrowUp: () => this.orbit(0, 0.12),
        ArrowDown: () => this.orbit(0, -0.12),
        "+": () => this.approach(1.25),
        "=": () => this.approach(1.25),
        "-": () => this.approach(1 / 1.25),
        ",": () => clock.set(clock.time - step),
        ".": () => clock.set(clock.time + step),
        Home: () => clock.set(0),
        End: () => clock.set(flightEnd),
        f: () => this.setFollow(!this.follow),
        r: () => this.reset(),
      };
      const action = actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
      announce(`${short(clock.time)} s: ${this.reading.map((value) => `${value.previousSibling.textContent} ${value.textContent}`).join(", ")}`);
    });
  }

  /** A body at the clock's time, between rows. */
  pose({ source }) {
    const row = source.row(clock.time);
    const next = Math.min(row + 1, source.rows - 1);
    const share = Math.min(Math.max((clock.time - source.time(row)) / source.step, 0), 1);
    const mixed = (names) => names.map((name) => {
      const column = source.column(name);
      return column ? column[row] * (1 - share) + column[next] * share : NaN;
    });
    const q = (at) => ["qw", "qx", "qy", "qz"].map((name) => source.column(name)[at]);
    const [thrust, yawAsked] = ["thrust", "yaw_d"].map((name) => source.value(name, clock.time));
    return { position: mixed(["px", "py", "pz"]), velocity: mixed(["vx", "vy", "vz"]), asked: mixed(["pdx", "pdy", "pdz"]),
      attitude: between(q(row), q(next), share), thrust, yawAsked,
      rotors: this.shape.hubs.map((_, rotor) => source.value(`rotor_${rotor + 1}`, clock.time)) };
  }

  update() {
    this.slider.value = String(clock.time);
    this.slider.setAttribute("aria-valuetext", `${short(clock.time)} s of ${short(flightEnd)} s`);
    this.timeText.textContent = `${clock.time.toFixed(2)} s`;
    this.sizeText.textContent = `${this.scale < 10 ? this.scale.toFixed(1) : Math.round(this.scale)}× life`;
    const { position, velocity, asked, attitude, thrust } = this.pose(this.bodies[0]);
    const tilt = (Math.acos(Math.min(Math.max(turn(attitude, [0, 0, 1])[2], -1), 1)) * 180) / Math.PI;
    const away = Math.hypot(...add(position, asked, -1));
    const values = [[position[2], "m"], [Math.hypot(...velocity), "m/s"], [tilt, "°"], [thrust, "N"], [away, "m"]];
    values.forEach(([value, unit], place) => (this.reading[place].textContent = measure(Number(value.toPrecision(3)), unit)));
    this.draw();
  }

  draw() {
    const poses = this.bodies.map((body) => this.pose(body));
    if (this.follow) this.camera.target = poses[0].position;
    this.stage.draw(this.bodies, poses, this.paths, this.asked, this.scale);
  }
}

document.querySelectorAll("[data-replay]").forEach((place) => new Replay(place, data.replays[place.dataset.replay]));

