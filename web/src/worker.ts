// Builds the search tree of a surface beside the page, which stays responsive meanwhile.

import { BufferAttribute, BufferGeometry } from "three";
import { MeshBVH } from "three-mesh-bvh";

export interface Wanted { id: number; points: Float32Array; corners: Uint32Array }
/** A tree as it is sent; the package gives no type for it. */
export interface Built { id: number; tree: { roots: ArrayBuffer[]; index: null; indirectBuffer: Uint32Array | Uint16Array } }

self.onmessage = (event: MessageEvent<Wanted>) => {
  const { id, points, corners } = event.data;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(corners, 1));
  // Indirect: the triangles keep their order, in which faces are numbered.
  const made = MeshBVH.serialize(new MeshBVH(geometry, { indirect: true }), { cloneBuffers: false }) as unknown as Built["tree"];
  const tree = { ...made, index: null };
  (self as unknown as Worker).postMessage({ id, tree } satisfies Built, [...tree.roots, tree.indirectBuffer.buffer as ArrayBuffer]);
};
