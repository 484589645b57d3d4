// A flight that is watched: the view in space and the plots. Both are loaded when the first flight is there.

import { element, say } from "../dom";
import { Clock } from "./clock";
import { Player } from "./player";
import { SideView } from "./side";
import type { Shown, View } from "./view";
import type { Plots } from "../plots/plots";

const NO_WEBGL = "This browser has no WebGL. The flight is drawn from the side instead: x to the right, z up.";

export class Replay {
  private readonly clock = new Clock();
  private readonly player = new Player(this.clock);
  private readonly note = element("view-note", HTMLElement);
  private readonly followed = element("follow", HTMLInputElement);
  private loading: Promise<[View, Plots]> | null = null;
  private view: View | null = null;

  constructor() {
    this.clock.listen((time) => this.view?.draw(time));
    this.followed.addEventListener("change", () => this.view?.follow(this.followed.checked));
  }

  /** Begins to load what draws. */
  prepare(): Promise<[View, Plots]> {
    return (this.loading ??= Promise.all([this.loadView(), this.loadPlots()]));
  }

  async show(shown: Shown, fit: boolean): Promise<void> {
    const [view, plots] = await this.prepare();
    this.clock.end = Math.max(...shown.answer.flights.map(({ t }) => t.at(-1) ?? 0));
    view.show(shown, fit);
    plots.show(shown.answer);
    this.player.begin(this.clock.end);
  }

  private async loadView(): Promise<View> {
    const place = element("view", HTMLElement);
    if (hasWebGL()) {
      const { Space } = await import("../space/space");
      this.view = new Space(place, (words) => say(this.note, words));
    } else {
      say(this.note, NO_WEBGL);
      this.view = new SideView(place);
    }
    return this.view;
  }

  private async loadPlots(): Promise<Plots> {
    const { Plots } = await import("../plots/plots");
    return new Plots(this.clock);
  }
}

function hasWebGL(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}
