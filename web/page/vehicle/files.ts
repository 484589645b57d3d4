// Files that are dropped on the page or chosen: read as text, or refused with a reason.

import { element } from "../dom";
import type { Vehicle } from "./editor";

/** Bytes. Vehicle files and paths have a few thousand. */
const GREATEST_FILE = 2_000_000;

/** Takes a file's name and text, or a reason why it cannot be read. */
type Take = (read: Vehicle | { refused: string }) => void;

/** Hands on every file that is dropped anywhere, or chosen in the input of that id. */
export function onDrop(take: Take): void {
  const zone = element("drop", HTMLElement);
  let inside = 0;
  const show = (over: boolean) => zone.classList.toggle("over", over);
  addEventListener("dragenter", () => show((inside += 1) > 0));
  addEventListener("dragleave", () => show((inside -= 1) > 0));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    inside = 0;
    show(false);
    void read(event.dataTransfer?.files[0], take);
  });
}

export function onChoice(id: string, take: Take): void {
  const input = element(id, HTMLInputElement);
  input.addEventListener("change", async () => {
    await read(input.files?.[0], take);
    input.value = "";
  });
}

async function read(file: File | undefined, take: Take): Promise<void> {
  if (file === undefined) return take({ refused: "no file was dropped: drop a file, not a folder or a text" });
  if (file.size > GREATEST_FILE) {
    return take({ refused: `${file.name}: has over 2 MB, and no vehicle's file is so large` });
  }
  try {
    const text = decode(await file.arrayBuffer());
    if (text.includes("\0")) return take({ refused: `${file.name}: is no text file` });
    take({ file: file.name, text });
  } catch {
    take({ refused: `${file.name}: could not be read as text; drop a file, not a folder, and save it as UTF-8` });
  }
}

/** UTF-8, or UTF-16 where its mark says so. */
function decode(bytes: ArrayBuffer): string {
  const [first, second] = new Uint8Array(bytes, 0, Math.min(2, bytes.byteLength));
  const little = first === 0xff && second === 0xfe;
  const big = first === 0xfe && second === 0xff;
  return new TextDecoder(little ? "utf-16le" : big ? "utf-16be" : "utf-8", { fatal: true }).decode(bytes);
}
