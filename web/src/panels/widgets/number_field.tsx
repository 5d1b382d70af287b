// A field for a number that takes any finite number when it is left or Enter is pressed, and goes back to the old one otherwise.
import type { ReactElement } from "react";
import { readNumber } from "./read_number.js";
import { useFieldDraft } from "./use_field_draft.js";

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
  const { text, handlers } = useFieldDraft((typed) => {
    const next = readNumber(typed);
    if (next !== null && next !== value) onChange(next);
  });
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
          {...handlers}
        />
        {unit === "" ? null : <span className="unit">{unit}</span>}
      </span>
    </label>
  );
}
