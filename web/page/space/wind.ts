// The wind as an arrow beside the flight, drawn while it blows.

import { MeshBasicMaterial, Vector3 } from "three";
import type { Triple } from "../flight/pose";
import { colour } from "../flight/view";
import { quantity } from "../numbers";
import { Arrow } from "./arrow";
import type { Label, Labels } from "./labels";

/** Of the radius that is seen: length for the strongest wind, thickness, and place from the target. */
const LENGTH = 0.9;
const THICKNESS = 0.35;
const PLACE = new Vector3(-0.8, 0.5, 0.5);

/** m/s: as long as the arrow becomes. */
const STRONGEST = 12;

const FAINT = 0.25;

export class Wind extends Arrow {
  private constructor(
    private readonly speed: number,
    private readonly start: number,
    private readonly paint: MeshBasicMaterial,
    private readonly label: Label,
  ) {
    super(THICKNESS, paint);
    this.length = LENGTH * Math.min(1, 0.3 + (0.7 * speed) / STRONGEST);
  }

  /** Null without wind. It sets in at `start`, s. */
  static of(wind: Triple, start: number, labels: Labels): Wind | null {
    const speed = Math.hypot(...wind);
    if (speed === 0) return null;
    const paint = new MeshBasicMaterial({ color: colour("--wind"), transparent: true });
    const made = new Wind(speed, start, paint, labels.add("", "name wind"));
    made.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...wind).normalize());
    return made;
  }

  /** Puts it beside the target, where `seen` m around it are seen; faint before it blows. */
  at(time: number, target: Vector3, seen: number): void {
    const blows = time >= this.start;
    this.paint.opacity = blows ? 1 : FAINT;
    this.scale.setScalar(seen);
    this.position.copy(target).addScaledVector(PLACE, seen);
    this.label.at.copy(this.position);
    this.label.element.textContent = `wind ${quantity(this.speed, "m/s")}${blows ? "" : ` from ${this.start} s on`}`;
  }
}
