// Where the vehicle comes from: the menu of known vehicles, a file, a link, or the editor.

import type { Imported, Preset } from "../api";
import { element, fill, make, say } from "../dom";
import { Editor, type Vehicle } from "./editor";
import { onChoice, onDrop } from "./files";

const OWN = "own";
const OWN_ABOUT = "Your own file.";

const FORMATS: Record<Imported["format"], string> = {
  toml: "TOML",
  rotorpy: "RotorPy parameters",
  urdf: "URDF",
  sdf: "SDF",
  mujoco: "MuJoCo XML",
  px4: "PX4 parameters",
};

/** A path to fly, by its name. Everything else that is dropped is a vehicle. */
const PATH = /\.(csv|tsv)$/i;

export interface Wishes {
  /** This vehicle is to be judged. */
  judge(vehicle: Vehicle): void;
  /** The text is no longer the one that was judged. */
  changed(): void;
  /** A file could not be read. */
  refused(reason: string): void;
  /** A path was dropped. */
  path(path: Vehicle): void;
}

export class Source {
  private readonly menu = element("preset", HTMLSelectElement);
  private readonly about = element("preset-about", HTMLElement);
  private readonly error = element("error", HTMLElement);
  private readonly converted = element("converted", HTMLElement);
  private readonly editor: Editor;
  private presets: Preset[] = [];

  constructor(wishes: Wishes) {
    this.editor = new Editor(() => wishes.judge(this.vehicle), () => {
      this.choose(OWN);
      wishes.changed();
    });
    const take = (read: Vehicle | { refused: string }) => {
      if ("refused" in read) return wishes.refused(read.refused);
      this.choose(OWN);
      this.show(read);
      wishes.judge(read);
    };
    onChoice("file", take);
    onDrop((read) => ("file" in read && PATH.test(read.file) ? wishes.path(read) : take(read)));
    this.menu.addEventListener("change", () => {
      const preset = this.presets.find(({ id }) => id === this.menu.value);
      if (preset) wishes.judge(this.take(preset));
    });
  }

  get vehicle(): Vehicle {
    return this.editor.vehicle;
  }

  /** Fills the menu. */
  offer(presets: Preset[]): void {
    this.presets = presets;
    this.menu.replaceChildren(
      ...presets.map(({ id, name }) => make("option", { value: id }, name)),
      make("option", { value: OWN, disabled: "" }, "your own file"),
    );
    this.menu.disabled = false;
    this.choose(OWN);
  }

  /** Shows a known vehicle. */
  take(preset: Preset): Vehicle {
    this.choose(preset.id);
    const vehicle = { file: preset.file, text: preset.text };
    this.show(vehicle);
    return vehicle;
  }

  /** Shows a vehicle, and forgets what was said about the one before. */
  show(vehicle: Vehicle): void {
    this.editor.vehicle = vehicle;
    this.converted.hidden = true;
    say(this.error, null);
  }

  /** Shows what was made of a file, and what it lacks. */
  showConverted(source: Vehicle, imported: Imported): Vehicle {
    const vehicle = { file: imported.format === "toml" ? source.file : ours(source.file), text: imported.text };
    this.show(vehicle);
    const missing = imported.missing.length > 0;
    const words = imported.format === "toml" ? [] : [`${source.file} was converted from ${FORMATS[imported.format]}.`];
    if (missing) words.push("It does not say these numbers. Write them into the text, then certify:");
    const list = make("ul");
    fill(list, imported.missing);
    this.converted.replaceChildren(make("p", {}, words.join(" ")), ...(missing ? [list] : []));
    this.converted.hidden = words.length === 0;
    if (missing) {
      this.editor.open();
      this.editor.point(imported.missing.join(" "));
    }
    return vehicle;
  }

  /** Says why there is no verdict, and where. */
  refuse(reason: string): void {
    say(this.error, reason);
    this.editor.point(reason);
    this.error.scrollIntoView({ block: "nearest" });
  }

  /** Forgets what was said about the text before. */
  clear(): void {
    say(this.error, null);
    this.converted.hidden = true;
    this.editor.point(null);
  }

  private choose(id: string): void {
    this.menu.value = id;
    this.about.textContent = this.presets.find((preset) => preset.id === id)?.about ?? OWN_ABOUT;
  }
}

/** The name under which the converted file is saved. */
function ours(file: string): string {
  return `${file.replace(/\.[^.]*$/, "")}.toml`;
}
