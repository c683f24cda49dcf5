// Components in WebAssembly, and the exchanges between them: the order and the arithmetic of the
// orchestrator, so that the results have the bits of its runs with native FMUs.

const LINE = 64; // bytes of a cache line, on which buffers begin
const ROUNDS = 20; // most rounds in which outputs are passed on at the start

class Component {
  // start: buffers before the initialisation; limits: what it refuses, in words
  constructor(name, module, start, limits) {
    this.name = name;
    this.limits = limits;
    this.code = new WebAssembly.Instance(module, {}).exports;
    this.end = this.code.__heap_base.value;
    this.lengths = [start.w.length, start.x, start.k];
    this.places = this.lengths.map((length) => this.room(8 * length));
    this.look();
    this.w.set(start.w);
    start.table.forEach((number, place) => {
      this.k[place] = BigInt(number);
    });
  }

  room(bytes) {
    const begin = Math.ceil(this.end / LINE) * LINE;
    this.end = begin + bytes;
    const lacking = this.end - this.code.memory.buffer.byteLength;
    if (lacking > 0) this.code.memory.grow(Math.ceil(lacking / 65536));
    return begin;
  }

  // Views of the buffers; a memory that has grown needs new ones.
  look() {
    const { buffer } = this.code.memory;
    this.w = new Float64Array(buffer, this.places[0], this.lengths[0]);
    this.x = new Float64Array(buffer, this.places[1], this.lengths[1]);
    this.k = new BigInt64Array(buffer, this.places[2], this.lengths[2]);
  }

  initialise() {
    this.check(this.code.initialise(...this.places, ...this.lengths));
  }

  evaluate() {
    this.check(this.code.evaluate(...this.places, ...this.lengths));
  }

  step(time, length) {
    const [w, x, k] = this.places;
    const [nw, nx, nk] = this.lengths;
    const status = this.code.step(time, length, w, x, k, nw, nx, nk);
    if (status !== 0) this.check(status, `at ${(1e3 * time).toPrecision(4)} ms `);
  }

  check(status, when = "") {
    if (status === 0) return;
    const fault = this.limits.faults[status];
    const shown = (_, name) => Number(this.w[fault.places[name]].toPrecision(6));
    const words = fault ? fault.text.replace(/\{([^}]+)\}/g, shown) : `stopped with the status ${status}`;
    throw new Error(`${this.name}: ${when}${words}`);
  }

  checkStep() {
    const [used, stable] = this.limits.steps.map((place) => this.w[place]);
    if (used > stable)
      throw new Error(`${this.name}: a step of ${used.toPrecision(3)} s is unstable here; at most ${stable.toPrecision(3)} s is stable`);
  }
}

class Cosimulation {
  // plan: what all offers share; offer: start values; modules: by kind; values: of sliders
  constructor(plan, offer, modules, values) {
    this.plan = plan;
    this.offer = offer;
    this.components = {};
    for (const [name, start] of Object.entries(offer.components))
      this.components[name] = new Component(name, modules[plan.kinds[name]], start, plan.limits[name]);
    for (const [title, value] of Object.entries(values))
      for (const [name, place] of offer.moved[title].places) this.components[name].w[place] = value;
    this.exchange = 0;
    this.initialise();
  }

  // Sets the inputs of a component to the newest outputs that are there; tells whether any changed.
  give(name, there) {
    const { w } = this.components[name];
    let changed = false;
    for (const [place, source, from] of this.plan.links[name]) {
      if (there && !there.has(source)) continue;
      const value = this.components[source].w[from];
      if (w[place] !== value) changed = true;
      w[place] = value;
    }
    return changed;
  }

  initialise() {
    const there = new Set();
    for (let round = 0; round < ROUNDS; round += 1) {
      let changed = false;
      for (const name of this.plan.turns) {
        const component = this.components[name];
        const moved = this.give(name, there);
        if (!there.has(name)) component.initialise();
        if (moved || !there.has(name)) component.evaluate();
        changed = changed || moved || !there.has(name);
        there.add(name);
      }
      if (!changed) break;
    }
    for (const component of Object.values(this.components)) component.checkStep();
  }

  // Carries out one exchange.
  advance() {
    const { plan } = this;
    const number = this.exchange % plan.operations.length;
    const origin = plan.start + (this.exchange - number) * plan.exchange;
    for (const [action, name, begin, length] of plan.operations[number]) {
      if (action === "SET") this.give(name);
      else if (action === "STEP") this.components[name].step((origin + begin) / plan.rate, length / plan.rate);
    }
    this.exchange += 1;
  }

  time() {
    return (this.plan.start + this.exchange * this.plan.exchange) / this.plan.rate;
  }

  value(title) {
    const [name, place] = this.plan.read[title];
    return this.components[name].w[place];
  }

  // Returns discs, rock, beam and the forces in the contacts as they are now.
  frame() {
    const { entry, row, sand, beam } = this.plan.body;
    const component = this.components[sand];
    const begin = Number(component.k[entry]);
    const bodies = this.offer.discs + 1 + beam;
    const body = new Float32Array(4 * bodies);
    for (let i = 0; i < bodies; i += 1) {
      const at = begin + row * i;
      const angle = i < this.offer.discs ? 0 : component.x[at + 6];
      body.set([component.x[at], component.x[at + 1], component.x[at + 5], angle], 4 * i);
    }
    return { time: this.time(), body, contacts: this.contacts(component) };
  }

  // Returns ends (m) and normal force (N) of each contact, the strongest last.
  contacts(component) {
    const rows = 8 * this.offer.discs + 1000;
    if (this.table === undefined) {
      this.table = component.room(9 * 8 * rows);
      component.look();
    }
    const lengths = [...component.lengths, rows].map(BigInt);
    const count = Number(component.code.contacts(...component.places, this.table, ...lengths));
    const numbers = new Float64Array(component.code.memory.buffer, this.table, 9 * count);
    const found = [];
    for (let i = 0; i < count; i += 1) found.push([...numbers.subarray(9 * i + 2, 9 * i + 6), numbers[9 * i + 7]]);
    found.sort((one, other) => one[4] - other[4]);
    return Float32Array.from(found.flat());
  }
}
