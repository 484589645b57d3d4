// The vehicle's file as text: shown, edited, saved, and the place of an error selected in it.

import { element, save } from "../dom";
import { WIDE } from "../wide";
import { locate, type Span } from "./locate";

export interface Vehicle {
  /** The file's name. */
  file: string;
  text: string;
}

const NO_NAME = "vehicle.toml";

export class Editor {
  private readonly area = element("editor", HTMLTextAreaElement);
  private readonly part = element("edit", HTMLDetailsElement);
  private readonly name = element("file-name", HTMLElement);
  private readonly certify = element("certify", HTMLButtonElement);
  private readonly saver = element("save", HTMLButtonElement);
  private readonly goTo = element("go-to", HTMLButtonElement);
  private file = NO_NAME;
  private place: Span | null = null;

  constructor(certify: () => void, changed: () => void) {
    this.part.open = matchMedia(WIDE).matches;
    this.area.addEventListener("input", () => {
      this.certify.disabled = this.area.value.trim() === "";
      this.saver.disabled = this.certify.disabled;
      changed();
    });
    this.area.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey) && !this.certify.disabled) certify();
    });
    this.certify.addEventListener("click", certify);
    this.saver.addEventListener("click", () => save(this.file, this.area.value));
    this.goTo.addEventListener("click", () => {
      this.part.open = true;
      this.area.focus();
      this.select();
    });
  }

  get vehicle(): Vehicle {
    return { file: this.file, text: this.area.value };
  }

  set vehicle({ file, text }: Vehicle) {
    this.file = file || NO_NAME;
    this.name.textContent = this.file;
    this.area.value = text;
    this.certify.disabled = text.trim() === "";
    this.saver.disabled = this.certify.disabled;
    this.area.scrollTop = 0;
    this.point(null);
  }

  /** Selects what `message` speaks of, and offers to go there. */
  point(message: string | null): void {
    this.place = message === null ? null : locate(message, this.area.value);
    this.goTo.hidden = this.place === null;
    if (this.place === null) return;
    this.goTo.textContent = `Go to line ${this.place.line + 1}`;
    this.select();
  }

  open(): void {
    this.part.open = true;
  }

  private select(): void {
    if (this.place === null) return;
    const height = this.area.scrollHeight / Math.max(1, this.area.value.split("\n").length);
    this.area.setSelectionRange(this.place.from, this.place.to);
    this.area.scrollTop = Math.max(0, height * this.place.line - this.area.clientHeight / 2);
  }
}
