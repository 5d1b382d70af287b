// Texts of a tour. A line has no control characters; a text may have line breaks and tabs. Lengths count characters (code points), so that scripts
// outside the basic plane are not at a disadvantage. Half a surrogate pair is refused: it cannot be written as UTF-8.
import { asString, CheckError } from "../base/check.js";
import { LONGEST_LINE, LONGEST_TEXT, LONGEST_URL } from "./limits.js";

const NOT_IN_LINES = /[\p{Cc}\p{Cs}\u2028\u2029]/u;
const NOT_IN_TEXTS = /[\p{Cs}]|(?![\n\r\t])\p{Cc}/u;
const EVERY_NOT_IN_LINES = new RegExp(NOT_IN_LINES, "gu");
const EVERY_NOT_IN_TEXTS = new RegExp(NOT_IN_TEXTS, "gu");

function characters(text: string): number {
  let count = 0;
  for (const _ of text) count += 1;
  return count;
}

function bounded(value: unknown, path: string, least: number, most: number): string {
  const text = asString(value, path, 2 * most);
  const count = characters(text);
  if (count > most) throw new CheckError(path, `at most ${most} characters allowed, found ${count}`);
  if (count < least) throw new CheckError(path, "it is empty");
  return text;
}

/** One line of at most 200 characters. */
export function asLine(value: unknown, path: string, least: 0 | 1 = 1): string {
  const text = bounded(value, path, least, LONGEST_LINE);
  if (NOT_IN_LINES.test(text)) throw new CheckError(path, "one line without control characters expected");
  return text;
}

export function asText(value: unknown, path: string): string {
  const text = bounded(value, path, 0, LONGEST_TEXT);
  if (NOT_IN_TEXTS.test(text)) throw new CheckError(path, "text without control characters expected");
  return text;
}

/** An address that a browser opens as a web page: nothing that runs ("javascript:"), no spaces. */
export function asUrl(value: unknown, path: string): string {
  const url = bounded(value, path, 1, LONGEST_URL);
  if (!/^https?:\/\/[^\s/?#]/.test(url) || /\s/.test(url) || NOT_IN_LINES.test(url)) {
    throw new CheckError(path, "an address that begins with http:// or https:// expected");
  }
  return url;
}

/** What a person typed, as a line; null: nothing is left. */
export function usableLine(typed: string): string | null {
  const line = [...typed.replace(EVERY_NOT_IN_LINES, " ").trim()].slice(0, LONGEST_LINE).join("").trim();
  return line === "" ? null : line;
}

/** What a person typed, as a text. */
export function usableText(typed: string): string {
  return [...typed.replaceAll("\r\n", "\n").replace(EVERY_NOT_IN_TEXTS, " ")].slice(0, LONGEST_TEXT).join("");
}

/** Bytes of a text as UTF-8. */
export function utf8Bytes(text: string): number {
  let bytes = 0;
  for (const character of text) {
    const code = character.codePointAt(0) ?? 0;
    bytes += code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
  }
  return bytes;
}
