// The page's worker: it gets the module once, and then jobs, one after another.

let plan = null;

onmessage = async ({ data }) => {
  try {
    if (data.module) {
      let told = 0;
      plan = await start(data.module, (stage, done, total) => {
        // Ten times a second is as often as people see.
        const now = performance.now();
        if (done === 0 || now - told > 100) {
          told = now;
          postMessage({ stage, done, total });
        }
      });
      postMessage({ ready: true });
      return;
    }
    const from = performance.now();
    const planned = plan(data.job, data.files);
    postMessage({ planned, seconds: (performance.now() - from) / 1000 }, [planned.gcode.buffer]);
  } catch (problem) {
    postMessage({ problem: problem.message, trap: Boolean(problem.trap) || !plan });
  }
};
