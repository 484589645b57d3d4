// Whether the page is busy, ready, or failed in the last thing it did: on <body>, for style and for tests.

let running = 0;
let failed = false;

/** The page is busy while `work` runs. */
export async function during(work: () => Promise<void>): Promise<void> {
  if (running === 0) failed = false;
  running += 1;
  publish();
  try {
    await work();
  } finally {
    running -= 1;
    publish();
  }
}

/** What runs now has failed. */
export function fail(): void {
  failed = true;
  publish();
}

/** What failed before has been replaced by something new. */
export function begin(): void {
  failed = false;
  publish();
}

function publish(): void {
  document.body.dataset["state"] = running > 0 ? "busy" : failed ? "failed" : "ready";
}
