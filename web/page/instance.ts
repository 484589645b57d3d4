// A running WebAssembly module and its calling convention: a request goes in as JSON, an answer comes out as JSON.

interface Exports {
  memory: WebAssembly.Memory;
  /** Makes room for a request of so many bytes and returns where to write it. */
  input(length: number): number;
  /** Handles the request and returns the length of the answer, bytes. */
  call(): number;
  /** Where the answer is. */
  output(): number;
}

export class Instance {
  private constructor(private readonly exports: Exports) {}

  static async of(module: WebAssembly.Module): Promise<Instance> {
    const instance = await WebAssembly.instantiate(module, {});
    return new Instance(instance.exports as unknown as Exports);
  }

  /** Throws if the module stops inside. It must not be called again then. */
  handle(request: unknown): unknown {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const at = this.exports.input(bytes.length) >>> 0;
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
    const length = this.exports.call() >>> 0;
    const from = this.exports.output() >>> 0;
    return JSON.parse(new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, from, length)));
  }
}
