// The module's answers, as promises. The module runs in a worker; what nobody waits for any longer is given up.

import type { Answer, Api, FlightAnswer, FlightRequest, Imported, Paper, Preset, Verdict } from "./api";
import type { Ask, Start, Told } from "./worker";
import address from "../vehicle.wasm?url";

type Settle = (answer: { error: string } | { ok: never }) => void;

const ABANDONED = "given up for something newer";

export class Client implements Api {
  private readonly module = compile();
  private readonly waiting = new Map<number, Settle>();
  private worker: Worker | null = null;
  private asked = 0;

  presets = () => this.ask<Preset[]>({ do: "presets" });
  import = (file: string, text: string) => this.ask<Imported>({ do: "import", file, text });
  certify = (file: string, text: string) => this.ask<Verdict>({ do: "certify", file, text });
  fly = (file: string, text: string, request: FlightRequest) =>
    this.ask<FlightAnswer>({ do: "fly", file, text, request });
  paper = () => this.ask<Paper>({ do: "paper" });

  /** Gives up whatever runs or waits. A computation cannot be interrupted, so its worker ends. */
  abandon(): void {
    if (this.waiting.size === 0) return;
    this.worker?.terminate();
    this.worker = null;
    this.settleAll(ABANDONED);
  }

  private async ask<T>(request: unknown): Promise<Answer<T>> {
    let module: WebAssembly.Module;
    try {
      module = await this.module;
    } catch (failure) {
      return { error: `the controller could not be loaded: ${failure instanceof Error ? failure.message : failure}` };
    }
    this.worker ??= this.start(module);
    const message: Ask = { id: ++this.asked, request };
    this.worker.postMessage(message);
    return new Promise((settle) => this.waiting.set(message.id, settle as Settle));
  }

  private start(module: WebAssembly.Module): Worker {
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<Told>) => {
      this.waiting.get(data.id)?.(data.answer as Parameters<Settle>[0]);
      this.waiting.delete(data.id);
    };
    worker.onerror = () => {
      worker.terminate();
      this.worker = null;
      this.settleAll("the program's worker ended; try again, or load the page anew");
    };
    const start: Start = { module };
    worker.postMessage(start);
    return worker;
  }

  private settleAll(error: string): void {
    for (const settle of this.waiting.values()) settle({ error });
    this.waiting.clear();
  }
}

/** Compiles while it loads, or after that where the server does not say that the file is WebAssembly. */
async function compile(): Promise<WebAssembly.Module> {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: ${response.status} ${response.statusText}`);
  if (response.headers.get("Content-Type")?.startsWith("application/wasm")) {
    return WebAssembly.compileStreaming(response);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}
