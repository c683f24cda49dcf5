// The page: sliders, the worker, and pictures of what it has computed so far.

const byId = (id) => document.getElementById(id);
const DOUBLINGS = 2; // sliders go from a quarter of the value of the case to four times as much
const PACE = 45; // ms for which a frame is shown

const trouble = (text) => {
  byId("trouble").textContent = text;
  byId("trouble").hidden = !text;
};

const unpackedText = async (id) => {
  const bytes = Uint8Array.from(atob(byId(id).textContent.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
};

const rounded = (number) => String(Number(number.toPrecision(3)));

class Sliders {
  // changed: called when one of them has been moved
  constructor(data, changed) {
    this.data = data;
    this.models = [...new Set(data.offers.map((offer) => offer.model))];
    this.model = byId("model");
    for (const model of this.models) this.model.append(new Option(model || "as it is", model));
    byId("model-row").hidden = this.models.length < 2;
    this.scales = ["mass", "height", "modulus"].map(byId);
    this.thickness = byId("thickness");
    this.fillThicknesses(data.offers[0].thickness);
    this.model.addEventListener("change", () => this.fillThicknesses(this.offer().thickness));
    for (const control of [this.model, this.thickness, ...this.scales]) {
      control.addEventListener("input", () => this.show());
      control.addEventListener("change", () => changed());
    }
    byId("reset").addEventListener("click", () => {
      this.reset();
      changed();
    });
    this.show();
  }

  offered() {
    const found = this.data.offers.filter((offer) => offer.model === this.model.value);
    return found.sort((one, other) => one.thickness - other.thickness);
  }

  // Offers the thicknesses of the chosen model, the nearest to the one before.
  fillThicknesses(thickness) {
    const offered = this.offered();
    const apart = offered.map((offer) => Math.abs(offer.thickness - thickness));
    this.thickness.max = offered.length - 1;
    this.thickness.value = apart.indexOf(Math.min(...apart));
    byId("thickness-row").hidden = offered.length < 2;
    this.show();
  }

  offer() {
    return this.offered()[Math.min(Number(this.thickness.value), this.offered().length - 1)];
  }

  reset() {
    for (const scale of this.scales) scale.value = 0;
    this.model.value = this.data.offers[0].model;
    this.fillThicknesses(this.data.offers[0].thickness);
  }

  // Start values that differ from those of the offer: at rest, the sliders change no bit.
  values() {
    const { moved } = this.offer();
    const [mass, height, modulus] = this.scales.map((scale) => 2 ** Number(scale.value));
    const values = {};
    if (mass !== 1) {
      values.mass = moved.mass.value * mass;
      values.radius = moved.radius.value * Math.cbrt(mass);
      values.height = moved.height.value + values.radius - moved.radius.value;
    }
    if (height !== 1) values.speed = moved.speed.value * Math.sqrt(height);
    if (modulus !== 1) values.modulus = moved.modulus.value * modulus;
    return values;
  }

  show() {
    const { moved, thickness } = this.offer();
    const now = { ...Object.fromEntries(Object.entries(moved).map(([k, v]) => [k, v.value])), ...this.values() };
    const fall = (now.speed * now.speed) / (2 * this.data.gravity);
    byId("mass-value").textContent = `${rounded(now.mass)} kg, radius ${rounded(100 * now.radius)} cm`;
    byId("height-value").textContent = `${rounded(fall)} m, ${rounded(Math.abs(now.speed))} m/s`;
    byId("modulus-value").textContent = `${rounded(now.modulus / 1e6)} MPa`;
    byId("thickness-value").textContent = `${rounded(100 * thickness)} cm`;
  }
}

class Player {
  constructor(data) {
    const { colours } = data;
    this.data = data;
    this.titles = Object.keys(data.read);
    const curve = (title, factor) => ({ colour: colours[title], place: 1 + this.titles.indexOf(title), factor });
    this.sand = new SandPicture(byId("sand"), colours);
    this.curves = [
      new CurvePicture(byId("forces"), colours, "force (kN)", [curve("transmitted", 1e-3), curve("on_rock", 1e-3)]),
    ];
    for (const part of ["deflection-figure", "deflection-row"]) byId(part).hidden = !data.read.deflection;
    if (data.read.deflection)
      this.curves.push(new CurvePicture(byId("deflection"), colours, "deflection (mm)", [curve("deflection", 1e3)]));
    this.slider = byId("instant");
    this.slider.addEventListener("input", () => this.hold());
    byId("play").addEventListener("click", () => (this.timer ? this.hold() : this.play()));
    new ResizeObserver(() => this.draw()).observe(byId("sand").parentElement);
  }

  begin(offer) {
    Object.assign(this, { offer, rows: [], frames: [], peaks: null, largest: 1e-9, done: false });
    this.seconds = (offer.exchanges * this.data.exchange) / this.data.rate;
    this.slider.max = Math.floor(offer.exchanges / offer.frame_every);
    this.slider.value = 0;
    this.play();
  }

  take(message) {
    if (!this.frames.length) this.sand.frameOf(message.frames[0], this.data.body);
    const first = !this.frames.length;
    this.rows.push(...message.rows);
    this.frames.push(...message.frames);
    for (const { contacts } of message.frames)
      if (contacts.length) this.largest = Math.max(this.largest, contacts[contacts.length - 1]);
    this.peaks = message.peaks;
    this.done = message.done;
    if (first || !this.timer) this.draw();
    this.tell(message);
  }

  play() {
    if (this.done && Number(this.slider.value) >= this.frames.length - 1) this.slider.value = 0;
    byId("play").textContent = "stop";
    clearInterval(this.timer);
    this.timer = setInterval(() => this.next(), PACE);
  }

  next() {
    if (Number(this.slider.value) < this.frames.length - 1) {
      this.slider.value = Number(this.slider.value) + 1;
      this.draw();
    } else if (this.done) this.hold();
  }

  hold() {
    clearInterval(this.timer);
    this.timer = 0;
    byId("play").textContent = "play";
    this.slider.value = Math.min(Number(this.slider.value), Math.max(this.frames.length - 1, 0));
    this.draw();
  }

  draw() {
    if (!this.frames || !this.frames.length) return;
    const number = Math.min(Number(this.slider.value), this.frames.length - 1);
    const frame = this.frames[number];
    this.sand.draw(frame, this.offer.discs, this.largest);
    const shown = this.rows.filter((row) => row[0] <= frame.time * (1 + 1e-9)).length;
    for (const picture of this.curves) picture.draw(this.rows, shown, this.seconds);
    byId("time").textContent = `${(1e3 * frame.time).toFixed(1)} ms`;
    document.documentElement.dataset.frame = String(number);
  }

  tell({ peaks, done, spent }) {
    const units = { transmitted: [1e-3, "kN"], on_rock: [1e-3, "kN"], penetration: [100, "cm"], deflection: [1e3, "mm"] };
    for (const [title, largest] of Object.entries(peaks)) {
      const [factor, unit] = units[title];
      byId(`peak-${title}`).textContent = `${rounded(factor * largest)} ${unit}`;
    }
    byId("spent").textContent = done ? `computed in ${(spent / 1e3).toFixed(2)} s` : "computing …";
  }
}

// The worker and what is asked of it. What is out of date is not waited for: a new one begins.
class Computation {
  constructor(data, player) {
    Object.assign(this, { data, player, number: 0 });
    this.packed = {};
    for (const module of document.querySelectorAll("[data-module]")) this.packed[module.dataset.module] = module.textContent;
    this.address = URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" }));
  }

  start(offer, values) {
    if (this.worker && !this.idle) {
      this.worker.terminate();
      this.worker = null;
    }
    this.number += 1;
    this.idle = false;
    this.request = { kind: "compute", number: this.number, offer, values };
    trouble("");
    byId("spent").textContent = "the sand comes to rest …";
    document.documentElement.dataset.done = "no";
    this.player.begin(offer);
    if (this.worker) this.worker.postMessage(this.request);
    else this.hire();
  }

  hire() {
    this.worker = new Worker(this.address);
    this.worker.onmessage = ({ data }) => this.hear(data);
    this.worker.onerror = (event) => trouble(`The computation cannot start: ${event.message}`);
    const wanted = new URLSearchParams(location.hash.slice(1)).get("code");
    this.worker.postMessage({ kind: "prepare", plan: this.data, packed: this.packed, wanted });
  }

  hear(message) {
    if (message.kind === "ready") {
      byId("code").textContent = NAMES[message.variant];
      this.worker.postMessage(this.request);
    } else if (message.kind === "failed") {
      this.idle = true;
      this.player.hold();
      trouble(`This cannot be computed: ${message.reason}`);
      byId("spent").textContent = "";
      document.documentElement.dataset.done = "failed";
    } else if (message.number === this.number) {
      this.player.take(message);
      window.peaks = message.peaks;
      document.documentElement.dataset.ready = "yes";
      this.idle = message.done;
      if (message.done) document.documentElement.dataset.done = "yes";
    }
  }
}

const NAMES = {
  plain: "without vectors, several times slower",
  simd: "with vectors of two numbers",
  relaxed: "with vectors of two numbers and a fused multiply-add",
};

const begin = async () => {
  if (typeof WebAssembly === "undefined") {
    trouble("This browser has no WebAssembly, or it is switched off. The impact is computed with it: any browser of 2023 or later has it.");
    return;
  }
  if (typeof DecompressionStream === "undefined" || typeof Worker === "undefined") {
    trouble("This page needs a browser of 2023 or later.");
    return;
  }
  const data = JSON.parse(await unpackedText("data"));
  const player = new Player(data);
  const computation = new Computation(data, player);
  const sliders = new Sliders(data, () => computation.start(sliders.offer(), sliders.values()));
  computation.start(sliders.offer(), sliders.values());
};

begin().catch((error) => {
  trouble(`The page cannot be shown: ${error.message}`);
  throw error;
});
