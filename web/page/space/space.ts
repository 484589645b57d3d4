// The flight in three dimensions: vehicles, their trails, the reference, the ground, the wind.

import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, Float32BufferAttribute, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import type { Flown } from "../api";
import { make } from "../dom";
import { LAWS } from "../flight/figures";
import { pointAt, poseAt } from "../flight/pose";
import { colour, extent, type Shown, type View } from "../flight/view";
import { Craft } from "./craft";
import { Ground } from "./ground";
import { Labels, type Label } from "./labels";
import { Orbit } from "./orbit";
import { Trail } from "./trail";
import { Wind } from "./wind";

/** Degrees. */
const FIELD_OF_VIEW = 40;

/** m: a flight that stays in one place is seen from this far around. */
const LEAST_RADIUS = 0.8;

/** Room around the path for the vehicle and its arrows. */
const MARGIN = 1.3;

/** m: the ground is seen below flights that are not higher. */
const GREATEST_HEIGHT = 4;

/** A vehicle that is smaller than this share of the scene is drawn larger, up to so many times. */
const SEEN_SIZE = 0.13;
const GREATEST_SIZE = 60;

/** In arms: how much is seen around a vehicle that is followed. */
const FOLLOWED = 4;

/** CSS pixels. */
const TRAIL_WIDTH = 3;
const REFERENCE_WIDTH = 1.5;

/** Of the radius that is seen. */
const REFERENCE_BALL = 0.014;

interface Actor {
  flown: Flown;
  craft: Craft;
  trail: Trail;
  label: Label;
  plumb: LineSegments;
}

export class Space implements View {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1);
  private readonly labels = new Labels();
  private readonly orbit: Orbit;
  private readonly centre = new Vector3();
  private content = new Group();
  private actors: Actor[] = [];
  private ball = new Mesh();
  private wind: Wind | null = null;
  private shown: Shown | null = null;
  private radius = 1;
  private ground = 0;
  private enlarged = 1;
  private following = false;
  private time = 0;

  /** Throws where the browser has no WebGL. `note` gets a remark on the picture. */
  constructor(private readonly place: HTMLElement, private readonly note: (words: string) => void) {
    const canvas = make("canvas", { tabindex: "0", role: "img", "aria-describedby": "view-note" });
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.orbit = new Orbit(canvas, () => this.draw(this.time));
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(-1, -2, 4);
    this.scene.add(new AmbientLight(0xffffff, 1.6), sun);
    place.replaceChildren(canvas, this.labels.layer);
    new ResizeObserver(() => this.resize()).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      if (this.shown) this.show(this.shown, false);
      this.draw(this.time);
    });
    this.resize();
  }

  show(shown: Shown, fit: boolean): void {
    this.shown = shown;
    this.clear();
    this.scene.background = new Color(colour("--sky"));
    const box = extent(shown);
    const [least, most] = [new Vector3(...box.least), new Vector3(...box.most)];
    this.addGround(least, most);
    // The ground tells the height, where it is not too far down.
    if (least.z - this.ground < GREATEST_HEIGHT) least.z = this.ground;
    this.centre.addVectors(least, most).multiplyScalar(0.5);
    this.radius = Math.max(LEAST_RADIUS, 0.5 * least.distanceTo(most)) * MARGIN;
    const grey = colour("--reference");
    this.ball = new Mesh(new SphereGeometry(REFERENCE_BALL), new MeshBasicMaterial({ color: grey }));
    this.content.add(this.ball, new Trail(shown.answer.reference, grey, REFERENCE_WIDTH));
    this.actors = shown.answer.flights.map((flown) => this.actor(flown, shown));
    this.wind = Wind.of(shown.answer.wind, shown.answer.wind_start, this.labels);
    if (this.wind) this.content.add(this.wind);
    this.scene.add(this.content);
    this.describe(shown);
    if (fit) this.frame();
  }

  follow(on: boolean): void {
    this.following = on;
    this.frame();
    this.draw(this.time);
  }

  draw(time: number): void {
    this.time = time;
    if (this.shown === null) return;
    const { reference, flights } = this.shown.answer;
    this.ball.position.set(...pointAt(reference, flights[0]?.t ?? [], time));
    for (const actor of this.actors) this.move(actor, time);
    this.ball.scale.setScalar(this.seen());
    this.orbit.target.copy((this.following && this.actors[0]?.craft.position) || this.centre);
    this.wind?.at(time, this.orbit.target, this.seen());
    this.orbit.aim(this.camera);
    this.renderer.render(this.scene, this.camera);
    this.labels.place(this.camera, this.place.clientWidth, this.place.clientHeight);
  }

  private move({ flown, craft, trail, label, plumb }: Actor, time: number): void {
    craft.pose(poseAt(flown, time));
    craft.scale.setScalar(this.enlarged);
    trail.until(flown.t, time);
    label.at.copy(craft.position);
    plumb.position.set(craft.position.x, craft.position.y, this.ground);
    plumb.scale.z = craft.position.z - this.ground;
  }

  private actor(flown: Flown, { rotors, mass }: Shown): Actor {
    const tint = colour(`--${flown.law}`);
    const craft = new Craft(rotors, mass, tint, colour("--craft"));
    const trail = new Trail(flown.position, tint, TRAIL_WIDTH);
    const down = new BufferGeometry().setAttribute("position", new Float32BufferAttribute([0, 0, 0, 0, 0, 1], 3));
    const plumb = new LineSegments(down, new LineBasicMaterial({ color: tint, transparent: true, opacity: 0.5 }));
    this.content.add(craft, trail, plumb);
    return { flown, craft, trail, plumb, label: this.labels.add(LAWS[flown.law], `name ${flown.law}`) };
  }

  private addGround(least: Vector3, most: Vector3): void {
    const ground = new Ground(least, most, colour("--grid"));
    this.ground = ground.height;
    this.content.add(ground);
    for (const { text, at } of ground.names) this.labels.add(text, "metres", at);
  }

  /** Sets the camera's distance, and how large vehicles are drawn: large enough to be seen, or true to scale. */
  private frame(): void {
    const arm = this.actors[0]?.craft.arm ?? 1;
    const wanted = Math.round((SEEN_SIZE * this.radius) / arm);
    this.enlarged = this.following ? 1 : Math.min(Math.max(1, wanted), GREATEST_SIZE);
    this.orbit.fit(this.seen(), this.camera);
    const size = this.enlarged > 1 ? `The vehicles are drawn ${this.enlarged} times their size. ` : "";
    this.note(`${size}Grey: reference. Arrows: each rotor's thrust. Turn: drag, or arrow keys. Nearer: + and −.`);
  }

  /** m: how much around the target is seen. */
  private seen(): number {
    return this.following ? FOLLOWED * (this.actors[0]?.craft.arm ?? 1) : this.radius;
  }

  private describe({ answer }: Shown): void {
    const who = answer.flights.map(({ law }) => LAWS[law]).join(" and ");
    this.renderer.domElement.setAttribute(
      "aria-label", `The flight in three dimensions: ${who}. The table of figures and the plots have the numbers.`,
    );
  }

  private resize(): void {
    const [width, height] = [this.place.clientWidth, this.place.clientHeight];
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.draw(this.time);
  }

  private clear(): void {
    this.labels.clear();
    this.scene.remove(this.content);
    this.content.traverse((part) => {
      const { geometry, material } = part as Partial<Mesh>;
      geometry?.dispose();
      for (const each of [material ?? []].flat()) each.dispose();
    });
    this.content = new Group();
  }
}
