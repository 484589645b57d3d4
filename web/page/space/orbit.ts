// The camera's way around its target: by pointer, by two fingers, by wheel, by keys.

import { Vector3, type PerspectiveCamera } from "three";

/** rad. */
const FIRST_AZIMUTH = -1.15;
const FIRST_ELEVATION = 0.42;
const GREATEST_ELEVATION = 1.5;
const KEY_TURN = 0.1;

/** rad for a CSS pixel. */
const TURN = 0.007;

/** Factors of the distance. */
const KEY_ZOOM = 1.15;
const WHEEL_ZOOM = 1.0015;

/** How near and how far, as factors of the distance from which everything is seen. */
const NEAREST = 0.05;
const FARTHEST = 8;

export class Orbit {
  readonly target = new Vector3();
  private azimuth = FIRST_AZIMUTH;
  private elevation = FIRST_ELEVATION;
  private distance = 1;
  private whole = 1;
  private readonly fingers = new Map<number, { x: number; y: number }>();

  constructor(canvas: HTMLCanvasElement, private readonly changed: () => void) {
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(end, ({ pointerId }) => this.fingers.delete(pointerId));
    }
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    canvas.addEventListener("keydown", (event) => this.key(event));
    // A page that is scrolled must not be caught by the view: the wheel zooms only a view that was chosen.
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      this.zoom(WHEEL_ZOOM ** event.deltaY);
    }, { passive: false });
  }

  /** Looks at everything within `radius`, m, of the target. */
  fit(radius: number, camera: PerspectiveCamera): void {
    const half = (camera.fov / 2) * (Math.PI / 180);
    const narrower = Math.min(half, Math.atan(Math.tan(half) * camera.aspect));
    this.whole = radius / Math.sin(narrower);
    this.distance = this.whole;
  }

  aim(camera: PerspectiveCamera): void {
    const across = Math.cos(this.elevation) * this.distance;
    camera.position.set(
      this.target.x + across * Math.cos(this.azimuth),
      this.target.y + across * Math.sin(this.azimuth),
      this.target.z + Math.sin(this.elevation) * this.distance,
    );
    camera.near = this.distance / 100;
    camera.far = this.distance * 20;
    camera.lookAt(this.target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  private drag(event: PointerEvent): void {
    const finger = this.fingers.get(event.pointerId);
    if (finger === undefined) return;
    const apart = this.spread();
    const [across, down] = [event.clientX - finger.x, event.clientY - finger.y];
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const share = 1 / this.fingers.size;
    if (apart > 0) this.zoom(apart / this.spread());
    this.turn(-across * TURN * share, down * TURN * share);
  }

  /** How far two fingers are apart; 0 for one. */
  private spread(): number {
    const [a, b] = this.fingers.values();
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) || 1 : 0;
  }

  private key(event: KeyboardEvent): void {
    const moves: Record<string, () => void> = {
      ArrowLeft: () => this.turn(-KEY_TURN, 0),
      ArrowRight: () => this.turn(KEY_TURN, 0),
      ArrowUp: () => this.turn(0, KEY_TURN),
      ArrowDown: () => this.turn(0, -KEY_TURN),
      "+": () => this.zoom(1 / KEY_ZOOM),
      "=": () => this.zoom(1 / KEY_ZOOM),
      "-": () => this.zoom(KEY_ZOOM),
    };
    const move = moves[event.key];
    if (move === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    move();
  }

  private turn(azimuth: number, elevation: number): void {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.max(this.elevation + elevation, -0.2), GREATEST_ELEVATION);
    this.changed();
  }

  private zoom(factor: number): void {
    this.distance = Math.min(Math.max(this.distance * factor, NEAREST * this.whole), FARTHEST * this.whole);
    this.changed();
  }
}
