// A field for a number that takes any finite number when it is left or Enter is pressed, and goes back to the old one otherwise.
import { type ReactElement, useState } from "react";
import { readNumber } from "./read_number.js";

interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  readonly digits: number;
  readonly unit?: string;
  readonly hideLabel?: boolean;
  readonly onChange: (value: number) => void;
}

export function NumberField({
  label,
  value,
  digits,
  unit = "",
  hideLabel = false,
  onChange,
}: NumberFieldProps): ReactElement {
  const [text, setText] = useState<string | null>(null);
  const commit = (): void => {
    if (text === null) return;
    const next = readNumber(text);
    setText(null);
    if (next !== null && next !== value) onChange(next);
  };
  return (
    <label className="field">
      <span className={hideLabel ? "sr-only" : "field-label"}>{label}</span>
      <span className="field-input">
        <input
          type="text"
          inputMode="decimal"
          autoComplete="off"
          spellCheck={false}
          aria-invalid={text !== null && readNumber(text) === null}
          value={text ?? value.toFixed(digits)}
          onChange={(event) => setText(event.currentTarget.value)}
          onBlur={commit}
          onKeyDown={(event) => {
            if (event.key === "Enter") commit();
            if (event.key === "Escape" && text !== null) {
              event.stopPropagation();
              setText(null);
            }
          }}
        />
        {unit === "" ? null : <span className="unit">{unit}</span>}
      </span>
    </label>
  );
}
