// Degenerate points of tensor fields whose points are known in closed form.

import assert from "node:assert/strict";
import { build } from "esbuild";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const made = await build({ entryPoints: [fileURLToPath(new URL("../src/degenerate.ts", import.meta.url))], bundle: true, write: false, format: "esm", platform: "neutral" });
const { degenerate } = await import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].text).toString("base64")}`);

/** A square of 10 mm in x and y, cut into n x n squares of two triangles, in the plane that `place` makes of it. */
function square(n, stress, place = (x, y) => [x, y, 0]) {
  const [points, corners, nine] = [[], [], []];
  for (let j = 0; j <= n; j++) for (let i = 0; i <= n; i++) {
    const [x, y] = [(10 * i) / n, (10 * j) / n];
    points.push(...place(x, y));
    nine.push(...stress(x, y), 0, 0, 0);
  }
  for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) {
    const a = j * (n + 1) + i;
    corners.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
  }
  return [points, corners, nine];
}
const near = (found, wanted) => assert.ok(Math.hypot(...found.map((v, k) => v - wanted[k])) < 1e-6, `${found} is not ${wanted}`);

test("a linear field has its point where both differences vanish, of the kind that its turn says", () => {
  for (const [sign, isWedge] of [[1, true], [-1, false]]) {
    // (xx - yy) / 2 = x - 3.3, xy = +-(y - 7.1), about a mean of 20.
    const found = degenerate(...square(4, (x, y) => [20 + (x - 3.3), 20 - (x - 3.3), 0, sign * (y - 7.1), 0, 0]), 20);
    assert.equal(found.length, 1);
    near(found[0].at, [3.3, 7.1, 0]);
    assert.equal(found[0].isWedge, isWedge);
  }
});

test("a surface that stands upright has its own plane, and what crosses it does not count", () => {
  // In the plane y = 5: the stress zz takes the place of yy, and yy, xy and yz lie across.
  const found = degenerate(...square(5, (x, z) => [20 + (x - 4), 900, 20 - (x - 4), 70, -30, z - 6], (x, z) => [x, 5, z]), 20);
  assert.equal(found.length, 1);
  near(found[0].at, [4, 5, 6]);
});

test("a point on an edge or a corner of triangles is one", () => {
  const found = degenerate(...square(2, (x, y) => [20 + (x - 5), 20 - (x - 5), 0, y - 5, 0, 0]), 20);
  assert.equal(found.length, 1);
  near(found[0].at, [5, 5, 0]);
});

test("even pulls, bending and small stress have none", () => {
  for (const stress of [() => [20, 0, 0, 0, 0, 0], () => [20, 20, 0, 0, 0, 0], (x, y) => [y - 5, 0, 0, 0, 0, 0], (x, y) => [0.1 + (x - 5), 0.1 - (x - 5), 0, y - 5, 0, 0]]) {
    assert.deepEqual(degenerate(...square(4, stress), 20), []);
  }
});
