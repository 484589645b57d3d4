// The flight's part of the page: what is said while it is computed, its figures, its replay.

import type { FlightAnswer, FlightRequest, Verdict } from "../api";
import { element, say } from "../dom";
import { showFigures } from "./figures";
import { Replay } from "./replay";

const TASKS: Record<FlightRequest["task"], string> = {
  upside_down: "from upside down",
  wind: "in a gust",
  circle: "a circle of 3 m",
  step: "1 m to the side",
  own: "a path of your own",
};

export class FlightPanel {
  private readonly replay = new Replay();
  private readonly body = element("flight-body", HTMLElement);
  private readonly error = element("flight-error", HTMLElement);
  private shown = "";

  /** Begins to load what draws, while the flight is computed. A failure shows when it is needed. */
  prepare(): void {
    this.replay.prepare().catch(() => undefined);
  }

  wait(): void {
    this.body.classList.add("stale");
    say(this.error, null);
  }

  refuse(reason: string): void {
    say(this.error, reason);
  }

  /** There is nothing to show. */
  none(): void {
    this.body.hidden = true;
    say(this.error, null);
  }

  async show(answer: FlightAnswer, request: FlightRequest, verdict: Verdict): Promise<void> {
    this.body.hidden = false;
    this.body.classList.remove("stale");
    showFigures(answer.flights, `${verdict.name}, ${described(request)}`, verdict.rate);
    const what = `${verdict.name} ${request.task}`;
    await this.replay.show({ answer, rotors: verdict.rotors, mass: verdict.mass }, what !== this.shown);
    this.shown = what;
  }
}

function described({ task, wind, mass, weak_rotor, weak_share }: FlightRequest): string {
  const parts = [TASKS[task]];
  if (wind > 0) parts.push(`wind ${wind} m/s`);
  if (mass !== 1) parts.push(`${mass.toFixed(2)} times the mass`);
  if (weak_rotor > 0 && weak_share < 1) parts.push(`rotor ${weak_rotor} at ${Math.round(100 * weak_share)} %`);
  return parts.join(", ");
}
