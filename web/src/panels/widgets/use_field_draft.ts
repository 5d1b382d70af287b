// What is being typed into a field: it counts when the field is left or Enter is pressed, and Escape takes it back.
import { type ChangeEvent, type KeyboardEvent, useState } from "react";

interface FieldDraft {
  /** Null: nothing was typed since it was last taken. */
  readonly text: string | null;
  /** Of the input element. */
  readonly handlers: {
    onChange(event: ChangeEvent<HTMLInputElement>): void;
    onBlur(): void;
    onKeyDown(event: KeyboardEvent<HTMLInputElement>): void;
  };
}

export function useFieldDraft(take: (text: string) => void): FieldDraft {
  const [text, setText] = useState<string | null>(null);
  const commit = (): void => {
    if (text === null) return;
    setText(null);
    take(text);
  };
  return {
    text,
    handlers: {
      onChange: (event) => setText(event.currentTarget.value),
      onBlur: commit,
      onKeyDown: (event) => {
        if (event.key === "Enter") commit();
        if (event.key === "Escape" && text !== null) {
          // The field's own Escape, not that of the view.
          event.stopPropagation();
          setText(null);
        }
      },
    },
  };
}
