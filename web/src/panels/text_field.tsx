// A field for a name that is taken when it is left or Enter is pressed.
import { type ReactElement, useState } from "react";
import { LONGEST_NAME, usableName } from "../state/names.js";

interface TextFieldProps {
  readonly label: string;
  readonly value: string;
  /** Gets a usable name that differs from `value`. */
  readonly onChange: (value: string) => void;
}

export function TextField({ label, value, onChange }: TextFieldProps): ReactElement {
  const [text, setText] = useState<string | null>(null);
  const commit = (): void => {
    if (text === null) return;
    setText(null);
    const name = usableName(text);
    if (name !== null && name !== value) onChange(name);
  };
  return (
    <label className="field">
      <span className="field-label">{label}</span>
      <span className="field-input">
        <input
          type="text"
          maxLength={LONGEST_NAME}
          autoComplete="off"
          value={text ?? value}
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
      </span>
    </label>
  );
}
