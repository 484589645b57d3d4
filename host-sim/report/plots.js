// Curves over time. All plots share one range of time and one cursor, and the cursor is the replay's clock.

/** The time that is shown, and where the pointer is; s. */
const view = { from: 0, to: flightEnd, hover: null };
const plots = [];
const cursor = () => (view.hover === null ? clock.time : view.hover);

/** Shows another range of time, within the flight and not below a few rows. */
function show(from, to) {
  const least = Math.min(flightEnd, 4 * Math.min(...tracks.map((track) => track.step)));
  const width = Math.min(Math.max(to - from, least), flightEnd);
  view.from = Math.min(Math.max(from, 0), flightEnd - width);
  view.to = view.from + width;
  plots.forEach((plot) => plot.chart.draw());
  shown.forEach((update) => update());
}
const shown = [];

/** Zooms by a factor about a time; beyond the pointer nothing moves. */
function zoom(factor, about) {
  show(about - (about - view.from) / factor, about + (view.to - about) / factor);
}

function pan(share) {
  const by = share * (view.to - view.from);
  show(view.from + by, view.to + by);
}

/** Where zooming by buttons and keys goes: the cursor if it is shown, or else the middle. */
function middle() {
  return clock.time >= view.from && clock.time <= view.to ? clock.time : (view.from + view.to) / 2;
}

class Plot {
  constructor(figure, { title, unit, logarithmic, fromZero, curves, bounds }) {
    Object.assign(this, { title, unit, logarithmic, fromZero, bounds, fit: false, drag: null });
    this.curves = curves.map((curve) => ({ ...curve, source: tracks[curve.track], on: true }));
    this.end = Math.max(0, ...this.curves.map(({ source }) => source.end));
    this.reach = this.extremes(0, flightEnd);
    const place = figure.querySelector(".drawing");
    place.append(this.legend(figure));
    this.chart = new Chart(place, 246, () => this.paint(), (context) => this.mark(context));
    const box = this.chart.box;
    box.tabIndex = 0;
    box.setAttribute("role", "application");
    box.setAttribute("aria-label", `${title} over time. Left and right move the cursor, plus and minus zoom, Page Up and Page Down pan, 0 shows all.`);
    this.listen(box);
    clock.listeners.push(() => this.move());
  }

  legend(figure) {
    const list = legend(this.curves, () => this.chart.draw());
    if (this.bounds.length > 0) {
      const press = () => {
        this.fit = !this.fit;
        toggle.setAttribute("aria-pressed", this.fit);
        this.chart.draw();
      };
      const toggle = make("button", { type: "button", class: "fit", "aria-pressed": "false", click: press }, "Leave out bounds");
      figure.querySelector("h3").append(toggle);
    }
    return list;
  }

  /** Least and greatest value within a range of time. */
  extremes(from, to) {
    let [least, greatest] = [Infinity, -Infinity];
    for (const { source, column, on } of this.curves) {
      const values = source.column(column);
      if (!on) continue;
      for (let row = source.row(from); row <= Math.min(source.row(to) + 1, source.rows - 1); row += 1) {
        const value = values[row];
        if (!Number.isFinite(value) || (this.logarithmic && value <= 0)) continue;
        least = Math.min(least, value);
        greatest = Math.max(greatest, value);
      }
    }
    return least > greatest ? (this.logarithmic ? [0.1, 1] : [-1, 1]) : [least, greatest];
  }

  /** What all but one in a hundred of the shown values exceed: a moment near zero must not stretch the decades. */
  small() {
    const values = this.curves.filter(({ on }) => on).flatMap(({ source, column }) =>
      [...source.column(column).subarray(source.row(view.from), source.row(view.to) + 1)].filter((value) => value > 0));
    return values.sort((a, b) => a - b)[Math.floor(values.length / 100)] ?? Infinity;
  }

  /** The vertical axis: what is shown, what is proven, and other bounds unless they would flatten it. */
  axis() {
    let [least, greatest] = this.extremes(view.from, view.to);
    const most = 8 * Math.max(this.reach[1] - this.reach[0], 1e-12);
    for (const { value, always } of this.fit ? [] : this.bounds) {
      const [low, high] = [Math.min(least, value), Math.max(greatest, value)];
      if (always || this.logarithmic || Math.max(high, this.reach[1]) - Math.min(low, this.reach[0]) <= most) [least, greatest] = [low, high];
    }
    if (this.logarithmic) {
      const high = Math.ceil(Math.log10(greatest) + 1e-9);
      const low = Math.max(Math.min(Math.floor(Math.log10(Math.min(this.small(), least * 1e3))), high - 1), high - 9);
      return { least: 10 ** low, greatest: 10 ** high, logarithmic: true };
    }
    if (this.fromZero && !this.fit) [least, greatest] = [Math.min(least, 0), Math.max(greatest, 0)];
    const room = greatest - least > 1e-9 * Math.max(Math.abs(greatest), 1e-6) ? 0.07 * (greatest - least) : Math.abs(greatest) * 0.1 || 1;
    return { least: least - room, greatest: greatest + room };
  }

