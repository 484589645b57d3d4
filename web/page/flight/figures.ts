// The figures of a flight as a table, a column for each law, and what is to be said about a flight.

import type { Flown } from "../api";
import { element, fill, make } from "../dom";
import { distance, quantity } from "../numbers";

/** How the laws are called on this page. */
export const LAWS: Record<Flown["law"], string> = { ours: "this controller", indi: "INDI" };

/** A figure's name, and its words for one flight. */
const FIGURES: readonly [string, (flown: Flown, rate: number) => string][] = [
  ["Height lost", ({ figures }) => distance(figures.height_lost)],
  ["Within 0.1 m for good after", ({ figures }) =>
    figures.settled === null ? "not in this flight" : quantity(figures.settled, "s")],
  ["Error at the end", ({ figures }) => distance(figures.end_error)],
  ["Commands cut by a limit, in all", ({ figures }, rate) =>
    figures.cut === 0 ? "never" : quantity(figures.cut / rate, "s")],
];

/** `rate`: ticks a second. */
export function showFigures(flights: Flown[], what: string, rate: number): void {
  const table = element("figures", HTMLTableElement);
  const heads = flights.map(({ law }) => make("th", { scope: "col", class: `law ${law}` }, LAWS[law]));
  table.tHead?.rows[0]?.replaceChildren(make("th", { scope: "col" }, "Figure"), ...heads);
  table.tBodies[0]?.replaceChildren(
    ...FIGURES.map(([name, words]) =>
      make("tr", {}, make("th", { scope: "row" }, name), ...flights.map((flown) => make("td", {}, words(flown, rate)))),
    ),
  );
  if (table.caption) table.caption.textContent = what;
  fill(element("flight-notes", HTMLElement), flights.flatMap(notes));
}

function notes({ law, note, ended }: Flown): string[] {
  const said = [];
  if (ended !== null) said.push(`${LAWS[law]}: the flight ended early: ${ended}`);
  if (note) said.push(note);
  return said;
}
