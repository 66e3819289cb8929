// The server's answers. Every address is relative, so that the studio can be served below a path.

import type { Schema } from "./settings";

export type FileKind = "job" | "mesh" | "outline" | "photo" | "scan" | "program" | "other";
export interface StudioState { version: string; opened: { path: string; kind: FileKind } | null; work: string; roots: string[]; max_upload_bytes: number }
export interface Listing { path: string; parent: string | null; folders: { name: string; path: string }[]; files: { name: string; path: string; bytes: number; kind: FileKind }[]; left_out: number }
export interface JobState { id: number; kind: "view" | "shape" | "stress" | "orient" | "supports" | "plan" | "strength"; title: string; phase: "waiting" | "running" | "done" | "failed" | "cancelled"; ahead: number; stage: string | null; done: number; total: number; layers: boolean; ready: number; elapsed_s: number; error: string | null; code: number | null }
/** The viewer of a notebook does not know how long a layer takes. */
export interface LayerEntry { z_mm: number; height_mm: number; records: number; beads: number; printed_mm: number; volume_mm3: number; time_s?: number; seams: number }
export interface Index {
  origin_mm: [number, number]; step_mm: number; classes: string[]; speeds_mm_s: number[]; part_mm: [number[], number[]]; widths_mm: [number, number]; flow_mm3_s: number;
  shares: { beads: number; length_mm: number }[]; layers: LayerEntry[]; more: boolean; records: number; pulls: [number, number]; generator: string | null; time_s: number; filament_mm: number;
}
export interface Warning { id: string; text: string; place?: { file?: string; line?: number; layer?: number; z_mm?: number; point_mm?: number[] }; remedy?: string }
export interface StrengthReport {
  peak_load_n: number; low_n: number; high_n: number; stiffness_n_per_mm: number; first_n: number; peak_displacement_mm: number; job_load_n: number; mode: string;
  modes: Record<string, number>; weakest: { x_mm: number; y_mm: number; z_mm?: number; words: string }; mass_g: number; load_per_gram_n_g: number; fidelity: string; cell_mm: number;
  card_source: string; card_tier: string; curve: [number, number][]; corners: Record<string, number>; grid_share: number; seconds: number;
  /** The material and a hash of its card; rows of earlier versions have none. */
  card?: string;
}
export interface Result { report: Record<string, unknown> & { strength?: StrengthReport; summary?: string; reserve?: { first_failure?: number[] } }; angles: boolean; reserve: boolean; cases: string[] | null; warnings: Warning[]; outputs: { kind: string; path: string }[]; damage: Damage | null }
export interface Damage { cell_mm: number[]; angle_rad: number; cells: number; states: [number, number][] }
export interface FaceRow { number: number; name: string; kind: string; area_mm2: number; centre_mm: number[]; normal?: number[]; axis?: number[]; point_mm?: number[]; radius_mm?: number; hollow?: boolean; doubtful: boolean }
export interface ShapeReport {
  bodies: number; shells: number; triangles: number; open_edges: number; nonmanifold_edges: number; badly_wound_edges: number; zero_area_facets: number; edges_left: number;
  unit: string; unit_is_stated: boolean; likely_unit: string | null; low_mm: number[]; high_mm: number[]; volume_mm3: number;
  /** Of a scan: how coarse its surface is, and how many columns, rows and slices were merged. */
  preview?: { resolution_mm: number; voxels: number[]; merged: number[] };
  frame_is_part: boolean; rotation: number[][]; shift_mm: number[]; scale: number; faces_in_all: number; faces: FaceRow[];
}
/** A way in which the part stands. */
export interface Pose { rotate_deg: number[]; height_mm: number; support_g: number; time_s: number; flat_mm2: number; tilt_deg: number; reserve?: { first_failure: number[]; case: string; mode: string; across_layers_mpa: number } }
export interface SupportReport { mass_g: number | null; solid_mass_g: number; contacts: number; trees: number; farthest_mm: number; unreached: number[][] }
export interface Resultant { case: string; name: string; area_mm2: number; at_mm: number[]; force_n: number[]; moment_nmm: number[] }
/** The greatest stress and displacement of a load case. */
export interface CasePeak { case: string; max_von_mises_mpa: number; at_mm?: number[]; max_displacement_mm?: number }
export interface StressReport { elements: number; solver: string; dofs?: number; max_von_mises_mpa: number; max_displacement_mm?: number; error_estimate?: number; strength_mpa?: number; reserve?: number; peak_at_mm?: number[]; /** Of each case, where there are several. */ peaks?: CasePeak[]; loads?: Resultant[]; reactions?: Resultant[]; imbalance?: number }
/** What the strengths of a material rest on, by their tier in its profile (`material.strength_tier`). */
export const TIERS: Record<string, string> = { T0: "data sheets and literature (tier T0)", T1: "tests of coupons printed on this machine (tier T1)", T2: "tests of coupons and of a whole part (tier T2)" };
/** A line of the history. */
export interface RunRow { at_s: number; kind: "plan" | "strength"; name: string; input: string | null; mass_g: number | null; time_s: number | null; layers: number | null; strength: StrengthReport | null }
/** Changes of a file that were not saved. */
export interface Draft { path: string; kind: FileKind; /** The changed text, and the text of the file that was changed. */ text: string; from: string; /** When it was changed last, seconds since 1970. */ at_s: number }
export interface Profile { kind: string; name: string; about: string; toml: string }

/** Characters of a request that goes on when its page is closed. Source: browsers take 64 KiB, and a character has three bytes at most. */
const KEPT_ALIVE = 20_000;

