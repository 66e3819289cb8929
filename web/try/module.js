// The WebAssembly module of crates/grainpath-wasm: a job and its files in, G-code and the report out. Used by the page's worker
// and, in Node, by the comparison of `cargo xtask wasm`.

/** Makes a module; `progress(stage, done, total)` is called while it plans. */
export async function start(compiled, progress) {
  const imports = {};
  for (const { module, name, kind } of WebAssembly.Module.imports(compiled)) {
    if (kind !== "function") throw new Error(`the module asks for ${module}.${name}, a ${kind}`);
    // Crates that can use a browser's functions name some through wasm-bindgen; the planner calls none of them.
    (imports[module] ??= {})[name] = () => { throw new Error(`${module}.${name} is not there`); };
  }
  Object.assign(imports.env, { now_s: () => performance.now() / 1000, progress });
  const { exports } = await WebAssembly.instantiate(compiled, imports);
  const put = (...pieces) => {
    const length = pieces.reduce((sum, piece) => sum + piece.length, 0);
    let at = exports.input(length);
    // Memory may have grown, and the old view is then empty; so it is taken anew.
    for (const piece of pieces) {
      new Uint8Array(exports.memory.buffer).set(piece, at);
      at += piece.length;
    }
  };
  const answer = (which) =>
    new Uint8Array(exports.memory.buffer, exports.answer(which) >>> 0, exports.answer_len(which)).slice();
  const encode = (text) => new TextEncoder().encode(text);
  const decode = (bytes) => new TextDecoder().decode(bytes);

  /** Plans the text of a job with `files` ({name: bytes}) and `sets` (["SECTION.KEY=VALUE"]); throws what is wrong in words. */
  return function plan(job, files, sets = []) {
    for (const [name, bytes] of Object.entries(files)) {
      const called = encode(name);
      put(called, bytes);
      exports.add_file(called.length);
    }
    for (const set of sets) {
      put(encode(set));
      exports.add_setting();
    }
    put(encode(job));
    let failed;
    try {
      failed = exports.plan() !== 0;
    } catch (trap) {
      // A trap leaves the module unusable; its last words are in the answer.
      const words = decode(answer(0));
      throw Object.assign(new Error(words || `${trap}`), { trap: true });
    }
    if (failed) throw new Error(decode(answer(0)));
    const planned = { gcode: answer(0), ...JSON.parse(decode(answer(1))) };
    exports.clear();
    return planned;
  };
}
