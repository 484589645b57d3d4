// The verdict in a few words: certified or not, and why.

import type { Verdict } from "../api";
import { element, make } from "../dom";

const YES = "CERTIFIED";
const NO = "NOT certified";

type Look = "waiting" | "yes" | "no";

export class Banner {
  private readonly place = element("verdict", HTMLElement);

  /** Says what is being done, or why there is no verdict. */
  wait(words: string): void {
    this.look("waiting");
    this.place.textContent = words;
  }

  show(verdict: Verdict): void {
    this.look(verdict.certified ? "yes" : "no");
    const word = make("strong", { class: "word" }, verdict.certified ? YES : NO);
    const why = reason(verdict);
    const told = verdict.certified
      ? `${verdict.name} may fly with this controller.`
      : `${verdict.name} must not fly with this controller as it is.`;
    this.place.replaceChildren(word, " ", make("span", { class: "told" }, told));
    if (why) this.place.append(" ", make("span", { class: "why" }, why));
  }

  private look(look: Look): void {
    this.place.className = `banner ${look}`;
  }
}

/** What the decision says beyond its first words. */
function reason({ decision, name }: Verdict): string {
  const named = decision.startsWith(`${name}: `) ? decision.slice(name.length + 2) : decision;
  return named.replace(/^(NOT certified|CERTIFIED)[:,.]?\s*/, "");
}
