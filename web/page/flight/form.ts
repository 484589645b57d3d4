// What to fly: the form's controls as a request, and a request as the form's controls.

import type { FlightRequest, Task, Verdict } from "../api";
import { element, make } from "../dom";
import { onChoice } from "../vehicle/files";
import type { Vehicle } from "../vehicle/editor";

const TASKS: readonly Task[] = ["upside_down", "wind", "circle", "step", "own"];

/** m/s: what blows once the task is a gust and no wind was chosen. */
const USUAL_GUST = 6;

export class FlightForm {
  private readonly form = element("flight-form", HTMLFormElement);
  private readonly button = element("fly", HTMLButtonElement);
  private readonly task = element("task", HTMLSelectElement);
  private readonly wind = element("wind", HTMLInputElement);
  private readonly mass = element("mass", HTMLInputElement);
  private readonly rotor = element("weak-rotor", HTMLSelectElement);
  private readonly share = element("weak-share", HTMLInputElement);
  private readonly indi = element("indi", HTMLInputElement);
  private path: Vehicle | null = null;
  /** kg, in the file of the vehicle that there is to fly. */
  private fileMass: number | null = null;

  /** `changed` after a control changed, `fly` after the button was pressed. */
  constructor(changed: () => void, fly: () => void, refused: (why: string) => void) {
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      fly();
    });
    this.task.addEventListener("change", () => {
      if (this.task.value === "wind" && Number(this.wind.value) === 0) this.wind.value = String(USUAL_GUST);
    });
    this.form.addEventListener("input", (event) => {
      this.describe();
      if (event.target !== element("path-file", HTMLInputElement)) changed();
    });
    onChoice("path-file", (read) => {
      if ("refused" in read) return refused(read.refused);
      this.takePath(read);
      changed();
    });
    this.describe();
  }

  get request(): FlightRequest {
    return {
      task: this.task.value as Task,
      wind: Number(this.wind.value),
      mass: Number(this.mass.value),
      weak_rotor: Number(this.rotor.value),
      weak_share: Number(this.share.value) / 100,
      ...(this.path && { trajectory: this.path.text, trajectory_file: this.path.file }),
      laws: this.indi.checked ? ["ours", "indi"] : ["ours"],
    };
  }

  /** Sets the controls; a range takes the nearest value that it has. */
  set request(request: FlightRequest) {
    this.task.value = TASKS.includes(request.task) ? request.task : "upside_down";
    this.wind.value = String(request.wind);
    this.mass.value = String(request.mass);
    this.offerRotors(Math.max(request.weak_rotor, this.rotor.options.length - 1));
    this.rotor.value = String(request.weak_rotor);
    this.share.value = String(100 * request.weak_share);
    this.indi.checked = request.laws.includes("indi");
    if (request.trajectory) this.takePath({ file: request.trajectory_file ?? "path.csv", text: request.trajectory });
    this.describe();
  }

  /** Whether there is something to fly: a path of one's own may still be missing. */
  get complete(): boolean {
    return this.task.value !== "own" || this.path !== null;
  }

  /** A path of one's own: it is the task from now on. */
  takePath(path: Vehicle): void {
    this.path = path;
    this.task.value = "own";
    element("path-name", HTMLElement).textContent = path.file;
    this.describe();
  }

  /** Fits the controls to this vehicle. */
  fit(verdict: Verdict): void {
    this.fileMass = verdict.mass;
    this.offerRotors(verdict.rotors.length);
    this.describe();
  }

  /** Shows whether it flies, may fly, or has nothing to fly. */
  look(state: "flying" | "ready" | "nothing"): void {
    this.button.textContent = state === "flying" ? "flying…" : "FLY";
    this.button.disabled = state === "nothing";
    if (state === "nothing") this.fileMass = null;
    this.describe();
  }

  private offerRotors(count: number): void {
    const chosen = Number(this.rotor.value);
    const options = Array.from({ length: count }, (_, i) => make("option", { value: String(i + 1) }, `rotor ${i + 1}`));
    this.rotor.replaceChildren(make("option", { value: "0" }, "none"), ...options);
    this.rotor.value = String(chosen <= count ? chosen : 0);
  }

  private describe(): void {
    const say = (id: string, words: string) => (element(id, HTMLOutputElement).value = words);
    const mass = Number(this.mass.value);
    const kilograms = this.fileMass === null ? "" : ` (${(mass * this.fileMass).toPrecision(3)} kg)`;
    say("wind-said", `${this.wind.value} m/s`);
    say("mass-said", `${mass.toFixed(2)} ×${kilograms}`);
    this.share.disabled = this.rotor.value === "0";
    say("weak-said", `${this.share.value} % of its command`);
    element("path-part", HTMLElement).hidden = this.task.value !== "own";
  }
}
