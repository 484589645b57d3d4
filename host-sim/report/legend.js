// A legend: how each curve looks, what it reads at the cursor, and whether it is shown.

/** Dashes and gaps of each kind of line, pixels. */
const PATTERNS = { solid: [], dashed: [5, 4], dotted: [2, 3] };

/** Gives every entry its reading, and a button that hides it or shows it again. */
function legend(entries, redraw) {
  const list = make("ul", { class: "legend" });
  for (const entry of entries) {
    entry.on = true;
    entry.reading = make("span", { class: "reading" });
    const swatch = make("span", { class: `swatch ${entry.line}` });
    swatch.style.borderColor = `var(--${entry.color})`;
    const press = () => {
      entry.on = !entry.on;
      toggle.setAttribute("aria-pressed", entry.on);
      redraw();
    };
    const toggle = make("button", { type: "button", "aria-pressed": "true", click: press }, swatch, entry.label, entry.reading);
    list.append(make("li", {}, toggle));
  }
  return list;
}