  paint() {
    const { chart } = this;
    const { context } = chart;
    // Of several recordings a shorter one ends its plot where it ends itself.
    chart.range({ least: view.from, greatest: view.from < this.end ? Math.min(view.to, this.end) : view.to }, this.axis());
    context.clearRect(0, 0, chart.width, chart.height);
    chart.axes("s", this.unit);
    const seen = this.bounds.map((bound) => ({ ...bound, y: chart.y(bound.value) }))
      .filter(({ y }) => y > chart.margin.top - 1 && y < chart.height - chart.margin.bottom + 1);
    chart.clipped(() => {
      context.setLineDash([2, 3]);
      context.globalAlpha = 0.75;
      for (const { y, color: name } of seen) {
        context.strokeStyle = color(name);
        chart.line([[chart.margin.left, y], [chart.width - chart.margin.right, y]]);
      }
      context.setLineDash([]);
      context.globalAlpha = 1;
      for (const curve of this.curves) if (curve.on) this.paintCurve(context, curve);
    });
    this.labelBounds(context, seen);
  }

  /** What each bound is: at the right or in the middle, above its line or below, never on it and never on another label. A bound that
   *  finds no room has no label; the table below the plot has them all. Panel.rs has the same rules. */
  labelBounds(context, seen) {
    const { chart } = this;
    const [left, right, low] = [chart.margin.left, chart.width - chart.margin.right, chart.height - chart.margin.bottom];
    const written = [];
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const { value, label, color: name, text, y } of seen) {
      const mirrored = value !== 0 && seen.some((other) => other.label === label && other.value === -value);
      if (mirrored && value < 0) continue;
      const words = `${label}: ${mirrored ? "±" : ""}${text}`;
      const width = context.measureText(words).width;
      const outer = value >= 0 ? -9 : 9;
      const places = [right - 4, left + 0.55 * (right - left)].flatMap((x) => [outer, -outer].map((by) => ({ x, y: y + by })));
      const apart = (at, other) => Math.abs(at.y - other.y) > 13 || at.x < other.x - other.width || other.x < at.x - width;
      const free = places.filter((at) => at.x - width > left && at.y > chart.margin.top - 12 && at.y < low - 6 && written.every((other) => apart(at, other)));
      const place = free.find((at) => seen.every((other) => Math.abs(other.y - at.y) > 7)) || free[0];
      if (!place) continue;
      written.push({ ...place, width });
      context.fillStyle = color(name);
      chart.label(words, place.x, place.y);
    }
  }

  paintCurve(context, { source, column, color: name, line, broad }) {
    const { chart } = this;
    const values = source.column(column);
    context.strokeStyle = color(name);
    context.lineWidth = broad ? 3.5 : line === "solid" ? 1.75 : 1.25;
    context.lineJoin = "round";
    context.setLineDash(PATTERNS[line]);
    context.beginPath();
    let drawing = false;
    for (let row = source.row(view.from); row <= Math.min(source.row(view.to) + 1, source.rows - 1); row += 1) {
      const value = values[row];
      const [x, y] = [chart.x(source.time(row)), chart.y(value)];
      if (!Number.isFinite(value)) drawing = false;
      else if (drawing) context.lineTo(x, y);
      else {
        context.moveTo(x, y);
        drawing = true;
      }
    }
    context.stroke();
    context.setLineDash([]);
  }

  /** The cursor, and the readings in the legend. */
  mark(context) {
    const { chart } = this;
    const time = cursor();
    for (const curve of this.curves) curve.reading.textContent = measure(curve.source.value(curve.column, time), this.unit);
    if (this.drag && this.drag.to !== undefined) {
      context.fillStyle = color("selection");
      const [from, to] = [chart.x(this.drag.from), chart.x(this.drag.to)];
      context.fillRect(from, chart.margin.top - 6, to - from, chart.height - chart.margin.bottom - chart.margin.top + 6);
    }
    if (time < view.from || time > chart.horizontal.greatest) return;
    const x = chart.cursor(context, time);
    for (const { source, column, color: name, on } of this.curves) {
      const value = source.value(column, time);
      const y = chart.y(value);
      if (!on || !Number.isFinite(y) || y < 0 || y > chart.height - chart.margin.bottom) continue;
      context.fillStyle = color(name);
      context.beginPath();
      context.arc(chart.x(source.time(source.row(time))), y, 3, 0, 7);
      context.fill();
    }
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    context.fillStyle = color("ink");
    context.textAlign = x > chart.width / 2 ? "right" : "left";
    context.fillText(`${short(time)} s`, x + (x > chart.width / 2 ? -6 : 6), 12);
  }

  move() {
    this.chart.move();
  }

  /** Mouse: point to read, drag to zoom, Shift and drag to pan. Fingers: drag to read, two to zoom. */
  listen(box) {
    const fingers = new Map();
    const time = (event) => this.chart.at(event.clientX - box.getBoundingClientRect().left);
    const read = (value) => {
      view.hover = value;
      plots.forEach((plot) => plot.move());
    };
    box.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, event.clientX);
      box.setPointerCapture(event.pointerId);
      if (event.pointerType !== "mouse") clock.set(time(event));
      else if (event.button === 0) this.drag = { x: event.clientX, from: time(event), pan: event.shiftKey };
    });
    box.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (event.pointerType === "mouse") {
        const { drag } = this;
        if (drag && drag.pan) show(view.from + drag.from - time(event), view.to + drag.from - time(event));
        else if (drag && Math.abs(event.clientX - drag.x) > 5) drag.to = time(event);
        read(time(event));
      } else if (before !== undefined && fingers.size === 1) clock.set(time(event));
      else if (before !== undefined && fingers.size === 2) {
        const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, x]) => x);
        const about = time({ clientX: (other + event.clientX) / 2 });
        zoom(Math.max(Math.abs(event.clientX - other), 12) / Math.max(Math.abs(before - other), 12), about);
      }
      if (before !== undefined) fingers.set(event.pointerId, event.clientX);
    });
    const release = (event) => {
      fingers.delete(event.pointerId);
      const { drag } = this;
      this.drag = null;
      if (!drag || event.type === "pointercancel") return;
      if (drag.to !== undefined) show(Math.min(drag.from, drag.to), Math.max(drag.from, drag.to));
      else if (!drag.pan) clock.set(drag.from);
    };
    box.addEventListener("pointerup", release);
    box.addEventListener("pointercancel", release);
    box.addEventListener("pointerleave", () => read(null));
    box.addEventListener("dblclick", () => show(0, flightEnd));
    box.addEventListener("wheel", (event) => {
      // The page scrolls by the wheel alone.
      if (event.ctrlKey || event.metaKey) zoom(Math.exp(-event.deltaY / 250), time(event));
      else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) pan((event.deltaX || event.deltaY) / 600);
      else return;
      event.preventDefault();
    }, { passive: false });
    box.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = (view.to - view.from) / (event.shiftKey ? 10 : 100);
    const actions = {
      ArrowLeft: () => clock.set(clock.time - step),
      ArrowRight: () => clock.set(clock.time + step),
      Home: () => clock.set(view.from),
      End: () => clock.set(view.to),
      PageUp: () => pan(-0.5),
      PageDown: () => pan(0.5),
      "+": () => zoom(1.5, middle()),
      "=": () => zoom(1.5, middle()),
      "-": () => zoom(1 / 1.5, middle()),
      0: () => show(0, flightEnd),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    view.hover = null;
    action();
    const readings = this.curves.filter(({ on }) => on).map(({ label, source, column }) =>
      `${label} ${measure(source.value(column, clock.time), this.unit)}`);
    announce(`${this.title}, ${short(clock.time)} s: ${readings.join(", ")}. Shown: ${short(view.from)} to ${short(view.to)} s.`);
  }
}

/** What moves all plots of a page at once. */
function toolbar() {
  const range = make("output", { class: "range" });
  const update = () => (range.textContent = `${short(view.from)} to ${short(view.to)} s`);
  shown.push(update);
  update();
  const bar = make("div", { class: "toolbar", role: "group", "aria-label": "Time shown by all plots" },
    button("−", "Zoom out", () => zoom(1 / 1.5, middle())),
    button("+", "Zoom in", () => zoom(1.5, middle())),
    button("◂", "Earlier", () => pan(-0.5)),
    button("▸", "Later", () => pan(0.5)),
    make("button", { type: "button", click: () => show(0, flightEnd) }, "All"),
    make("button", { type: "button", click: () => show(0, Math.min(5, flightEnd)) }, "First 5 s"),
    range);
  const hint = make("p", { class: "hint" }, "Point at a plot to read it; drag to zoom, Shift and drag to pan, double-click for all. On a phone: one finger reads, two zoom.");
  return make("div", { class: "tools" }, bar, hint);
}

document.querySelectorAll("figure[data-plot]").forEach((figure) => {
  if (!figure.previousElementSibling) figure.parentElement.before(toolbar());
  plots.push(new Plot(figure, data.plots[figure.dataset.plot]));
});

