// Changes of jobs that were not saved, kept by the browser until they are: a closed tab loses nothing.

import type { FileKind } from "./api";

export interface Draft {
  path: string; kind: FileKind;
  /** The changed text, and the text of the file that was changed. */
  text: string; from: string;
  /** When it was changed last, milliseconds since 1970. */
  at: number;
}

/** Drafts beyond this number go, the oldest first. */
const MOST = 20;
const PREFIX = "draft:";

function read(key: string): Draft | null {
  try {
    const draft = JSON.parse(localStorage.getItem(key) ?? "null") as Partial<Draft> | null;
    const isWhole = typeof draft?.path === "string" && typeof draft.kind === "string" && typeof draft.text === "string" && typeof draft.from === "string" && typeof draft.at === "number";
    return isWhole ? (draft as Draft) : null;
  } catch {
    return null;
  }
}

/** All drafts, the newest first. */
export function drafts(): Draft[] {
  try {
    const all = Object.keys(localStorage).filter((key) => key.startsWith(PREFIX)).map(read);
    return all.filter((draft) => draft !== null).sort((a, b) => b.at - a.at);
  } catch {
    return [];
  }
}

export const draftOf = (path: string): Draft | null => read(PREFIX + path);

/** Keeps the changed text of a file; a text that is that of the file needs no keeping. */
export function keep(draft: Omit<Draft, "at">): void {
  if (draft.text === draft.from) { forget(draft.path); return; }
  try {
    const key = PREFIX + draft.path;
    // Each letter that is typed comes here; only a draft of another file may be one too many.
    const isAnother = localStorage.getItem(key) === null;
    localStorage.setItem(key, JSON.stringify({ ...draft, at: Date.now() }));
    if (isAnother) drafts().slice(MOST).forEach((old) => forget(old.path));
  } catch { /* A browser that keeps nothing keeps no drafts. */ }
}

export function forget(path: string): void {
  try { localStorage.removeItem(PREFIX + path); } catch { /* As above. */ }
}
