// Runs the WebAssembly module beside the page, so that the page stays responsive. One request at a time.

import { Instance } from "./instance";

/** The first message to a worker. */
export interface Start {
  module: WebAssembly.Module;
}

/** Every later message. */
export interface Ask {
  id: number;
  request: unknown;
}

export interface Told {
  id: number;
  answer: unknown;
}

let module: WebAssembly.Module | null = null;
let instance: Instance | null = null;

/** An answer in every case. An instance that stopped inside is not used again. */
async function answer(request: unknown): Promise<unknown> {
  if (module === null) return { error: "the controller was not loaded" };
  try {
    instance ??= await Instance.of(module);
    return instance.handle(request);
  } catch (failure) {
    instance = null;
    const cause = failure instanceof Error ? failure.message : String(failure);
    return { error: `the program stopped inside (${cause}): a mistake in it, not in your file; it has been restarted` };
  }
}

let previous: Promise<void> = Promise.resolve();

self.onmessage = ({ data }: MessageEvent<Start | Ask>) => {
  if ("module" in data) {
    module = data.module;
    return;
  }
  previous = previous.then(async () => {
    const told: Told = { id: data.id, answer: await answer(data.request) };
    self.postMessage(told);
  });
};
