import assert from "node:assert/strict";
import test from "node:test";
import { wireLink } from "../../../src/entry/wire_link.js";
import { engineText } from "../../../src/panels/shell/status_text.js";
import type { Link } from "../../../src/protocol/link_api.js";
import { initialState } from "../../../src/state/initial.js";
import { Store } from "../../../src/state/store.js";
import { sampleProject } from "../state/samples.js";

test("a short loss of the connection hides that the frame is exact, and it is again afterwards", () => {
  const store = new Store(initialState(sampleProject()));
  type Listener = Parameters<Link["onEngine"]>[0];
  let tell: Listener = () => {};
  const link = {
    onEngine: (listener: Listener) => {
      tell = listener;
      return () => {};
    },
    onProgress: () => () => {},
  } as unknown as Link;
  wireLink(link, store);
  const { pass: _pass, passes: _passes, ...status } = store.get().engine;
  const here = { ...status, connected: true, ready: true };
  const kind = () => engineText(store.get().engine, store.get().layers).kind;
  tell(here);
  store.update(({ engine }) => ({ engine: { ...engine, pass: 2, passes: 3 } }));
  assert.equal(kind(), "exact");
  tell({ ...here, connected: false, ready: false });
  assert.equal(kind(), "lost");
  tell({ ...here, ready: false });
  assert.equal(kind(), "off");
  tell(here);
  assert.equal(kind(), "exact");
});
