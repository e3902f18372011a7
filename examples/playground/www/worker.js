// One planner. The page ends this worker when its answer is out of date.
import init, { explain, explain_scene, plan, plan_scene } from "./pkg/carom_playground.js";

let ready;
onmessage = async ({ data }) => {
  try {
    if (data.module) {
      ready = init({ module_or_path: data.module });
      await ready;
      postMessage({ ready: true });
      return;
    }
    await ready;
    const { id, task, isScene } = data;
    const text = JSON.stringify(task);
    const answer = JSON.parse((isScene ? plan_scene : plan)(text));
    postMessage({ id, answer });
    if (answer.error) return postMessage({ id, reasons: {} });
    // One step less than the shortest plan; without a plan, the longest one that was refuted.
    const less = side => side.found ? side.steps - 1 : side.refuted;
    postMessage({ id, reasons: JSON.parse((isScene ? explain_scene : explain)(text, less(answer.free), less(answer.tolerant))) });
  } catch (error) {
    postMessage({ id: data.id, failure: String(error) });
  }
};
