// Which plots there are: their lines, units, limits and proven bounds, from the answer to a flight.

import type { FlightAnswer, Flown } from "../api";
import { LAWS } from "../flight/figures";
import { tickAt } from "../flight/pose";
import { quantity, short } from "../numbers";

export interface Line {
  label: string;
  /** A colour of the page's style. */
  colour: string;
  dashed: boolean;
  /** One value a time; null after the flight's end. */
  values: (number | null)[];
}

export interface Bound {
  value: number;
  kind: "limit" | "proven";
}

export interface Plan {
  title: string;
  unit: string;
  times: number[];
  lines: Line[];
  bounds: Bound[];
  /** The bounds in words. */
  words: string;
  /** Least and greatest value that is always within the plot. */
  within: [number, number];
}

/** What a plot takes from a tick. */
type Pick = (flown: Flown, tick: number) => number | undefined;

/** Colours for rotors, in order; more rotors begin anew. */
const ROTOR_COLOURS = 8;

/** What a plot shows at least, so that rounding does not fill it: m, degrees, and of a torque's limit. */
const LEAST_ERROR = 1e-3;
const LEAST_TILT = 1;
const LEAST_SHARE = 1e-2;

const AXES = ["roll", "pitch", "yaw"] as const;

export function plans(answer: FlightAnswer): Plan[] {
  const { flights, bounds } = answer;
  const longest = flights.reduce((a, b) => ((b.t.at(-1) ?? 0) > (a.t.at(-1) ?? 0) ? b : a), flights[0] as Flown);
  const times = longest.t;
  const both = (pick: Pick): Line[] =>
    flights.map((flown) => ({
      label: LAWS[flown.law],
      colour: `--${flown.law}`,
      dashed: flown.law === "indi",
      values: sampled(flown, times, pick),
    }));
  const plan = (title: string, unit: string, pick: Pick, within: [number, number] = [0, 0]): Plan => {
    return { title, unit, times, lines: both(pick), bounds: [], words: "", within };
  };

  const proven = bounds.proven;
  const thrust = plan("Total thrust", "N", (flown, i) => flown.thrust[i]);
  thrust.bounds = [limit(bounds.thrust_max), ...(proven?.thrust ?? []).map(provenBound)];
  thrust.words = `limit ${quantity(bounds.thrust_max, "N")}`;
  if (proven) thrust.words += `, proven ${short(proven.thrust[0])} to ${quantity(proven.thrust[1], "N")}`;

  const torques = AXES.map((axis, k) => {
    const most = bounds.torque_max[k] ?? 0;
    const least = LEAST_SHARE * most;
    const made = plan(`Torque, ${axis}`, "N m", (flown, i) => flown.torque[i]?.[k], [-least, least]);
    const held = proven?.torque[k];
    made.bounds = [limit(most), limit(-most), ...(held === undefined ? [] : [provenBound(held), provenBound(-held)])];
    made.words = `limit ±${quantity(most, "N m")}${held === undefined ? "" : `, proven ±${quantity(held, "N m")}`}`;
    return made;
  });

  return [
    plan("Position error", "m", (flown, i) => flown.position_error[i], [0, LEAST_ERROR]),
    plan("Tilt", "°", (flown, i) => flown.tilt[i], [0, LEAST_TILT]),
    thrust,
    ...torques,
    ...flights.filter(({ rotors }) => (rotors[0]?.length ?? 0) > 0).map((flown) => rotorPlan(flown, times, bounds)),
  ];
}

function rotorPlan(flown: Flown, times: number[], { rotor }: FlightAnswer["bounds"]): Plan {
  const count = flown.rotors[0]?.length ?? 0;
  return {
    title: `Rotor thrusts, ${LAWS[flown.law]}`,
    unit: "N",
    times,
    lines: Array.from({ length: count }, (_, k) => ({
      label: String(k + 1),
      colour: `--line-${(k % ROTOR_COLOURS) + 1}`,
      dashed: flown.law === "indi",
      values: sampled(flown, times, (each, i) => each.rotors[i]?.[k]),
    })),
    bounds: rotor ? rotor.map(limit) : [],
    words: rotor ? `range ${short(rotor[0])} to ${quantity(rotor[1], "N")}` : "",
    within: [0, 0],
  };
}

function limit(value: number): Bound {
  return { value, kind: "limit" };
}

function provenBound(value: number): Bound {
  return { value, kind: "proven" };
}

/** A flight's values at the times of the plot; null once it has ended. */
function sampled(flown: Flown, times: number[], pick: Pick): (number | null)[] {
  const end = flown.t.at(-1) ?? 0;
  const tick = times.length > 1 ? ((times.at(-1) ?? 0) - (times[0] ?? 0)) / (times.length - 1) : 0;
  return times.map((time) =>
    time > end + tick / 2 ? null : (pick(flown, Math.round(tickAt(flown.t, time))) ?? null),
  );
}
