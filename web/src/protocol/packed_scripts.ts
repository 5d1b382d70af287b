// Packed files in the page: script elements, and the function that the scripts call.
import { systemClock } from "../base/clock.js";
import { PackedFiles, type ScriptHost } from "./packed_files.js";

declare global {
  interface Window {
    skyquiltData?: (name: unknown, base64: unknown) => void;
  }
}

const scripts: ScriptHost = {
  add(url, ran, failed) {
    const element = document.createElement("script");
    element.async = true;
    element.src = url;
    element.onload = ran;
    element.onerror = failed;
    document.head.append(element);
    return () => element.remove();
  },
};

export function openPackedFiles(): PackedFiles {
  const files = new PackedFiles({ scripts, clock: systemClock });
  window.skyquiltData = (name, base64) => files.receive(name, base64);
  return files;
}
