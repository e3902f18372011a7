// Loads a planner, and says what is wrong where that fails.

/** The planner that a kind of task needs: the first one knows no scenes, and is small. */
export const plannerFor = kind => kind.room ? "all" : "first";

/**
 * A compiled planner, and a note about how it was served, if there is something to say. `tell(words)`
 * hears how far it is.
 */
export async function loadPlanner(name, tell) {
  const file = `pkg/${name}/carom_playground_bg.wasm`;
  const address = new URL(`./${file}`, import.meta.url);
  tell("Waiting for the server …");
  const served = await fetch(address).catch(() => {
    throw new Error(`The planner could not be loaded: the server of this page does not answer. Is it still running?`);
  });
  if (!served.ok) {
    throw new Error(`The planner is missing: the server answers ${served.status} for ${file}. ` +
      "In a clone, examples/playground/build makes it.");
  }
  const response = counted(served, tell), whole = response.clone();
  try {
    if (response.headers.get("Content-Type")?.startsWith("application/wasm")) {
      const module = await WebAssembly.compileStreaming(response);
      tell("");
      return { module, note: "" };
    }
  } catch { /* Below it is said why. */ }
  const compiled = await compile(new Uint8Array(await whole.arrayBuffer()), file);
  tell("");
  return compiled;
}

/** A response that tells how much of it has come. */
function counted(response, tell) {
  if (!response.body || !globalThis.TransformStream) return response;
  // What is compressed on its way has another length.
  const all = response.headers.get("Content-Encoding") ? 0 : Number(response.headers.get("Content-Length"));
  const megabytes = bytes => (bytes / 1e6).toFixed(1);
  let come = 0;
  const count = new TransformStream({ transform(chunk, out) {
    come += chunk.byteLength;
    tell(`${megabytes(come)}${all ? ` of ${megabytes(all)}` : ""} MB`);
    out.enqueue(chunk);
  } });
  return new Response(response.body.pipeThrough(count), { headers: response.headers });
}

/** A compiled module, also if it arrives compressed. */
export async function compile(bytes, file, what = "The planner") {
  const begins = (...start) => start.every((byte, k) => bytes[k] === byte);
  if (begins(0x1f, 0x8b)) {
    // Compressed, and served as if it were not.
    if (!globalThis.DecompressionStream) {
      throw new Error(`${what} arrives compressed: the server sends ${file} without the header "Content-Encoding: gzip".`);
    }
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const { module } = await compile(new Uint8Array(await new Response(stream).arrayBuffer()), file, what);
    return { module, note: `The server sends ${file} compressed without the header "Content-Encoding: gzip"; the page unpacked it.` };
  }
  if (!begins(0x00, 0x61, 0x73, 0x6d)) {
    throw new Error(`${what} cannot be read: what the server sends as ${file} is not WebAssembly. ` +
      'Is it compressed without the header "Content-Encoding", or another page in its place?');
  }
  try {
    return { module: await WebAssembly.compile(bytes), note: "" };
  } catch (error) {
    throw new Error(`${what} cannot be read: ${file} is damaged or incomplete (${error.message}).`);
  }
}
