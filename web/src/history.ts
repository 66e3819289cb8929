// The history of runs in the working folder, and two of them side by side.

import * as api from "./api";
import { duration, el, fixed } from "./dom";
import { queue } from "./queue";

type Row = [string, string, string, string];

/** A number of a run in words; a dash where it has none. */
const words = (value: number | null | undefined, digits: number, unit: string) => (value === null || value === undefined ? "–" : `${fixed(value, digits)} ${unit}`);
/** The second over the first in per cent; nothing where one is missing. */
const share = (a: number | null | undefined, b: number | null | undefined) => (a && b ? `${fixed((100 * b) / a, 1)} %` : "");
const file = (run: api.RunRow) => run.input?.split(/[/\\]/).pop() ?? run.name;

/** Whether two tests rest on one card. Runs of earlier versions tell its source alone. */
const isOneCard = (a: api.StrengthReport, b: api.StrengthReport) => (a.card && b.card ? a.card === b.card : a.card_source === b.card_source);

/**
 * The peak load of one part over that of another with its interval, as `grainpath compare` tells it: corner by corner of the
 * card where both share it, and wider by what the grid moves either of them; else from low over high to high over low.
 */
export function ratio(a: api.StrengthReport, b: api.StrengthReport): { nominal: number; low: number; high: number } {
  const nominal = b.peak_load_n / a.peak_load_n;
  if (!isOneCard(a, b)) return { nominal, low: b.low_n / a.high_n, high: b.high_n / a.low_n };
  const all = [nominal, ...Object.entries(b.corners).flatMap(([name, load]) => (a.corners[name] ? [load / a.corners[name]!] : []))];
  const grid = Math.max(a.grid_share, b.grid_share);
  return { nominal, low: Math.min(...all) * (1 - grid), high: Math.max(...all) * (1 + grid) };
}

/** The rows of a table of two runs. */
function compared(a: api.RunRow, b: api.RunRow): Row[] {
  const [s, t] = [a.strength, b.strength];
  const number = (name: string, of: (run: api.RunRow) => number | null | undefined, digits: number, unit: string): Row => [name, words(of(a), digits, unit), words(of(b), digits, unit), share(of(a), of(b))];
  const peak = (r: api.StrengthReport | null) => (r ? `${fixed(r.peak_load_n, 0)} N (${fixed(r.low_n, 0)} to ${fixed(r.high_n, 0)})` : "–");
  const card = (r: api.StrengthReport | null) => (r ? `${r.card ?? "strengths"}, from ${api.TIERS[r.card_tier] ?? `tier ${r.card_tier}`}` : "–");
  const rows: Row[] = [
    number("Mass", (r) => r.mass_g, 2, "g"),
    ["Printing time", a.time_s === null ? "–" : duration(a.time_s), b.time_s === null ? "–" : duration(b.time_s), share(a.time_s, b.time_s)],
    number("Layers", (r) => r.layers, 0, ""),
  ];
  if (!s && !t) return rows;
  const both = s && t ? ratio(s, t) : null;
  rows.push(
    ["Breaks at", peak(s), peak(t), both ? `${fixed(100 * both.nominal, 1)} % (${fixed(100 * both.low, 1)} to ${fixed(100 * both.high, 1)})` : ""],
    number("Load of the job", (r) => r.strength?.job_load_n, 0, "N"),
    number("First bead fails at", (r) => r.strength?.first_n, 0, "N"),
    number("Stiffness", (r) => r.strength?.stiffness_n_per_mm, 0, "N/mm"),
    number("Load over mass", (r) => r.strength?.load_per_gram_n_g, 1, "N/g"),
    // Strength is compared at equal mass: a heavier part carries more. Far from its own mass that says little.
    number(`Breaks at, for ${words(a.mass_g, 2, "g")} of each${isAlike(a, b) ? "" : `, the second taken ${fixed(a.mass_g! / b.mass_g!, 2)} times as heavy`}`, (r) => (r.strength && a.mass_g ? r.strength.load_per_gram_n_g * a.mass_g : null), 0, "N"),
    ["Fails mostly", s?.mode ?? "–", t?.mode ?? "–", ""],
    ["Weakest at", s?.weakest.words ?? "–", t?.weakest.words ?? "–", ""],
    ["Card", card(s), card(t), ""],
  );
  return rows;
}

/** Whether the planner made the program of a run: then it can be planned again at another mass. */
const isPlanned = (run: api.RunRow) => run.input === null || run.input.endsWith(".toml");
/** Whether two runs have one mass, or one of them none. */
const isAlike = (a: api.RunRow, b: api.RunRow) => !a.mass_g || !b.mass_g || Math.abs(a.mass_g / b.mass_g - 1) < SAME_MASS;
/** Masses that differ by less count as equal, as a share. Source: what `fill.mass_g` keeps to. */
const SAME_MASS = 0.01;

/**
 * Opens the list of runs; the newest ones, or those of these names, are marked from the beginning. `again` plans a run anew at
 * a mass and tests it; `beside` is the name of the run that it is compared with. `open` shows a run by itself.
 */
