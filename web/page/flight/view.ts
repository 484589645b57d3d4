// What every view of a flight does, whether in three dimensions or in two.

import type { FlightAnswer, Verdict } from "../api";

/** What is to be seen. */
export interface Shown {
  answer: FlightAnswer;
  rotors: Verdict["rotors"];
  /** kg. */
  mass: number;
}

export interface View {
  /** Shows another flight; `fit` moves the camera so that all of it is seen. */
  show(shown: Shown, fit: boolean): void;
  /** Draws the instant `time`, s. */
  draw(time: number): void;
  follow(on: boolean): void;
}

/** The box that the reference and our flight need: a rival that is lost must not make everything else small. */
export function extent({ answer }: Shown): { least: [number, number, number]; most: [number, number, number] } {
  const ours = answer.flights.find(({ law }) => law === "ours") ?? answer.flights[0];
  const least: [number, number, number] = [Infinity, Infinity, Infinity];
  const most: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const point of [...answer.reference, ...(ours?.position ?? [])]) {
    for (const k of [0, 1, 2] as const) {
      least[k] = Math.min(least[k], point[k]);
      most[k] = Math.max(most[k], point[k]);
    }
  }
  return { least, most };
}

/** A colour of the page's style, as `#rrggbb` or `rgb(…)`. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
