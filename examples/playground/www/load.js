// Loads the planner, and says what is wrong where that fails.

const FILE = "carom_playground_bg.wasm";

/** The compiled planner, and a note about how it was served, if there is something to say. */
export async function loadPlanner() {
  const address = new URL(`./pkg/${FILE}`, import.meta.url);
  const response = await fetch(address).catch(() => {
    throw new Error(`The planner could not be loaded: the server of this page does not answer. Is it still running?`);
  });
  if (!response.ok) {
    throw new Error(`The planner is missing: the server answers ${response.status} for pkg/${FILE}. ` +
      "In a clone, examples/playground/build makes it.");
  }
  const whole = response.clone();
  try {
    if (response.headers.get("Content-Type")?.startsWith("application/wasm")) {
      return { module: await WebAssembly.compileStreaming(response), note: "" };
    }
  } catch { /* Below it is said why. */ }
  return compile(new Uint8Array(await whole.arrayBuffer()));
}

async function compile(bytes) {
  const begins = (...start) => start.every((byte, k) => bytes[k] === byte);
  if (begins(0x1f, 0x8b)) {
    // Compressed, and served as if it were not.
    if (!globalThis.DecompressionStream) {
      throw new Error(`The planner arrives compressed: the server sends pkg/${FILE} without the header "Content-Encoding: gzip".`);
    }
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const { module } = await compile(new Uint8Array(await new Response(stream).arrayBuffer()));
    return { module, note: `The server sends pkg/${FILE} compressed without the header "Content-Encoding: gzip"; the page unpacked it.` };
  }
  if (!begins(0x00, 0x61, 0x73, 0x6d)) {
    throw new Error(`The planner cannot be read: what the server sends as pkg/${FILE} is not WebAssembly. ` +
      'Is it compressed without the header "Content-Encoding", or another page in its place?');
  }
  try {
    return { module: await WebAssembly.compile(bytes), note: "" };
  } catch (error) {
    throw new Error(`The planner cannot be read: pkg/${FILE} is damaged or incomplete (${error.message}).`);
  }
}
