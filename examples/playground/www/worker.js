// One planner. The page ends this worker when what it does is out of date.
let planner, ready;

const call = (job, what, ...more) =>
  JSON.parse(planner[job.isScene ? `${what}_scene` : what](JSON.stringify(job.task), ...more));

/** News are told some twenty times a second, and whatever was found at once. */
function telling(job) {
  let last = 0;
  return text => {
    const isFound = !text.endsWith('"found":null}'), now = performance.now();
    if (!isFound && now - last < 50) return;
    last = now;
    postMessage({ id: job.id, progress: JSON.parse(text) });
  };
}

function done(job) {
  if (job.what === "plan") return { answer: call(job, "plan", telling(job)) };
  if (job.what === "files") return { files: call({ ...job, task: { ...job.task, files: true } }, "plan", () => {}) };
  postMessage({ id: job.id, less: call(job, "less", ...job.steps), more: true });
  return { reasons: call(job, "explain", ...job.steps) };
}

async function begin({ module, name }) {
  planner = await import(`./pkg/${name}/carom_playground.js`);
  await planner.default({ module_or_path: module });
}

onmessage = async ({ data }) => {
  try {
    if (data.module) {
      ready = begin(data);
      await ready;
      return postMessage({ ready: true });
    }
    await ready;
    postMessage({ id: data.id, ...done(data) });
  } catch (error) {
    postMessage({ id: data.id, failure: String(error) });
  }
};
