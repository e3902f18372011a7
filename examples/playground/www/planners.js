// Two workers: one plans, the other stands ready to take over when a slider moves meanwhile.

export class Planners {
  constructor(module, listen) {
    Object.assign(this, { module, listen, latest: 0, waiting: null });
    this.active = this.#spawn();
    this.spare = this.#spawn();
  }

  /** Plans a task, of a scene or beside a wall; what an earlier one would still have answered is dropped. */
  ask(task, isScene) {
    this.waiting = { id: ++this.latest, task, isScene };
    this.#next();
    return this.latest;
  }

  #spawn() {
    const planner = { worker: new Worker(new URL("./worker.js", import.meta.url), { type: "module" }), ready: false, busy: false };
    planner.worker.onmessage = ({ data }) => this.#heard(planner, data);
    planner.worker.onerror = event => this.listen({ id: this.latest, failure: event.message || "the planner could not be loaded" });
    planner.worker.postMessage({ module: this.module });
    return planner;
  }

  #heard(planner, data) {
    if (data.ready) planner.ready = true;
    else {
      if (data.reasons || data.failure) planner.busy = false;
      if (data.id === this.latest) this.listen(data);
    }
    this.#next();
  }

  #next() {
    if (!this.waiting) return;
    if (this.active.busy && this.spare.ready) {
      this.active.worker.terminate();
      this.active = this.spare;
      this.spare = this.#spawn();
    }
    if (this.active.busy || !this.active.ready) return;
    this.active.busy = true;
    this.active.worker.postMessage(this.waiting);
    this.waiting = null;
  }
}
