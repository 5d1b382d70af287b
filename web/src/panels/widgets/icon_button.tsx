// A button with an icon, its name and key in a tooltip that keyboard users see too.
import type { ReactElement } from "react";
import { Icon, type IconName } from "./icons.js";

interface IconButtonProps {
  readonly icon: IconName;
  readonly label: string;
  /** Keys as they are shown, such as "Ctrl+Z". */
  readonly keys?: readonly string[];
  /** Given for buttons that stay pressed. */
  readonly pressed?: boolean;
  readonly disabled?: boolean;
  readonly side?: "right" | "left" | "below" | "above";
  readonly className?: string;
  readonly onClick: () => void;
}

export function IconButton(props: IconButtonProps): ReactElement {
  const { icon, label, keys = [], pressed, disabled = false, side = "right", className = "", onClick } = props;
  return (
    <button
      type="button"
      className={`icon-button ${className}`}
      aria-label={label}
      aria-pressed={pressed}
      aria-keyshortcuts={keys.length > 0 ? keys.map(ariaKey).join(" ") : undefined}
      disabled={disabled}
      onClick={onClick}
    >
      <Icon name={icon} />
      <span className={`tip tip-${side}`} aria-hidden="true">
        {label}
        {keys.slice(0, 1).map((key) => (
          <kbd key={key}>{key}</kbd>
        ))}
      </span>
    </button>
  );
}

function ariaKey(key: string): string {
  return key.replace(/\bCtrl\b/i, "Control");
}
