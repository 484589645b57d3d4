// What the page shows, as the fragment of a link, and back. A fragment is never sent to a server.
//
// The bytes are JSON, packed in zlib's format: its checksum tells a damaged link from a good one.

import type { FlightRequest } from "../api";
import type { Vehicle } from "../vehicle/editor";

export interface Shared {
  vehicle: Vehicle;
  request: FlightRequest;
}

/** Before the packed bytes. Another number is another form. */
const MARK = "v1.";

/** Bytes of JSON: a link that unpacks to more is not one of ours. */
const GREATEST = 2_000_000;

const PACKING = "deflate";

export async function pack(shared: Shared): Promise<string> {
  const bytes = new TextEncoder().encode(JSON.stringify(shared));
  const packed = await readAll(new Blob([bytes]).stream().pipeThrough(new CompressionStream(PACKING)), GREATEST);
  const text = Array.from(packed, (byte) => String.fromCharCode(byte)).join("");
  return MARK + btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** Throws where the fragment is damaged or of another form. */
export async function unpack(fragment: string): Promise<Shared> {
  if (!fragment.startsWith(MARK)) throw new Error("is of another form");
  const text = atob(fragment.slice(MARK.length).replaceAll("-", "+").replaceAll("_", "/"));
  const packed = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream(PACKING));
  const shared: unknown = JSON.parse(new TextDecoder().decode(await readAll(stream, GREATEST)));
  if (!isShared(shared)) throw new Error("lacks something");
  return shared;
}

async function readAll(stream: ReadableStream<Uint8Array>, most: number): Promise<Uint8Array> {
  const parts: Uint8Array[] = [];
  let length = 0;
  const reader = stream.getReader();
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    length += read.value.length;
    if (length > most) {
      await reader.cancel();
      throw new Error("is too long");
    }
    parts.push(read.value);
  }
  const whole = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

function isShared(value: unknown): value is Shared {
  const { vehicle, request } = (value ?? {}) as Partial<Shared>;
  return typeof vehicle?.file === "string" && typeof vehicle.text === "string" && isRequest(request);
}

function isRequest(value: unknown): value is FlightRequest {
  const request = (value ?? {}) as Partial<FlightRequest>;
  const numbers = [request.wind, request.mass, request.weak_rotor, request.weak_share];
  const texts = [request.trajectory ?? "", request.trajectory_file ?? ""];
  return (
    typeof request.task === "string" && numbers.every(Number.isFinite) && Array.isArray(request.laws) &&
    texts.every((text) => typeof text === "string")
  );
}
