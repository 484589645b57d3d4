// Words that stand at places of the scene, drawn by the page rather than by the scene, so that they stay legible.

import { Vector3, type Camera } from "three";
import { make } from "../dom";

export interface Label {
  at: Vector3;
  element: HTMLElement;
}

export class Labels {
  readonly layer = make("div", { class: "labels", "aria-hidden": "true" });
  private readonly labels: Label[] = [];
  private readonly projected = new Vector3();

  add(text: string, kind: string, at = new Vector3()): Label {
    const label = { at, element: make("span", { class: kind }, text) };
    this.labels.push(label);
    this.layer.append(label.element);
    return label;
  }

  clear(): void {
    this.labels.length = 0;
    this.layer.replaceChildren();
  }

  /** Puts every label where its place is seen now. */
  place(camera: Camera, width: number, height: number): void {
    for (const { at, element } of this.labels) {
      const { x, y, z } = this.projected.copy(at).project(camera);
      element.style.visibility = Math.abs(x) < 1 && Math.abs(y) < 1 && z < 1 ? "" : "hidden";
      element.style.transform = `translate(${((x + 1) / 2) * width}px, ${((1 - y) / 2) * height}px)`;
    }
  }
}
