// Changes of jobs that were not saved, kept in the working folder of the studio until they are: a closed tab loses nothing.

import * as api from "./api";

export type Change = Omit<api.Draft, "at_s">;

/** The last change of each file that is not sent yet. */
const waiting = new Map<string, Change>();
/** Ends once all changes have been sent. */
let sending: Promise<void> = Promise.resolve();

/** Keeps the changed text of a file; a text that is that of the file needs no keeping. */
export function keep(change: Change): Promise<void> {
  // Each letter that is typed comes here. Those typed while an earlier change is sent go together.
  const isWaiting = waiting.has(change.path);
  waiting.set(change.path, change);
  if (isWaiting) return sending;
  const send = () => {
    const last = waiting.get(change.path)!;
    waiting.delete(change.path);
    return api.keep(last);
  };
  return (sending = sending.then(send, send));
}

export const forget = (path: string): Promise<void> => keep({ path, kind: "other", text: "", from: "" });

/** All drafts, the newest first. */
export const drafts = (): Promise<api.Draft[]> => sending.catch(() => {}).then(api.drafts);

// A request that was begun goes on when the tab is closed, but what waits for its end would be lost.
addEventListener("pagehide", () => { for (const change of waiting.values()) void api.keep(change); });
