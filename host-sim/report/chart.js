// A drawing area with axes: what plots over time and distributions have in common.

// The axes' rules are those of host-sim/src/reports/plots/axis.rs, which draws the same plots as SVG.

/** Round numbers between two ends, at most so many. */
function ticks(least, greatest, most) {
  const rough = (greatest - least) / Math.max(most, 1);
  if (!(rough > 0)) return [least];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough * (1 - 1e-9));
  const found = [];
  for (let place = Math.ceil(least / step - 1e-9); place * step <= greatest + 1e-9 * step; place += 1) found.push(place * step);
  return found;
}

/** Powers of ten between two ends, at most so many. */
function decades(least, greatest, most) {
  const [low, high] = [Math.ceil(Math.log10(least) - 1e-9), Math.floor(Math.log10(greatest) + 1e-9)];
  const step = Math.max(1, Math.ceil((high - low + 1) / Math.max(most, 1)));
  const found = [];
  for (let power = low; power <= high; power += step) found.push(10 ** power);
  return found;
}

/** As many decimals as the distance between ticks needs. */
function tickText(value, marks, logarithmic) {
  if (logarithmic) {
    const raised = [...String(Math.round(Math.log10(value)))].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
    return `10${raised}`;
  }
  const step = marks.length > 1 ? marks[1] - marks[0] : Math.abs(value) || 1;
  if (step < 1e-4 || step >= 1e5) return value === 0 ? "0" : value.toExponential(1).replace(/^-/, "−");
  const text = value.toFixed(Math.min(Math.max(-Math.floor(Math.log10(step) + 1e-9), 0), 6));
  return (Number(text) === 0 ? "0" : text).replace("-", "−");
}

class Chart {
  /** `paint(chart)` draws everything; `mark(context)`, on a layer of its own, what moves. */
  constructor(place, height, paint, mark = () => {}) {
    this.base = make("canvas", { "aria-hidden": "true" });
    this.layer = make("canvas", { "aria-hidden": "true" });
    this.box = make("div", { class: "chart" }, this.base, this.layer);
    this.box.style.height = `${height}px`;
    place.append(this.box);
    Object.assign(this, { paint, mark, height, width: 0, visible: false });
    this.margin = { left: 58, right: 26, top: 26, bottom: 24 };
    new ResizeObserver(() => this.resize()).observe(this.box);
    new IntersectionObserver(([entry]) => {
      this.visible = entry.isIntersecting;
      if (this.visible) this.draw();
    }, { rootMargin: "200px" }).observe(this.box);
    repaints.push(() => this.draw(true));
  }

  resize() {
    this.width = this.box.clientWidth;
    if (this.visible) this.draw();
  }

  /** Draws, if anybody can see it or, with `always`, even so. */
  draw(always = false) {
    if (this.width === 0 || always) this.width = this.box.clientWidth;
    if (this.width === 0 || !(this.visible || always)) return;
    const density = Math.max(devicePixelRatio || 1, document.documentElement.dataset.print === "" ? 3 : 1);
    for (const canvas of [this.base, this.layer]) {
      canvas.width = Math.round(this.width * density);
      canvas.height = Math.round(this.height * density);
      canvas.getContext("2d").setTransform(density, 0, 0, density, 0, 0);
    }
    this.context = this.base.getContext("2d");
    this.context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    this.paint(this);
    this.move();
  }

  /** Draws again what moves. */
  move() {
    if (!this.visible || this.width === 0) return;
    const context = this.layer.getContext("2d");
    context.clearRect(0, 0, this.width, this.height);
    this.mark(context);
  }

  /** Sets the ends of both axes. */
  range(horizontal, vertical) {
    this.ends = { horizontal, vertical };
  }

  get horizontal() {
    return this.ranged().horizontal;
  }

  get vertical() {
    return this.ranged().vertical;
  }

