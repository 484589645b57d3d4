// The page's elements, found by their ids and made anew, with their types checked.

/** The element of that id. It stands in index.html, so a missing one is a mistake of ours. */
export function element<T extends Element>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (found instanceof kind) return found;
  throw new Error(`the page has no ${kind.name} #${id}`);
}

/** A new element with these attributes and children. Text stays text: nothing is read as HTML. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Makes `list` show one item for each text, and hides `part` if there are no texts. */
export function fill(list: Element, texts: readonly string[], part: HTMLElement | null = null): void {
  list.replaceChildren(...texts.map((text) => make("li", {}, text)));
  if (part) part.hidden = texts.length === 0;
}

/** Shows a text in `place`, or hides the place without one. */
export function say(place: HTMLElement, text: string | null): void {
  place.hidden = text === null;
  if (place.textContent !== (text ?? "")) place.textContent = text ?? "";
}

/** Offers a text as a file to save. */
export function save(name: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  make("a", { href: address, download: name }).click();
  URL.revokeObjectURL(address);
}

/** Copies a text. False where the browser forbids it. */
export async function copy(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
