// What the project lacks, why, and the command that makes it.
import type { ReactElement } from "react";
import type { Missing } from "../../state/project.js";
import { splitAdvice } from "./advice.js";
import { CopyLine } from "./copy_line.js";
import { Icon } from "./icons.js";

export function MissingList({ missing }: { readonly missing: readonly Missing[] }): ReactElement | null {
  if (missing.length === 0) return null;
  return (
    <section>
      <h3>What is missing</h3>
      <ul className="missing">
        {missing.map((item) => (
          <li key={`${item.what}: ${item.reason}`}>
            <p className="missing-what">
              <Icon name="warning" size={16} />
              {item.what}
            </p>
            <p className="hint">{item.reason}</p>
            {splitAdvice(item.advice).map((part) =>
              part.command ? <CopyLine key={part.text} text={part.text} /> : <p key={part.text}>{part.text}</p>,
            )}
          </li>
        ))}
      </ul>
    </section>
  );
}