  /** The ends of both axes. A pointer that the page is scrolled under, or a key, may ask before the first drawing: then it is drawn. */
  ranged() {
    if (!this.ends) this.draw(true);
    return this.ends;
  }

  share(value, { least, greatest, logarithmic }) {
    if (!logarithmic) return (value - least) / (greatest - least);
    return Math.log(Math.max(value, least) / least) / Math.log(greatest / least);
  }

  x(value) {
    const { left, right } = this.margin;
    return left + this.share(value, this.horizontal) * (this.width - left - right);
  }

  y(value) {
    const { top, bottom } = this.margin;
    return this.height - bottom - this.share(value, this.vertical) * (this.height - top - bottom);
  }

  /** The horizontal value at a pixel. */
  at(x) {
    const { left, right } = this.margin;
    const { least, greatest, logarithmic } = this.horizontal;
    const share = Math.min(Math.max((x - left) / (this.width - left - right), 0), 1);
    return logarithmic ? least * (greatest / least) ** share : least + share * (greatest - least);
  }

  /** Grid, zero, and numbers with their units. */
  axes(unit, verticalUnit) {
    const { context, margin, width, height } = this;
    const [bottom, right] = [height - margin.bottom, width - margin.right];
    const marks = (axis, most) => (axis.logarithmic ? decades : ticks)(axis.least, axis.greatest, most);
    const across = marks(this.horizontal, Math.max(2, (width - 80) / 60));
    const up = marks(this.vertical, Math.max(2, height / 42));
    context.strokeStyle = color("grid");
    context.fillStyle = color("muted");
    context.lineWidth = 1;
    context.textBaseline = "middle";
    context.textAlign = "right";
    for (const value of up) {
      const y = Math.round(this.y(value)) + 0.5;
      context.strokeStyle = color(value === 0 && !this.vertical.logarithmic ? "axis" : "grid");
      this.line([[margin.left, y], [right, y]]);
      context.fillText(tickText(value, up, this.vertical.logarithmic), margin.left - 8, y);
    }
    context.textBaseline = "top";
    for (const value of across) {
      const x = Math.round(this.x(value)) + 0.5;
      const text = tickText(value, across, this.horizontal.logarithmic);
      const half = context.measureText(text).width / 2;
      context.textAlign = "center";
      this.line([[x, bottom], [x, bottom + 4]]);
      if (x + half < width - 16) context.fillText(text, Math.max(x, half), bottom + 8);
    }
    context.textAlign = "right";
    context.fillText(unit, width, bottom + 8);
    context.fillText(verticalUnit, margin.left - 8, 2);
    context.strokeStyle = color("axis");
    this.line([[margin.left, bottom + 0.5], [right, bottom + 0.5]]);
  }

  /** Text that stays legible on lines. */
  label(text, x, y) {
    this.context.lineWidth = 5;
    this.context.lineJoin = "round";
    this.context.strokeStyle = color("card");
    this.context.strokeText(text, x, y);
    this.context.fillText(text, x, y);
    this.context.lineWidth = 1;
  }

  line(points) {
    this.context.beginPath();
    points.forEach(([x, y], place) => (place === 0 ? this.context.moveTo(x, y) : this.context.lineTo(x, y)));
    this.context.stroke();
  }

  /** An upright line at a horizontal value, on the layer of what moves; says where that is. */
  cursor(context, value) {
    const x = this.x(value);
    context.strokeStyle = color("ink");
    context.globalAlpha = 0.55;
    context.beginPath();
    context.moveTo(x, 4);
    context.lineTo(x, this.height - this.margin.bottom);
    context.stroke();
    context.globalAlpha = 1;
    return x;
  }

  /** Draws within the axes only. */
  clipped(draw) {
    const { context, margin, width, height } = this;
    context.save();
    context.beginPath();
    context.rect(margin.left, margin.top - 6, width - margin.left - margin.right, height - margin.top - margin.bottom + 7);
    context.clip();
    draw(context);
    context.restore();
  }
}

