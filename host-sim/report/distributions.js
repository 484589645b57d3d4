// How a quantity is spread over many flights: a histogram, or the share of flights up to each value.

class Spread {
  constructor(figure, distribution) {
    // Bars of several groups hide each other.
    Object.assign(this, distribution, { cumulative: distribution.groups.length > 1, at: null });
    this.groups = distribution.groups.map((group) => ({ ...group, quantiles: group.quantiles ? decode(group.quantiles) : new Float32Array() }));
    const place = figure.querySelector(".drawing");
    const toggle = make("button", { type: "button", class: "fit", "aria-pressed": String(this.cumulative), click: () => {
      this.cumulative = !this.cumulative;
      toggle.setAttribute("aria-pressed", this.cumulative);
      this.chart.draw();
    } }, "Cumulative");
    figure.querySelector("h3").append(toggle);
    place.append(legend(this.groups, () => this.chart.draw()));
    this.chart = new Chart(place, 230, () => this.paint(), (context) => this.mark(context));
    const { box } = this.chart;
    box.tabIndex = 0;
    box.setAttribute("role", "application");
    box.setAttribute("aria-label", `${this.title}, distribution. Left and right move the cursor.`);
    box.addEventListener("pointermove", (event) => this.read(this.chart.at(event.clientX - box.getBoundingClientRect().left)));
    box.addEventListener("pointerleave", () => this.read(null));
    box.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!way) return;
      event.preventDefault();
      const { chart } = this;
      this.read(chart.at(chart.x(this.at ?? this.least) + 6 * way));
      announce(`${measure(this.at, this.unit)}: ${this.shown().map(({ label, reading }) => `${label} ${reading.textContent}`).join(", ")}`);
    });
  }

  shown() {
    return this.groups.filter(({ on }) => on);
  }

  read(value) {
    this.at = value;
    this.chart.move();
  }

  /** The share of a group's flights at or below a value; flights without a value are at none. */
  share({ quantiles, finite, count }, value) {
    if (quantiles.length === 0) return 0;
    let low = 0;
    let high = quantiles.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (quantiles[middle] <= value) low = middle + 1;
      else high = middle;
    }
    return ((low / quantiles.length) * finite) / count;
  }

  paint() {
    const { chart } = this;
    const { context } = chart;
    const greatest = this.cumulative ? 1 : 1.05 * Math.max(1e-6, ...this.shown().map(({ bins, count }) => Math.max(...bins) / Math.max(count, 1)));
    chart.range({ least: this.least, greatest: this.greatest, logarithmic: this.logarithmic }, { least: 0, greatest });
    context.clearRect(0, 0, chart.width, chart.height);
    chart.axes(this.unit, "share");
    chart.clipped(() => {
      for (const group of this.shown()) (this.cumulative ? this.paintShare(context, group) : this.paintBars(context, group));
      if (this.bound !== null) {
        const x = chart.x(this.bound);
        context.strokeStyle = color("ink");
        context.setLineDash([3, 3]);
        chart.line([[x, 0], [x, chart.height]]);
        context.setLineDash([]);
        context.fillStyle = color("ink");
        context.textAlign = x > chart.width / 2 ? "right" : "left";
        context.textBaseline = "top";
        context.fillText(`bound ${measure(this.bound, this.unit)}`, x + (x > chart.width / 2 ? -5 : 5), 6);
      }
    });
  }

  /** The value at an edge between bars. */
  edge(place, bins) {
    const part = place / bins.length;
    return this.logarithmic ? this.least * (this.greatest / this.least) ** part : this.least + part * (this.greatest - this.least);
  }

  paintBars(context, { bins, count, color: name, line }) {
    const { chart } = this;
    const outline = [[chart.x(this.least), chart.y(0)]];
    bins.forEach((bin, place) => {
      const y = chart.y(bin / Math.max(count, 1));
      outline.push([chart.x(this.edge(place, bins)), y], [chart.x(this.edge(place + 1, bins)), y]);
    });
    outline.push([chart.x(this.greatest), chart.y(0)]);
    context.strokeStyle = context.fillStyle = color(name);
    context.lineWidth = 1.5;
    context.setLineDash(PATTERNS[line]);
    chart.line(outline);
    context.setLineDash([]);
    context.globalAlpha = 0.18;
    context.fill();
    context.globalAlpha = 1;
  }

  paintShare(context, { quantiles, finite, count, color: name, line }) {
    const { chart } = this;
    context.strokeStyle = color(name);
    context.lineWidth = 1.75;
    const points = [...quantiles].map((value, place) => [chart.x(value), chart.y(((place / (quantiles.length - 1)) * finite) / Math.max(count, 1))]);
    context.setLineDash(PATTERNS[line]);
    if (points.length > 0) chart.line([...points, [chart.x(this.greatest), points[points.length - 1][1]]]);
    context.setLineDash([]);
  }

  mark(context) {
    const { chart } = this;
    for (const group of this.groups) {
      group.reading.textContent = this.at === null ? `${group.count} flights` : `${short(100 * this.share(group, this.at))} % up to ${measure(this.at, this.unit)}`;
    }
    if (this.at === null) return;
    chart.cursor(context, this.at);
  }
}

document.querySelectorAll("figure[data-distribution]").forEach((figure) => new Spread(figure, data.distributions[figure.dataset.distribution]));
