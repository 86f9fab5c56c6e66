'use strict';
// Arrays that tusqh/explorer/encode.py packed, and the facts beside them.

const TYPES = {
  uint8: Uint8Array, int8: Int8Array, uint16: Uint16Array,
  uint32: Uint32Array, int32: Int32Array, float32: Float32Array,
};

/** Return the arrays of a block by name. */
async function unpack(name, manifest) {
  const text = atob(document.getElementById(`data-${name}`).textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  const block = await new Response(stream).arrayBuffer();
  return Object.fromEntries(manifest.map((entry) =>
    [entry.name, new TYPES[entry.type](block, entry.offset, entry.length)]));
}

/** Return numbers whose differences are given. */
function accumulate(steps) {
  const out = new Int32Array(steps.length);
  for (let i = 0, sum = 0; i < out.length; i++) out[i] = sum += steps[i];
  return out;
}
