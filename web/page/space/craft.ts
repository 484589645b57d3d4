// A vehicle: arms, rotor discs, a nose that points forward, and an arrow for the thrust of each rotor.

import {
  BoxGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, RingGeometry, Vector3,
} from "three";
import type { Verdict } from "../api";
import type { Pose, Triple } from "../flight/pose";
import { Arrow } from "./arrow";

/** m/s². */
const GRAVITY = 9.81;

/** m: the arm of a vehicle whose file has no rotors. */
const NOMINAL_ARM = 0.15;

/** Of the arm. */
const BODY = [0.36, 0.22, 0.12] as const;
const BEAM = 0.03;
const NOSE = 0.09;
const NOSE_LENGTH = 0.24;
const HOVER_ARROW = 0.75;

/** Of the distance between neighbouring rotors: discs do not touch. */
const DISC = 0.42;
const DISC_RIM = 0.08;
const DISC_OPACITY = 0.3;
const SIDES = 32;

export class Craft extends Group {
  /** m, from the centre to the farthest rotor. */
  readonly arm: number;
  private readonly arrows: Arrow[] = [];
  /** m of arrow for a newton. */
  private readonly perNewton: number;

  constructor(rotors: Verdict["rotors"], mass: number, tint: string, ink: string) {
    super();
    this.arm = Math.max(...rotors.map(({ position }) => Math.hypot(...position)), 0) || NOMINAL_ARM;
    const sources = Math.max(1, rotors.length);
    this.perNewton = (HOVER_ARROW * this.arm * sources) / (mass * GRAVITY);
    const solid = new MeshLambertMaterial({ color: tint });
    const dark = new MeshLambertMaterial({ color: ink });
    this.addBody(solid, dark);
    const disc = discRadius(rotors, this.arm);
    const places: Triple[] = rotors.length > 0 ? rotors.map(({ position }) => position) : [[0, 0, 0]];
    for (const place of places) {
      if (rotors.length > 0) this.addRotor(place, disc, tint, dark);
      const arrow = new Arrow(this.arm, solid);
      arrow.position.set(...place);
      this.arrows.push(arrow);
      this.add(arrow);
    }
  }

  /** Puts the vehicle where it is. */
  pose({ position, attitude: [w, x, y, z], rotors, thrust }: Pose): void {
    this.position.set(...position);
    this.quaternion.set(x, y, z, w);
    const forces = rotors.length > 0 ? rotors : [thrust];
    this.arrows.forEach((arrow, i) => (arrow.length = this.perNewton * (forces[i] ?? 0)));
  }

  private addBody(solid: MeshLambertMaterial, dark: MeshLambertMaterial): void {
    const [length, width, height] = BODY.map((part) => part * this.arm);
    const nose = new ConeGeometry(NOSE * this.arm, NOSE_LENGTH * this.arm, SIDES);
    nose.rotateZ(-Math.PI / 2).translate(0.5 * BODY[0] * this.arm + 0.5 * NOSE_LENGTH * this.arm, 0, 0);
    this.add(new Mesh(new BoxGeometry(length, width, height), solid), new Mesh(nose, dark));
  }

  private addRotor(place: Triple, radius: number, tint: string, dark: MeshLambertMaterial): void {
    const at = new Vector3(...place);
    const length = at.length();
    const beam = new Mesh(new CylinderGeometry(BEAM * this.arm, BEAM * this.arm, length, 8), dark);
    beam.position.copy(at).multiplyScalar(0.5);
    if (length > 0) beam.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), at.clone().normalize());
    const blur = new MeshBasicMaterial({
      color: tint, side: DoubleSide, transparent: true, opacity: DISC_OPACITY, depthWrite: false,
    });
    const disc = new Mesh(new CircleGeometry(radius, SIDES), blur);
    const edge = new MeshBasicMaterial({ color: tint, side: DoubleSide });
    const rim = new Mesh(new RingGeometry((1 - DISC_RIM) * radius, radius, SIDES), edge);
    disc.position.copy(at);
    rim.position.copy(at);
    this.add(beam, disc, rim);
  }
}

function discRadius(rotors: Verdict["rotors"], arm: number): number {
  let nearest = 2 * arm;
  rotors.forEach(({ position: a }, i) => {
    for (const { position: b } of rotors.slice(i + 1)) {
      const apart = Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      if (apart > 0) nearest = Math.min(nearest, apart);
    }
  });
  return DISC * nearest;
}
