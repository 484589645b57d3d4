// The rows of the certificate and the loops of the analysis, as tables.

import type { Loop, Row } from "../api";
import { make } from "../dom";
import { percent, quantity, short } from "../numbers";

const MS_PER_S = 1000;

/** A row: what it is, how much is left of the available, as a bar and in words, and the two numbers. */
export function row({ name, meaning, margin, holds, required, available, unit }: Row): HTMLTableRowElement {
  const what = make("th", { scope: "row" }, name);
  const told = holds ? subject(meaning) : meaning;
  if (told) what.append(make("span", { class: "meaning" }, told));
  const words = judged(holds, holds ? "holds" : "FAILS");
  const left = make("td", { class: "number" }, words, `, ${percent(margin)}`, bar(margin));
  const needed = make("td", { class: "number" }, quantity(required, unit));
  const there = make("td", { class: "number" }, quantity(available, unit));
  return make("tr", { class: holds ? "holds" : "fails" }, what, left, needed, there);
}

export function loop({ axis, verdict, holds, gain_down, gain_up, delay, radius }: Loop): HTMLTableRowElement {
  return make(
    "tr",
    { class: holds ? "holds" : "fails" },
    make("th", { scope: "row" }, axis),
    make("td", {}, judged(holds, verdict)),
    number(gain_down === null ? "—" : short(gain_down)),
    number(gain_up === null ? "—" : short(gain_up)),
    number(delay === null ? "—" : quantity(delay * MS_PER_S, "ms")),
    number(short(radius)),
  );
}

/** What a row is about. The rest of its meaning is what to change, which only a row that fails needs. */
function subject(meaning: string): string {
  return meaning.split(/[.:;](?:\s|$)/, 1)[0] ?? "";
}

function number(text: string): HTMLElement {
  return make("td", { class: "number" }, text);
}

/** A judgement in words; the style adds a sign. */
function judged(holds: boolean, words: string): HTMLElement {
  return make("span", { class: holds ? "judged yes" : "judged no" }, words);
}

/** The share that is left, of the whole bar. What is lacking is drawn as a full bar in the colour of failure. */
function bar(margin: number): HTMLElement {
  const inner = make("span");
  inner.style.inlineSize = `${100 * Math.min(1, Math.abs(margin))}%`;
  return make("span", { class: "bar", "aria-hidden": "true" }, inner);
}
