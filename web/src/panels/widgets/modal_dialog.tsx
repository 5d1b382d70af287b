// A native dialog over everything else: the browser keeps the focus inside and gives it back afterwards.
import { type KeyboardEvent, type ReactElement, type ReactNode, useLayoutEffect, useRef } from "react";

interface ModalDialogProps {
  readonly label: string;
  readonly className: string;
  readonly onClose: () => void;
  readonly onKeyDown?: (event: KeyboardEvent<HTMLDialogElement>) => void;
  readonly children: ReactNode;
}

export function ModalDialog({ label, className, onClose, onKeyDown, children }: ModalDialogProps): ReactElement {
  const dialog = useRef<HTMLDialogElement>(null);
  useLayoutEffect(() => {
    const element = dialog.current;
    if (element === null) return;
    element.showModal();
    // The browser would take the first button.
    element.querySelector<HTMLElement>("[data-first-focus]")?.focus({ preventScroll: true });
    // Closed before it is removed: only then the focus goes back to where it was.
    return () => element.close();
  }, []);
  return (
    <dialog
      ref={dialog}
      className={className}
      aria-label={label}
      onCancel={(event) => {
        // React takes it away.
        event.preventDefault();
        onClose();
      }}
      onKeyDown={(event) => {
        onKeyDown?.(event);
        if (event.key === "Escape" && !event.defaultPrevented) {
          event.preventDefault();
          onClose();
        }
        // Keys in a dialog are no commands of the view behind it.
        event.stopPropagation();
      }}
    >
      {children}
    </dialog>
  );
}
