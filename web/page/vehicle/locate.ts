// Finds the place in a file that a message speaks of: a line by its number, or a TOML key by its name.

/** From and to which character. */
export interface Span {
  line: number;
  from: number;
  to: number;
}

/** The place that `message` names in `text`; null if it names none. */
export function locate(message: string, text: string): Span | null {
  const numbered = /\bline (\d+)\b/.exec(message);
  if (numbered) return span(text, Number(numbered[1]) - 1);
  for (const [, section, key] of message.matchAll(/\b([a-z_]+(?:\.[a-z_]+)*)\.([a-z_]+)\b/g)) {
    const line = keyLine(text.split("\n"), section ?? "", key ?? "");
    if (line !== null) return span(text, line);
  }
  return null;
}

/** The line of `key` below `[section]`, or the section's own line where the key is not there. */
function keyLine(lines: string[], section: string, key: string): number | null {
  const head = lines.findIndex((line) => heading(line) === section);
  if (head < 0) return null;
  for (let i = head + 1; i < lines.length; i += 1) {
    const line = lines[i] ?? "";
    if (heading(line) !== null) break;
    if (line.trimStart().split(/[\s=]/, 1)[0] === key) return i;
  }
  return head;
}

function heading(line: string): string | null {
  return /^\s*\[\s*([\w.]+)\s*\]/.exec(line)?.[1] ?? null;
}

function span(text: string, line: number): Span | null {
  const lines = text.split("\n");
  const found = lines[line];
  if (found === undefined) return null;
  const from = lines.slice(0, line).reduce((sum, each) => sum + each.length + 1, 0);
  return { line, from, to: from + found.length };
}
