// Who plans. Two workers: one works, the other stands ready to take over.
//
// While one works, a newer request waits, and only the latest is kept. What is being planned is
// finished if that takes no longer than PATIENCE, so that a drag draws; only then is its worker
// ended. Answers are told even if a newer request waits.

/** How long a newer plan waits for an older one, in ms. */
const PATIENCE = 400;

export class Planners {
  /** `listen(message)` hears `{ id, … }` with `progress`, `answer`, `less`, `reasons`, `files`, `failure` or `replaced`. */
  constructor(name, module, listen) {
    Object.assign(this, { name, module, listen, latest: 0, waiting: null, overdue: 0 });
    this.active = this.#spawn();
    this.spare = this.#spawn();
  }

  /** Plans a task, instead of one that still waits. Returns the number of its answer. */
  plan(job) {
    this.waiting = { ...job, id: ++this.latest, what: "plan" };
    this.#next();
    return this.latest;
  }

  /** Asks something else about the latest task, unless a newer one waits; a newer one ends it at once. */
  also(job) {
    if (this.waiting?.what === "plan") return;
    this.waiting = { ...job, id: this.latest };
    this.#next();
  }

  /** Ends what is being done. */
  cancel() {
    this.waiting = null;
    if (this.active.job) this.#replace();
  }

  /** Ends both workers; nothing is heard of them any more. */
  end() {
    clearTimeout(this.overdue);
    for (const planner of [this.active, this.spare]) {
      planner.worker.onmessage = planner.worker.onerror = null;
      planner.worker.terminate();
    }
  }

  #spawn() {
    const planner = { worker: new Worker(new URL("./worker.js", import.meta.url), { type: "module" }), ready: false, job: null };
    planner.worker.onmessage = ({ data }) => this.#heard(planner, data);
    planner.worker.onerror = event => this.listen({ id: this.latest, failure: event.message || "one of its files could not be loaded" });
    planner.worker.postMessage({ module: this.module, name: this.name });
    return planner;
  }

  #heard(planner, data) {
    if (data.ready) planner.ready = true;
    else if (planner !== this.active) return;
    else {
      const job = planner.job;
      if (data.failure) this.#replace();
      else if (!data.progress && !data.more) planner.job = null;
      this.listen({ ...data, job, took: performance.now() - planner.since });
    }
    this.#next();
  }

  #replace() {
    const { worker, job, since } = this.active;
    worker.terminate();
    this.active = this.spare;
    this.spare = this.#spawn();
    if (job?.what === "plan") this.listen({ id: job.id, job, replaced: true, took: performance.now() - since });
  }

  /** Begins what waits, as soon as somebody can. */
  #next() {
    clearTimeout(this.overdue);
    if (!this.waiting) return;
    if (this.active.job) {
      if (this.waiting.what !== "plan") return;
      const left = this.active.job.what === "plan" ? this.active.since + PATIENCE - performance.now() : 0;
      if (left > 0) this.overdue = setTimeout(() => this.#next(), left);
      // Otherwise the spare comes here when it is ready.
      if (left > 0 || !this.spare.ready) return;
      this.#replace();
    }
    if (!this.active.ready) return;
    this.active.job = this.waiting;
    this.active.since = performance.now();
    this.waiting = null;
    this.active.worker.postMessage(this.active.job);
  }
}
