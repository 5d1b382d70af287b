// One of several, by name.
import type { ReactElement } from "react";

interface SelectFieldProps<T extends string> {
  readonly label: string;
  readonly value: T;
  readonly options: readonly (readonly [value: T, name: string])[];
  readonly onChange: (value: T) => void;
}

export function SelectField<T extends string>({ label, value, options, onChange }: SelectFieldProps<T>): ReactElement {
  return (
    <label className="field">
      <span className="field-label">{label}</span>
      <span className="field-input">
        <select
          value={value}
          onChange={(event) => {
            const chosen = options.find(([own]) => own === event.currentTarget.value);
            if (chosen !== undefined) onChange(chosen[0]);
          }}
        >
          {options.map(([own, name]) => (
            <option key={own} value={own}>
              {name}
            </option>
          ))}
        </select>
      </span>
    </label>
  );
}
