// A field for a name that is taken when it is left or Enter is pressed.
import type { ReactElement } from "react";
import { LONGEST_NAME, usableName } from "../../state/names.js";
import { useFieldDraft } from "./use_field_draft.js";

interface TextFieldProps {
  readonly label: string;
  readonly value: string;
  /** Gets a usable name that differs from `value`. */
  readonly onChange: (value: string) => void;
}

export function TextField({ label, value, onChange }: TextFieldProps): ReactElement {
  const { text, handlers } = useFieldDraft((typed) => {
    const name = usableName(typed);
    if (name !== null && name !== value) onChange(name);
  });
  return (
    <label className="field">
      <span className="field-label">{label}</span>
      <span className="field-input">
        <input type="text" maxLength={LONGEST_NAME} autoComplete="off" value={text ?? value} {...handlers} />
      </span>
    </label>
  );
}
