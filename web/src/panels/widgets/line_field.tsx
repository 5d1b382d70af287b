// A field for one line of text of the tour, taken when it is left or Enter is pressed.
import { type ReactElement, useLayoutEffect, useRef } from "react";
import { usableLine } from "../../tour/text_rules.js";
import { useFieldDraft } from "./use_field_draft.js";

interface LineFieldProps {
  readonly label: string;
  readonly value: string;
  /** Nothing at all is an answer too: "". */
  readonly empty?: boolean;
  /** Chosen as a whole when the field appears, so that typing replaces it. */
  readonly fresh?: boolean;
  readonly placeholder?: string;
  /** Why a text cannot be taken; null: it can. */
  readonly problem?: (text: string) => string | null;
  readonly onChange: (value: string) => void;
}

const LONGEST = 2000;

export function LineField(props: LineFieldProps): ReactElement {
  const { label, value, empty = false, fresh = false, placeholder, problem = () => null, onChange } = props;
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => {
    if (!fresh) return;
    input.current?.focus({ preventScroll: true });
    input.current?.select();
  }, [fresh]);
  const { text, handlers } = useFieldDraft((typed) => {
    // Longer texts have rules of their own, which `problem` knows.
    const next = props.problem === undefined ? usableLine(typed) : typed.trim();
    if (next === null || next === "") {
      if (empty && value !== "") onChange("");
    } else if (next !== value && problem(next) === null) onChange(next);
  });
  const why = text === null || text.trim() === "" ? null : problem(text.trim());
  return (
    <>
      <label className="field">
        <span className="field-label">{label}</span>
        <span className="field-input">
          <input
            ref={input}
            type="text"
            maxLength={LONGEST}
            autoComplete="off"
            placeholder={placeholder}
            aria-invalid={why !== null}
            value={text ?? value}
            {...handlers}
          />
        </span>
      </label>
      {why === null ? null : (
        <p className="field-problem" role="alert">
          {why}
        </p>
      )}
    </>
  );
}
