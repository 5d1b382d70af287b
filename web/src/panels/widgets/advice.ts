// Splits the server's advice into sentences and command lines, so that a command can be copied.

export interface AdvicePart {
  readonly text: string;
  readonly command: boolean;
}

/** Commands begin with `skyquilt` and go to the end of the line, or are set between backquotes. */
export function splitAdvice(advice: string): readonly AdvicePart[] {
  const parts: AdvicePart[] = [];
  const add = (text: string, command: boolean): void => {
    const trimmed = text.trim();
    if (trimmed !== "") parts.push({ text: trimmed, command });
  };
  for (const line of advice.split("\n")) {
    const quoted = line.split("`");
    if (quoted.length > 1 && quoted.length % 2 === 1) {
      for (const [index, piece] of quoted.entries()) add(piece, index % 2 === 1);
      continue;
    }
    const start = /(^|[\s:])((mpirun\s.*?)?skyquilt [a-z]+(\s|$))/.exec(line);
    if (start === null) {
      add(line, false);
      continue;
    }
    const at = start.index + (start[1]?.length ?? 0);
    add(line.slice(0, at), false);
    add(line.slice(at), true);
  }
  return parts;
}
