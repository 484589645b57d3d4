// The paper's flight, computed here, beside the number that the project published for it.

import type { Answer, Paper } from "./api";
import { element } from "./dom";

export class PaperPanel {
  private readonly hash = element("paper-hash", HTMLElement);
  private readonly same = element("paper-same", HTMLElement);
  /** Whether the number is there: it never changes. */
  known = false;

  wait(): void {
    this.hash.textContent = "computing…";
  }

  show(answer: Answer<Paper>): void {
    if ("error" in answer) {
      this.hash.textContent = "not computed";
      this.same.textContent = answer.error;
      return;
    }
    const { hash, published, same } = answer.ok;
    this.known = true;
    this.hash.textContent = hash;
    element("paper-published", HTMLElement).textContent = published;
    this.same.className = same ? "judged yes" : "judged no";
    this.same.textContent = same
      ? "The same: your browser computed the paper's flight bit by bit as published."
      : "NOT the same: your browser computed something else. Please report it.";
  }
}
