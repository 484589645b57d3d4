// How numbers are written on the page: few digits, no exponents where a person would write none.

const DIGITS = 3;

/** Beyond these a number is written with an exponent. */
const LEAST_PLAIN = 1e-3;
const GREATEST_PLAIN = 1e5;

/** Below this a distance is written in millimetres. */
const LEAST_METRES = 0.1;
const MM_PER_M = 1000;

/** No smaller distance is of interest. */
const NOTHING_METRES = 1e-5;

/** A number with three significant digits. */
export function short(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < LEAST_PLAIN || size >= GREATEST_PLAIN) return minus(value.toExponential(DIGITS - 1));
  return minus(String(Number(value.toPrecision(DIGITS))));
}

/** A number with its unit. */
export function quantity(value: number, unit: string): string {
  return unit ? `${short(value)} ${typeset(unit)}` : short(value);
}

/** Metres, or millimetres where that reads better. */
export function distance(metres: number): string {
  if (Math.abs(metres) < NOTHING_METRES) return `below ${quantity(MM_PER_M * NOTHING_METRES, "mm")}`;
  return Math.abs(metres) < LEAST_METRES ? quantity(MM_PER_M * metres, "mm") : quantity(metres, "m");
}

/** Powers as they are written by hand: m/s² for m/s^2. */
export function typeset(text: string): string {
  return text.replaceAll("^2", "²").replaceAll("^3", "³").replaceAll("^4", "⁴");
}

/** A share as per cent. */
export function percent(share: number): string {
  const value = 100 * share;
  return `${minus(value.toFixed(Math.abs(value) < 10 ? 1 : 0))} %`;
}

function minus(text: string): string {
  return text.replaceAll("-", "−");
}
