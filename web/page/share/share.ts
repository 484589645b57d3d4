// The button that makes a link to what the page shows, and the opening of such a link.

import { copy, element, say } from "../dom";
import { pack, unpack, type Shared } from "./link";

/** Characters. Some programs cut longer links; browsers take more. */
const SAFE = 8_000;
const GREATEST = 60_000;

export class Share {
  private readonly button = element("share", HTMLButtonElement);
  private readonly result = element("share-result", HTMLElement);
  private readonly said = element("share-said", HTMLElement);
  private readonly field = element("share-link", HTMLInputElement);

  constructor(private readonly current: () => Shared) {
    this.button.addEventListener("click", () => void this.make());
    this.field.addEventListener("focus", () => this.field.select());
  }

  /** Whether there is something to share. */
  allow(yes: boolean): void {
    this.button.disabled = !yes;
    this.result.hidden = true;
  }

  private async make(): Promise<void> {
    const address = new URL(location.href);
    address.hash = await pack(this.current());
    const link = address.href;
    this.result.hidden = false;
    this.field.hidden = link.length > GREATEST;
    if (this.field.hidden) {
      return say(this.said, `The link would have ${link.length} characters, which is too long. Send the file instead.`);
    }
    this.field.value = link;
    const done = await copy(link);
    const words = done ? "Copied." : "The browser does not allow copying: select the link below and copy it.";
    const long = ` It has ${link.length} characters, and some programs cut such a link: then send the file.`;
    say(this.said, words + (link.length > SAFE ? long : ""));
    if (!done) this.field.focus();
  }
}

/** What the page's address carries: null for nothing, or the reason why it cannot be read. */
export async function opened(): Promise<Shared | { refused: string } | null> {
  const fragment = location.hash.slice(1);
  // Anchors of the page itself are no links to a vehicle.
  if (fragment === "" || document.getElementById(fragment)) return null;
  try {
    return await unpack(fragment);
  } catch {
    return { refused: "the link is damaged or cut off: ask for it again, or for the file; nothing was taken from it" };
  }
}
