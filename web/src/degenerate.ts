// Degenerate points of the stress on a surface: where both principal stresses in the surface are equal, so that no direction
// is better than another, and the directions around turn by half a turn.
//
// In the plane of a triangle the stress is (a, b, c) = (xx, yy, xy). Half the difference (a - b) / 2 and c are linear over
// the triangle and vanish together in at most one point. The sign of their determinant tells the kind. Source: Delmarcelle
// and Hesselink, "The topology of symmetric, second-order tensor fields", 1994. Cost: linear in the triangles. Limits: where
// one of the two vanishes all over a triangle, the points form a line, which is left out; so are points whose stress is small.

/** A point, and whether its kind is a wedge (the directions turn with the way around it) or a trisector (against it). */
export interface Degenerate { at: [number, number, number]; isWedge: boolean }

/** Share of the end of the scale below which a stress is small. Source: that of principal lines. */
const LEAST = 0.04;
/** Least area of (difference, shear) over a triangle, against the square of the values: below it rounding decides. Source: chosen; values are 32-bit floats, with 1e-7 of their size. */
const LEAST_TURN = 1e-6;
/** How far a point may lie beside its triangle, so that one on an edge is found once at least. Source: 32-bit floats. */
const SLACK = 1e-6;

type V = [number, number, number];
const minus = (a: V, b: V): V => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: V, b: V) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: V, b: V): V => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: V): V => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };

/** The points of a surface with nine values a point, of which the first six are xx, yy, zz, xy, yz, zx; `end` is the end of the scale, MPa. */
export function degenerate(points: ArrayLike<number>, corners: ArrayLike<number>, nine: ArrayLike<number>, end: number): Degenerate[] {
  const found: Degenerate[] = [];
  for (let t = 0; t < corners.length; t += 3) {
    const all = [0, 1, 2].map((k) => corners[t + k]!);
    const [p, q, r] = all.map((i): V => [points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!]) as [V, V, V];
    const u = unit(minus(q, p));
    const v = unit(cross(cross(minus(q, p), minus(r, p)), u));
    const [half, shear, mean]: [number[], number[], number[]] = [[], [], []];
    for (const i of all) {
      const [xx, yy, zz, xy, yz, zx] = Array.from({ length: 6 }, (_, c) => nine[9 * i + c]!) as [number, number, number, number, number, number];
      const times = (w: V): V => [xx * w[0] + xy * w[1] + zx * w[2], xy * w[0] + yy * w[1] + yz * w[2], zx * w[0] + yz * w[1] + zz * w[2]];
      const [a, b] = [dot(u, times(u)), dot(v, times(v))];
      half.push((a - b) / 2);
      shear.push(dot(u, times(v)));
      mean.push((a + b) / 2);
    }
    const turn = (i: number, j: number) => half[i]! * shear[j]! - half[j]! * shear[i]!;
    const shares = [turn(1, 2), turn(2, 0), turn(0, 1)];
    const whole = shares[0]! + shares[1]! + shares[2]!;
    const size = Math.max(...half.map(Math.abs), ...shear.map(Math.abs), ...mean.map(Math.abs));
    if (Math.abs(whole) < LEAST_TURN * size * size) continue;
    const w = shares.map((s) => s / whole);
    if (Math.min(...w) < -SLACK || Math.abs(w.reduce((sum, x, k) => sum + x * mean[k]!, 0)) < LEAST * end) continue;
    const at = [0, 1, 2].map((c) => w[0]! * p[c]! + w[1]! * q[c]! + w[2]! * r[c]!) as V;
    // One on an edge is a point of both triangles.
    const near = 1e-4 * Math.hypot(...minus(q, p));
    if (!found.some((f) => Math.hypot(...minus(f.at, at)) < near)) found.push({ at, isWedge: whole > 0 });
  }
  return found;
}
