// A command line that one click copies.

import { type ReactElement, useEffect, useState } from "react";
import { addNotice } from "../../state/notices.js";
import { useApp } from "../use_store.js";
import { Icon } from "./icons.js";

const SHOWN_MS = 1500;

export function CopyLine({ text }: { readonly text: string }): ReactElement {
  const { store } = useApp();
  const [copied, setCopied] = useState(false);
  useEffect(() => {
    if (!copied) return;
    const timer = setTimeout(() => setCopied(false), SHOWN_MS);
    return () => clearTimeout(timer);
  }, [copied]);
  const copy = async (): Promise<void> => {
    try {
      // Browsers offer the clipboard only to pages of this computer or by HTTPS.
      await navigator.clipboard.writeText(text);
      setCopied(true);
    } catch {
      addNotice(store, "info", "The browser did not allow copying: select the line and copy it by hand.");
    }
  };
  return (
    <div className="copy-line">
      <code>{text}</code>
      <button type="button" className="quiet" aria-label={`Copy: ${text}`} onClick={() => void copy()}>
        <Icon name={copied ? "check" : "copy"} size={16} />
      </button>
      <span className="sr-only" role="status">
        {copied ? "Copied" : ""}
      </span>
    </div>
  );
}
