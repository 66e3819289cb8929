// The runs that are worked on or wait, each with how far it is and a button that cancels it.

import * as api from "./api";
import { el, fixed } from "./dom";

const STAGES: Record<string, string> = { read: "Reading", slice: "Shape", guide: "Stress", fill: "Walls and fill", support: "Supports", order: "Ordering", write: "Writing", strength: "Strength test" };
const KINDS: Record<api.JobState["kind"], string> = { view: "program", shape: "shape", stress: "stress", orient: "directions", supports: "supports", plan: "plan", strength: "strength test" };
/** Time between two questions to the server, ms. Source: chosen; twice a second looks like at once, and an answer has some hundred bytes. */
const PACE_MS = 500;

/** How far a run is, in words. */
export function howFar(run: api.JobState): string {
  if (run.phase === "waiting") return `Waits for ${run.ahead} other${run.ahead === 1 ? "" : "s"}`;
  return `${STAGES[run.stage ?? ""] ?? "Starting"}${run.total > 0 ? ` ${run.done} of ${run.total}` : ""}`;
}

/** Shows the queue in `into` while `isWanted` says so; `ended` is told when runs have ended since the last look, also of those that
 * were never seen here: a short run begins and ends between two looks. */
export async function queue(into: HTMLElement, isWanted: () => boolean, ended: () => Promise<void>): Promise<void> {
  // Rows stay while their runs do, so that the focus on a button does.
  const rows = new Map<number, { row: HTMLElement; far: HTMLElement; time: HTMLElement }>();
  const table = el("table", { id: "queue" }, el("tr", {}, ...["What", "File", "How far", "Time", ""].map((name) => el("th", { scope: "col" }, name || el("span", { class: "sr" }, "Cancel")))));
  const error = el("p", { class: "error", role: "alert", hidden: true });
  const say = (problem: unknown) => { error.textContent = (problem as Error).message; error.hidden = false; };
  const begin = (run: api.JobState) => {
    // The button keeps the focus, which a disabled one would lose.
    const off = el("button", { type: "button", "data-cancel": run.id, "aria-label": `Cancel ${KINDS[run.kind]} of ${run.title}`, onclick: () => {
      if (off.ariaDisabled) return;
      off.ariaDisabled = "true";
      void api.cancel(run.id).catch((p) => { off.ariaDisabled = null; say(p); });
    } }, "Cancel");
    const [far, time] = [el("td"), el("td", { class: "n" })];
    const row = el("tr", { "data-run": run.id }, el("td", {}, KINDS[run.kind]), el("td", {}, run.title), far, time, el("td", {}, off));
    table.append(row);
    rows.set(run.id, { row, far, time });
    return rows.get(run.id)!;
  };
  const known = new Set<number>();
  while (isWanted()) {
    try {
      const { jobs } = await api.jobs();
      const open = jobs.filter((run) => run.phase === "waiting" || run.phase === "running");
      const isNews = jobs.some((run) => !open.includes(run) && !known.has(run.id));
      for (const run of jobs) if (!open.includes(run)) known.add(run.id);
      for (const run of open) {
        const { far, time } = rows.get(run.id) ?? begin(run);
        far.textContent = howFar(run);
        time.textContent = run.phase === "waiting" ? "–" : `${fixed(run.elapsed_s, 1)} s`;
      }
      const over = [...rows.keys()].filter((id) => !open.some((run) => run.id === id));
      for (const id of over) {
        const { row } = rows.get(id)!;
        const next = row.nextElementSibling ?? row.previousElementSibling;
        if (row.contains(document.activeElement)) next?.querySelector("button")?.focus();
        row.remove();
        rows.delete(id);
      }
      const isEmpty = rows.size === 0;
      if (isEmpty !== (table.parentElement === null)) {
        into.replaceChildren(...(isEmpty ? [] : [el("h2", {}, "Worked on and waiting"), table, error]));
      }
      // What ended while the list was read is asked for at once, so that no run stands in both for long.
      if (isNews || over.length > 0) { await ended(); continue; }
    } catch (problem) {
      say(problem);
      into.replaceChildren(error);
      return;
    }
    await new Promise((then) => setTimeout(then, PACE_MS));
  }
}
