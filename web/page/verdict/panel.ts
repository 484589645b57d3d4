// The verdict and all that stands behind it: sentences, rows, loops, advice, constants, report.

import type { Verdict } from "../api";
import { copy, element, fill, make, save } from "../dom";
import { percent, typeset } from "../numbers";
import { WIDE } from "../wide";
import { Banner } from "./banner";
import { loop, row } from "./tables";

export class VerdictPanel {
  private readonly banner = new Banner();
  private readonly body = element("verdict-body", HTMLElement);
  private readonly loops = element("loops-part", HTMLDetailsElement);
  private readonly constants = element("constants", HTMLElement);
  private readonly rows = element("rows-part", HTMLDetailsElement);
  private name = "";

  constructor() {
    this.rows.open = matchMedia(WIDE).matches;
    const said = element("constants-said", HTMLElement);
    element("copy-constants", HTMLButtonElement).addEventListener("click", async () => {
      const done = await copy(this.constants.textContent ?? "");
      said.textContent = done ? "copied" : "the browser does not allow it: select the text and copy it";
    });
    element("save-constants", HTMLButtonElement).addEventListener("click", () => {
      save(`${this.name}-constants.toml`, this.constants.textContent ?? "");
    });
  }

  /** Says what is being done. What was there before stays, faded, so that nothing jumps. */
  wait(words: string): void {
    this.banner.wait(words);
    this.body.classList.add("stale");
  }

  /** There is no verdict. */
  none(words: string): void {
    this.banner.wait(words);
    this.body.hidden = true;
  }

  show(verdict: Verdict): void {
    this.name = verdict.name;
    this.banner.show(verdict);
    element("sentences", HTMLElement).replaceChildren(...verdict.sentences.map(sentence));
    fill(element("may-fly", HTMLElement), verdict.may_fly.map(typeset), element("may-fly-part", HTMLElement));
    fill(element("advice", HTMLElement), verdict.advice.map(typeset), element("advice-part", HTMLElement));
    rowsOf("rows").replaceChildren(...verdict.rows.map(row));
    rowsOf("loops").replaceChildren(...verdict.loops.map(loop));
    this.summarize(verdict);
    this.constants.textContent = verdict.constants;
    element("constants-said", HTMLElement).textContent = "";
    element("report", HTMLElement).textContent = verdict.report;
    this.body.hidden = false;
    this.body.classList.remove("stale");
  }

  /** What is in the tables, in a line; a table in which something fails is open. */
  private summarize({ loops, rows }: Verdict): void {
    const failed = rows.filter(({ holds }) => !holds).length;
    const least = rows.reduce((a, b) => (b.margin < a.margin ? b : a), rows[0] ?? { margin: 0, name: "" });
    const tightest = `least margin ${percent(least.margin)}, ${least.name}`;
    const held = failed === 0 ? `all hold; ${tightest}` : `${failed} fail; ${tightest}`;
    element("rows-summary", HTMLElement).textContent = `What the proof needs: ${rows.length} inequalities, ${held}`;
    this.rows.open ||= failed > 0;
    const failing = loops.filter(({ holds }) => !holds).length;
    const words = failing === 0 ? "all stable, with margin" : `${failing} without enough margin`;
    element("loops-summary", HTMLElement).textContent = `Small motions about hover: ${loops.length} loops, ${words}`;
    this.loops.hidden = loops.length === 0;
    this.loops.open = failing > 0;
  }
}

/** A sentence. What stands before a colon is what it is about. */
function sentence(text: string): HTMLElement {
  const [, subject = "", rest = text] = /^([^:]+:)(\s.*)$/s.exec(text) ?? [];
  return make("li", {}, make("strong", {}, subject), typeset(rest));
}

function rowsOf(table: string): HTMLTableSectionElement {
  const body = element(table, HTMLTableElement).tBodies[0];
  if (body === undefined) throw new Error(`the table #${table} has no body`);
  return body;
}
