// The page's data, the shared clock, and small helpers that every part uses.

const data = JSON.parse(document.getElementById("data").textContent);

/** The numbers behind base64 of little-endian single precision, the order of bytes of every machine with a browser. */
function decode(text) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

/** Columns over evenly spaced times; a column is decoded when it is first read. */
class Track {
  constructor({ name, start, step, columns }) {
    Object.assign(this, { name, start, step, columns });
    this.decoded = new Map();
    const first = Object.keys(columns)[0];
    this.rows = first === undefined ? 0 : this.column(first).length;
    this.end = start + step * this.rows;
  }

  column(name) {
    if (!this.decoded.has(name)) {
      const text = this.columns[name];
      this.decoded.set(name, text === undefined ? null : decode(text));
    }
    return this.decoded.get(name);
  }

  time(row) {
    return this.start + this.step * row;
  }

  /** The last row at or before a time. */
  row(time) {
    const row = Math.floor((time - this.start) / this.step + 1e-6);
    return Math.min(Math.max(row, 0), Math.max(this.rows - 1, 0));
  }

  /** A column's value at the last row at or before a time; NaN where there is none. */
  value(name, time) {
    const column = this.column(name);
    return column && this.rows > 0 ? column[this.row(time)] : NaN;
  }
}

const tracks = data.tracks.map((track) => new Track(track));
const flightEnd = Math.max(1e-9, ...tracks.map((track) => track.end));

/** The time that plots and replay show, s. A flight ends one row after its last. */
const clock = {
  time: 0,
  listeners: [],
  set(time) {
    this.time = Math.min(Math.max(time, 0), flightEnd);
    this.listeners.forEach((listener) => listener(this.time));
  },
};

/** Four significant digits, without trailing zeros. */
function short(value) {
  if (!Number.isFinite(value)) return "none";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(2).replace("-", "−").replace("e−", "e-");
  const digits = size === 0 ? 0 : Math.min(Math.max(3 - Math.floor(Math.log10(size)), 0), 6);
  const text = value.toFixed(digits);
  return (text.includes(".") ? text.replace(/\.?0+$/, "") : text).replace("-", "−");
}

/** A value with its unit. */
function measure(value, unit) {
  if (!Number.isFinite(value) || unit === "") return short(value);
  return unit === "°" ? `${short(value)}°` : `${short(value)} ${unit}`;
}

/** An element with attributes, listeners (functions) and children. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** A button; `label` is said where the sign alone says too little. */
function button(sign, label, press) {
  return make("button", { type: "button", "aria-label": label, title: label, click: press }, sign);
}

/** The style sheet's colour of that name, as it is at the moment: light, dark or printed. */
function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Announces to a screen reader, once the keys have come to rest. */
let announcing = 0;
function announce(text) {
  clearTimeout(announcing);
  announcing = setTimeout(() => (document.getElementById("live").textContent = text), 400);
}

/** What is drawn again whenever colours change: another scheme, or paper. */
const repaints = [];
function repaint() {
  repaints.forEach((paint) => paint());
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
addEventListener("beforeprint", () => {
  document.documentElement.dataset.print = "";
  document.querySelectorAll("details:has(> .tables)").forEach((details) => (details.open = true));
  repaint();
});
addEventListener("afterprint", () => {
  delete document.documentElement.dataset.print;
  repaint();
});