export async function history(dialog: HTMLDialogElement, chosen: number | string[], again: (run: api.RunRow, mass_g: number, beside: string) => void, open: (run: api.RunRow) => void): Promise<void> {
  let { runs } = await api.history();
  const marked = typeof chosen === "number" ? runs.filter((run) => run.strength).slice(0, chosen) : chosen.flatMap((name) => runs.find((run) => run.name === name) ?? []);
  const answer = el("div", { id: "compared", role: "status" });
  const boxes = new Map<api.RunRow, HTMLInputElement>();
  const boxOf = (run: api.RunRow) => {
    const box = el("input", { type: "checkbox", checked: marked.includes(run), "aria-label": `Compare ${file(run)} of ${when(run)}`, onchange: () => {
      if (box.checked) marked.push(run); else marked.splice(marked.indexOf(run), 1);
      // Two at a time: the one that was marked longest gives way.
      if (marked.length > 2) boxes.get(marked.shift()!)!.checked = false;
      tell();
    } });
    boxes.set(run, box);
    return box;
  };
  const tell = () => {
    if (marked.length < 2) { answer.replaceChildren(el("p", { class: "note" }, runs.length > 1 ? "Mark two runs to see them side by side." : "Two runs can be seen side by side.")); return; }
    // The older one comes first.
    const [b, a] = [...marked].sort((p, q) => runs.indexOf(p) - runs.indexOf(q)) as [api.RunRow, api.RunRow];
    const head = (run: api.RunRow) => el("th", { scope: "col" }, `${file(run)}, ${when(run)}`);
    const both = a.strength && b.strength ? ratio(a.strength, b.strength) : null;
    // What counts is a plan of that mass: load over mass alone takes a part for as strong as it is heavy.
    const equal = (run: api.RunRow, other: api.RunRow, which: string, id: string) => {
      if (!isPlanned(run) || isAlike(run, other)) return null;
      return el("button", { type: "button", id, onclick: () => { dialog.close(); again(run, other.mass_g!, other.name); } }, `Plan the ${which} anew at ${words(other.mass_g, 2, "g")} and test it`);
    };
    const buttons = [equal(b, a, "second", "equal-second"), equal(a, b, "first", "equal-first")].filter((button) => button !== null);
    answer.replaceChildren(
      el("h2", {}, "Side by side"),
      el("table", {}, el("tr", {}, el("td"), head(a), head(b), el("th", { scope: "col" }, "second over first")),
        ...compared(a, b).map(([name, ...cells]) => el("tr", {}, el("th", { scope: "row" }, name), ...cells.map((cell) => el("td", {}, cell))))),
      ...(both && !isOneCard(a.strength!, b.strength!) ? [el("p", { class: "note" }, `The materials differ (${a.strength!.card ?? a.strength!.card_source} and ${b.strength!.card ?? b.strength!.card_source}): what is not known of one is not known of the other, so the interval goes from the low load of the second over the high one of the first to the reverse.`)] : []),
      ...(both ? [el("p", { id: "decided" }, both.low > 1 ? "The second carries more." : both.high < 1 ? "The first carries more." : "Which one carries more is not decided: the interval holds 100 %.")] : []),
      ...(buttons.length > 0 ? [el("div", { class: "row" }, ...buttons)] : []),
    );
  };
  const list = el("div");
  const rowOf = (run: api.RunRow) => el("tr", {}, el("td", {}, boxOf(run)), el("td", {}, when(run)), el("td", {}, run.kind === "plan" ? "plan" : "strength test"), el("td", { title: run.name }, file(run)),
    el("td", { class: "n" }, words(run.mass_g, 2, "g")), el("td", { class: "n" }, run.time_s === null ? "–" : duration(run.time_s)), el("td", { class: "n" }, words(run.strength?.peak_load_n, 0, "N")), el("td", {}, el("button", { type: "button", "data-open": run.name, "aria-label": `Open ${file(run)} of ${when(run)}`, onclick: () => { dialog.close(); open(run); } }, "Open")));
  const heads = el("tr", {}, ...["", "When", "What", "File", "Mass", "Time", "Breaks at", "Open"].map((name) => el("th", { scope: "col" }, name || el("span", { class: "sr" }, "Compare"))));
  /** Puts rows of runs on top of the list. The others stay as they are, and so does the focus on their controls. */
  const add = (added: api.RunRow[]) => {
    if (runs.length === 0) list.replaceChildren(el("p", { class: "note" }, "None yet: plans and strength tests are listed here, and stay when the studio is ended."));
    else if (!heads.parentElement) list.replaceChildren(el("div", { class: "files" }, el("table", { id: "all-runs" }, heads)));
    heads.after(...added.map(rowOf));
    if (marked.length < 2 || added.length === runs.length) tell();
  };
  add(runs);
  const busy = el("div");
  dialog.replaceChildren(busy, el("h2", {}, "Runs in this folder"), list, answer, el("p", {}, el("button", { type: "button", onclick: () => dialog.close() }, "Close")));
  dialog.showModal();
  // A run that has ended comes to the top of the list.
  void queue(busy, () => dialog.open && busy.isConnected, async () => {
    const { runs: now } = await api.history();
    const last = runs[0];
    const known = last ? now.findIndex((run) => run.at_s === last.at_s && run.name === last.name) : now.length;
    // Nothing of the list is told any more: it is made anew.
    if (known < 0) { [runs, marked.length] = [[], 0]; heads.remove(); }
    const added = known < 0 ? now : now.slice(0, known);
    if (added.length === 0 && known >= 0) return;
    runs = [...added, ...runs];
    add(added);
  });
}

const when = (run: api.RunRow) => new Date(1000 * run.at_s).toLocaleString([], { dateStyle: "short", timeStyle: "short" });
