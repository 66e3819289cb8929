// Finds the triangle of a surface that a ray meets first, with a search tree that a worker builds.

import { BufferAttribute, BufferGeometry, DoubleSide, type Ray, type Vector3 } from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { Built } from "./worker";

let worker: Worker | null = null;
let last = 0;

export interface Hit { triangle: number; point: Vector3; distance: number }

export class Search {
  private tree: MeshBVH | null = null;

  /** The tree is asked for at once and is there some time later; `then` is called when it is. */
  constructor(private readonly points: Float32Array, private readonly corners: Uint32Array, then: () => void) {
    worker ??= new Worker("worker.js", { type: "module" });
    const own = worker;
    const id = ++last;
    const take = (event: MessageEvent<Built>) => {
      if (event.data.id !== id) return;
      own.removeEventListener("message", take);
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(points, 3));
      geometry.setIndex(new BufferAttribute(corners, 1));
      this.tree = MeshBVH.deserialize(event.data.tree as never, geometry, { setIndex: false });
      then();
    };
    own.addEventListener("message", take);
    own.postMessage({ id, points, corners });
  }

  get isReady(): boolean { return this.tree !== null; }

  /** The first triangle on a ray. */
  first(ray: Ray): Hit | null {
    const hit = this.tree?.raycastFirst(ray, DoubleSide);
    return hit && hit.faceIndex != null ? { triangle: hit.faceIndex, point: hit.point, distance: hit.distance } : null;
  }

  /** The shares of a triangle's corners at a point of it. */
  shares(triangle: number, p: Vector3): [number, number, number] {
    const at = (k: number) => { const c = 3 * this.corners[3 * triangle + k]!; return [this.points[c]!, this.points[c + 1]!, this.points[c + 2]!] as const; };
    const [a, b, c] = [at(0), at(1), at(2)];
    const minus = (u: readonly number[], v: readonly number[]) => [u[0]! - v[0]!, u[1]! - v[1]!, u[2]! - v[2]!];
    const dot = (u: number[], v: number[]) => u[0]! * v[0]! + u[1]! * v[1]! + u[2]! * v[2]!;
    const [u, v, w] = [minus(b, a), minus(c, a), minus([p.x, p.y, p.z], a)];
    const [uu, uv, vv, wu, wv] = [dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)];
    const area = uu * vv - uv * uv;
    if (area <= 0) return [1, 0, 0];
    const s = (vv * wu - uv * wv) / area;
    const t = (uu * wv - uv * wu) / area;
    return [1 - s - t, s, t];
  }
}
