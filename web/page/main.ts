// The page's course: a vehicle is read, judged and flown, and then the paper's flight is computed.
//
// Whatever is newer wins: a new vehicle or a moved slider gives up what runs for the one before.

import type { Answer, Preset, Verdict } from "./api";
import { Client } from "./client";
import { element } from "./dom";
import { FlightForm } from "./flight/form";
import { FlightPanel } from "./flight/panel";
import { PaperPanel } from "./paper";
import { opened, Share } from "./share/share";
import { begin, during, fail } from "./state";
import type { Vehicle } from "./vehicle/editor";
import { Source } from "./vehicle/source";
import { VerdictPanel } from "./verdict/panel";

/** ms after the last move of a slider. */
const SETTLED = 300;

/** A vehicle that can be flown: the text that was judged, and its verdict. */
interface Judged {
  vehicle: Vehicle;
  verdict: Verdict;
}

const client = new Client();
const verdicts = new VerdictPanel();
const flights = new FlightPanel();
const paper = new PaperPanel();
const form = new FlightForm(flyOnceSettled, fly, (why) => flights.refuse(why));
const source = new Source({ judge, changed, path, refused: unreadable });
const share = new Share(() => ({ vehicle: source.vehicle, request: form.request }));

let judged: Judged | null = null;
let turn = 0;
let settling = 0;

/** Begins something new. The answer tells whether it is still the newest. */
function newest(): () => boolean {
  clearTimeout(settling);
  client.abandon();
  begin();
  const mine = (turn += 1);
  return () => mine === turn;
}

function judge(given: Vehicle): void {
  const current = newest();
  judged = null;
  source.clear();
  form.look("nothing");
  share.allow(given.text.trim() !== "");
  verdicts.wait(`reading ${given.file}…`);
  void during(async () => {
    const read = await client.import(given.file, given.text);
    if (!current()) return;
    if ("error" in read) return refuse(read.error);
    const converted = read.ok.format !== "toml" || read.ok.missing.length > 0;
    const vehicle = converted ? source.showConverted(given, read.ok) : given;
    if (read.ok.missing.length > 0) return lacks(read.ok.missing.length);
    verdicts.wait(`certifying ${vehicle.file}…`);
    flights.wait();
    const answer = await client.certify(vehicle.file, vehicle.text);
    if (!current()) return;
    if ("error" in answer) return refuse(answer.error);
    judged = { vehicle, verdict: answer.ok };
    verdicts.show(answer.ok);
    form.fit(answer.ok);
    await flown(judged, current);
    await paperOnce(current);
  });
}

/** There is no verdict, for this reason. */
function refuse(reason: string, words = "No verdict: the file cannot be used as it is. The error says why."): void {
  source.refuse(reason);
  verdicts.none(words);
  flights.none();
  fail();
}

/** A file that is no text: what was there before stays. */
function unreadable(reason: string): void {
  source.refuse(reason);
  fail();
}

function lacks(count: number): void {
  verdicts.none(`No verdict yet: ${count === 1 ? "a number is" : `${count} numbers are`} missing in the file.`);
  flights.none();
}

/** The text differs from what was judged: the verdict is no longer about it. */
function changed(): void {
  newest();
  judged = null;
  form.look("nothing");
  share.allow(source.vehicle.text.trim() !== "");
  verdicts.wait("The text has changed. Certify it again.");
  flights.wait();
}

function fly(): void {
  if (judged === null) return;
  const [current, what] = [newest(), judged];
  void during(async () => {
    await flown(what, current);
    await paperOnce(current);
  });
}

function flyOnceSettled(): void {
  clearTimeout(settling);
  settling = window.setTimeout(fly, SETTLED);
}

/** Flies and shows the flight. */
async function flown({ vehicle, verdict }: Judged, current: () => boolean): Promise<void> {
  form.look("ready");
  if (!form.complete) return flights.refuse("Choose the file of your path first.");
  const request = form.request;
  form.look("flying");
  flights.wait();
  flights.prepare();
  const answer = await client.fly(vehicle.file, vehicle.text, request);
  if (!current()) return;
  form.look("ready");
  if ("error" in answer) {
    flights.refuse(answer.error);
    return fail();
  }
  await flights.show(answer.ok, request, verdict);
}

async function paperOnce(current: () => boolean): Promise<void> {
  if (paper.known || !current()) return;
  paper.wait();
  const answer = await client.paper();
  if (current()) paper.show(answer);
}

/** A path was dropped. */
function path(given: Vehicle): void {
  form.takePath(given);
  element("flight-section", HTMLElement).scrollIntoView();
  fly();
}

/** Restores what the address carries. False if it carries nothing. */
async function restore(): Promise<boolean> {
  const shared = await opened();
  if (shared === null) return false;
  if ("refused" in shared) {
    refuse(shared.refused, "No verdict: choose a vehicle or a file.");
    return true;
  }
  form.request = shared.request;
  source.show(shared.vehicle);
  judge(shared.vehicle);
  return true;
}

addEventListener("hashchange", () => void restore());

/** The known vehicles. Asked again if a file that was dropped meanwhile has ended the worker. */
async function presets(): Promise<Answer<Preset[]>> {
  for (;;) {
    const before = turn;
    const answer = await client.presets();
    if ("ok" in answer || turn === before) return answer;
  }
}

void during(async () => {
  const known = await presets();
  if ("error" in known) return refuse(known.error, "No verdict: the controller could not be loaded.");
  const untouched = turn === 0;
  source.offer(known.ok);
  const first = known.ok[0];
  if (untouched && !(await restore()) && first) judge(source.take(first));
});
