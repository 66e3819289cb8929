// The list of files on the server's side.

import * as api from "./api";
import { el, size } from "./dom";

const NAMES: Record<api.FileKind, string> = { job: "job", mesh: "mesh", outline: "outline", photo: "photograph", scan: "scan", program: "G-code", other: "" };

/** Files that the server knows by their ending and refuses, with what to do about it. */
const UNREAD: [RegExp, string][] = [
  [/\.bgcode$/i, "binary G-code: have it written as text"],
];

/** Lets the user choose a file; null where they do not. It begins beside `beside`. */
export async function chooser(dialog: HTMLDialogElement, beside: string | null): Promise<{ path: string; kind: api.FileKind } | null> {
  const { roots } = await api.state();
  const folder = beside?.replace(/[/\\][^/\\]*$/, "") ?? roots[0] ?? "";
  return new Promise((resolve) => {
    const list = el("div", { class: "files" });
    const here = el("p", { class: "note", "aria-live": "polite" });
    const finish = (chosen: { path: string; kind: api.FileKind } | null) => {
      dialog.onclose = null;
      if (dialog.open) dialog.close();
      resolve(chosen);
    };
    let asked = 0;
    const go = async (path: string): Promise<void> => {
      const own = ++asked;
      try {
        const listing = await api.files(path);
        // A large folder may come after one that was chosen later.
        if (own !== asked) return;
        here.textContent = listing.path;
        const rows: Node[] = [];
        if (listing.parent) rows.push(el("button", { type: "button", onclick: () => void go(listing.parent!) }, el("span", {}, ".."), el("span", {}, "up")));
        // Slices of a scan are pictures, TIFF or DICOM files of one folder; DICOM files often have no ending.
        const slices = listing.files.filter((f) => f.kind === "photo" || f.kind === "scan" || !f.name.includes(".")).length;
        if (slices > 1) rows.push(el("button", { type: "button", id: "open-folder", onclick: () => finish({ path: listing.path, kind: "scan" }) }, el("span", {}, "Open this folder as a scan"), el("span", {}, `${slices} slices`)));
        for (const f of listing.folders) rows.push(el("button", { type: "button", onclick: () => void go(f.path) }, el("span", {}, `${f.name}/`), el("span", {}, "folder")));
        for (const f of listing.files) {
          const open = () => finish({ path: f.path, kind: f.kind });
          const unread = UNREAD.find(([ending]) => ending.test(f.name))?.[1];
          rows.push(el("button", { type: "button", disabled: f.kind === "other" || Boolean(unread), onclick: open }, el("span", {}, f.name), el("span", {}, `${unread ?? NAMES[f.kind]} ${size(f.bytes)}`)));
        }
        if (listing.left_out > 0) rows.push(el("p", { class: "note" }, `${listing.left_out} more are not listed`));
        list.replaceChildren(...rows);
        (list.querySelector("button:not(:disabled)") as HTMLElement | null)?.focus();
      } catch (error) {
        if (own === asked) here.textContent = (error as Error).message;
      }
    };
    const tops = roots.length > 1 ? el("div", { class: "row" }, ...roots.map((r) => el("button", { type: "button", onclick: () => void go(r) }, r))) : null;
    dialog.replaceChildren(el("h2", {}, "Open a file of this computer"), ...(tops ? [tops] : []), here, list, el("p", {}, el("button", { type: "button", onclick: () => finish(null) }, "Close")));
    dialog.onclose = () => finish(null);
    dialog.showModal();
    void go(folder);
  });
}