/** The sentence of an error of the server. */
export class Refused extends Error {}

async function checked(answer: Response): Promise<Response> {
  if (answer.ok) return answer;
  let message = `the server answered ${answer.status}`;
  try {
    const body = (await answer.json()) as { error?: string };
    if (body.error) message = body.error;
  } catch {
    // Not JSON: the status has to do.
  }
  throw new Refused(message);
}

async function answered(address: string, init?: RequestInit): Promise<Response> {
  let answer: Response;
  try {
    answer = await fetch(address, init);
  } catch {
    throw new Refused("the studio does not answer; was it ended in the terminal?");
  }
  return checked(answer);
}

const json = async <T>(address: string, init?: RequestInit): Promise<T> => (await (await answered(address, init)).json()) as T;

export const state = () => json<StudioState>("v1/state");
export const files = (path: string) => json<Listing>(`v1/files?path=${encodeURIComponent(path)}`);
export const text = (path: string) => json<{ text: string; folder: string }>(`v1/text?path=${encodeURIComponent(path)}`);
/** The address of a photograph. */
export const picture = (path: string) => `v1/picture?path=${encodeURIComponent(path)}`;
/** Writes the text of a job under a new name; a relative one is below the working folder. */
export const save = (path: string, text: string) => json<{ path: string }>(`v1/text?path=${encodeURIComponent(path)}`, { method: "POST", headers: { "content-type": "text/plain" }, body: text });
/** Reads the text of a job without running it; the sentence of its first error, or none. */
export const check = (text: string): Promise<string> => json<{ error: string | null }>("v1/check", { method: "POST", headers: { "content-type": "text/plain" }, body: text }).then((told) => told.error ?? "", (e: Error) => e.message);
/** The job that the command line would make of a file or of the folder of a scan. */
export const jobFor = (path: string) => json<{ text: string; folder: string }>(`v1/job?path=${encodeURIComponent(path)}`);
export const examples = () => json<{ examples: { name: string; about: string }[] }>("v1/examples");
/** Writes an example to a new folder; the path of its job. */
export const example = (name: string) => json<{ path: string }>(`v1/examples?name=${encodeURIComponent(name)}`, { method: "POST" });
export const schema = () => json<Schema>("v1/schema");
export const profiles = () => json<{ profiles: Profile[] }>("v1/profiles");
/** All runs of this start of the studio that are still kept, the oldest first. */
export const jobs = () => json<{ jobs: JobState[] }>("v1/jobs");
export const history = () => json<{ runs: RunRow[] }>("v1/history");
export const drafts = async () => (await json<{ drafts: Draft[] }>("v1/drafts")).drafts;
export const index = (id: number) => json<Index>(`v1/jobs/${id}/layers`);
/** The file that a shape was read from. */
export const partFile = (id: number) => json<{ path: string; changed: boolean }>(`v1/jobs/${id}/part-file`);
export const result = (id: number) => json<Result>(`v1/jobs/${id}/result`);

/** Names this page to the server, with the number of its next change: the last change of a page that is left may overtake
 * the one before it. */
const PAGE = Math.random().toString(36).slice(2);
let changes = 0;
/** Keeps changes of a file that were not saved. A browser ends the request with its page where it is large. */
export async function keep(draft: Omit<Draft, "at_s">): Promise<void> {
  const body = JSON.stringify({ ...draft, page: PAGE, change: changes++ });
  await answered("v1/drafts", { method: "PUT", headers: { "content-type": "application/json" }, body, keepalive: body.length < KEPT_ALIVE });
}

export function begin(wanted: Record<string, unknown>): Promise<JobState> {
  return json<JobState>("v1/jobs", { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(wanted) });
}

export async function cancel(id: number): Promise<void> {
  await checked(await fetch(`v1/jobs/${id}`, { method: "DELETE" }));
}

export async function bytes(address: string, signal?: AbortSignal): Promise<ArrayBuffer> {
  return (await checked(await fetch(address, signal ? { signal } : {}))).arrayBuffer();
}

/** Follows a job until it is over. The browser asks again by itself where the stream breaks off. */
export function follow(id: number, each: (state: JobState) => void): Promise<JobState> {
  return new Promise((resolve, reject) => {
    const stream = new EventSource(`v1/jobs/${id}/events`);
    stream.onmessage = (event) => {
      const now = JSON.parse(event.data as string) as JobState;
      each(now);
      if (now.phase === "done" || now.phase === "failed" || now.phase === "cancelled") {
        stream.close();
        resolve(now);
      }
    };
    stream.onerror = () => {
      if (stream.readyState === EventSource.CLOSED) reject(new Refused("the studio does not answer; was it ended in the terminal?"));
    };
  });
}

/** Streams a file to the server's disk. */
export function upload(file: File, each: (share: number) => void): Promise<{ path: string }> {
  return new Promise((resolve, reject) => {
    // `fetch` does not tell how much was sent.
    const request = new XMLHttpRequest();
    request.open("POST", `v1/uploads?name=${encodeURIComponent(file.name)}`);
    request.responseType = "json";
    request.upload.onprogress = (event) => each(event.loaded / Math.max(event.total, 1));
    request.onload = () => {
      const answer = request.response as { path?: string; error?: string } | null;
      if (request.status === 200 && answer?.path) resolve({ path: answer.path });
      else reject(new Refused(answer?.error ?? `the server answered ${request.status}`));
    };
    request.onerror = () => reject(new Refused("the upload broke off; drop the file again"));
    request.send(file);
  });
}
