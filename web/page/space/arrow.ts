// An arrow of any length along its own z axis, with a head that keeps its shape.

import { ConeGeometry, CylinderGeometry, Group, Mesh, type Material } from "three";

/** Shares of the arrow's length. */
const SHAFT = 0.035;
const HEAD = 0.1;
const HEAD_LENGTH = 0.22;
const SIDES = 10;

export class Arrow extends Group {
  private readonly shaft: Mesh;
  private readonly head: Mesh;

  /** `size` is a length, m: how thick the arrow is. */
  constructor(private readonly size: number, material: Material) {
    super();
    const shaft = new CylinderGeometry(SHAFT * size, SHAFT * size, 1, SIDES);
    shaft.rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const head = new ConeGeometry(HEAD * size, HEAD_LENGTH * size, SIDES);
    head.rotateX(Math.PI / 2).translate(0, 0, (HEAD_LENGTH * size) / 2);
    this.shaft = new Mesh(shaft, material);
    this.head = new Mesh(head, material);
    this.add(this.shaft, this.head);
  }

  /** m. Nothing is drawn of an arrow shorter than its own thickness. */
  set length(length: number) {
    const least = SHAFT * this.size;
    this.visible = Math.abs(length) > least;
    this.shaft.scale.z = Math.max(Math.abs(length), least);
    this.head.position.z = this.shaft.scale.z;
    this.rotation.x = length < 0 ? Math.PI : 0;
  }
}
