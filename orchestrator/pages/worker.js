// The worker of the page: it computes and tells what it has, many times a second.

// Modules of one function each, with vectors and with the relaxed multiply-add a b + c.
const HEAD = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 8, 1, 96, 3, 124, 124, 124, 1, 124, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10,
];
const SPREAD = [32, 0, 253, 20, 32, 1, 253, 20, 32, 2, 253, 20];
const FIRST = [253, 33, 0, 11];
const withCode = (code) => new Uint8Array([...HEAD, code.length + 3, 1, code.length + 1, 0, ...code]);
const VECTORS = withCode([...SPREAD, 253, 240, 1, 253, 242, 1, ...FIRST]);
const RELAXED = withCode([...SPREAD, 253, 135, 2, ...FIRST]);

const CODES = ["plain", "simd", "relaxed"]; // from the one that needs least

// The relaxed multiply-add may be used only where it rounds once.
const best = () => {
  if (!WebAssembly.validate(VECTORS)) return "plain";
  if (!WebAssembly.validate(RELAXED)) return "simd";
  const { f } = new WebAssembly.Instance(new WebAssembly.Module(RELAXED), {}).exports;
  return f(1 + 2 ** -30, 1 - 2 ** -30, -1) === -(2 ** -60) ? "relaxed" : "simd";
};

const unpacked = async (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

const BATCH = 30; // ms of work between two messages
let known = null;

const prepare = async ({ plan, packed, wanted }) => {
  const able = CODES.slice(0, CODES.indexOf(best()) + 1);
  const variant = wanted || able.at(-1);
  if (!able.includes(variant)) throw new Error(`this browser has not what the code "${variant}" needs; it can take ${able.join(", ")}`);
  const modules = {};
  for (const kind of new Set(Object.values(plan.kinds)))
    modules[kind] = await WebAssembly.compile(await unpacked(packed[`${kind}-${variant}`]));
  known = { plan, modules, variant };
  postMessage({ kind: "ready", variant });
};

const compute = ({ number, offer, values }) => {
  const begin = performance.now();
  const run = new Cosimulation(known.plan, offer, known.modules, values);
  const settled = performance.now() - begin;
  const shown = Object.keys(known.plan.read);
  const peaks = Object.fromEntries(shown.map((title) => [title, Math.abs(run.value(title))]));
  let told = { rows: [row(run, shown)], frames: [run.frame()] };
  const tell = (done) => {
    postMessage({ kind: "computed", number, ...told, peaks, settled, spent: performance.now() - begin, done });
    told = { rows: [], frames: [] };
  };
  tell(false); // the first picture comes at once
  let last = performance.now();
  while (run.exchange < offer.exchanges) {
    run.advance();
    for (const title of shown) peaks[title] = Math.max(peaks[title], Math.abs(run.value(title)));
    if (run.exchange % offer.row_every === 0) told.rows.push(row(run, shown));
    if (run.exchange % offer.frame_every === 0) told.frames.push(run.frame());
    if (performance.now() - last > BATCH && told.frames.length) {
      tell(false);
      last = performance.now();
    }
  }
  tell(true);
};

const row = (run, shown) => [run.time(), ...shown.map((title) => run.value(title))];

onmessage = async ({ data }) => {
  try {
    if (data.kind === "prepare") await prepare(data);
    else compute(data);
  } catch (error) {
    postMessage({ kind: "failed", number: data.number, reason: error.message });
  }
};
