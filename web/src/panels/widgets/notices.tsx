// Short messages at the lower edge of the view. Errors stay until they are closed.
import { type ReactElement, useEffect } from "react";
import type { Notice } from "../../state/app_state.js";
import type { Store } from "../../state/store.js";
import { usePlay, useStore } from "../use_store.js";
import { IconButton } from "./icon_button.js";
import { Icon } from "./icons.js";

const SHORTEST_MS = 4000;
const PER_LETTER_MS = 60;

function dismiss(store: Store, id: number): void {
  store.update((state) => ({ notices: state.notices.filter((notice) => notice.id !== id) }));
}

export function Notices(): ReactElement {
  const notices = useStore((state) => state.notices);
  return (
    <div className="notices" role="log" aria-live="polite" aria-label="Messages">
      {notices.map((notice) => (
        <NoticeCard key={notice.id} notice={notice} />
      ))}
    </div>
  );
}

function NoticeCard({ notice }: { readonly notice: Notice }): ReactElement {
  const { store, commands } = usePlay();
  useEffect(() => {
    if (notice.kind === "error") return;
    const timer = setTimeout(
      () => dismiss(store, notice.id),
      Math.max(SHORTEST_MS, notice.text.length * PER_LETTER_MS),
    );
    return () => clearTimeout(timer);
  }, [store, notice]);
  return (
    <div className={`notice notice-${notice.kind} card`}>
      {notice.kind === "error" ? <Icon name="warning" size={18} /> : null}
      <div>
        <p>{notice.text}</p>
        {notice.actions.length === 0 ? null : (
          <div className="buttons">
            {notice.actions.map(({ label, command }) => (
              <button key={command} type="button" onClick={() => void commands.run(command)}>
                {label}
              </button>
            ))}
          </div>
        )}
      </div>
      <IconButton icon="close" label="Close this message" side="left" onClick={() => dismiss(store, notice.id)} />
    </div>
  );
}
