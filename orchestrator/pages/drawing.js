"use strict";
// Sand with its force chains, and curves over time: the look of the pictures of rockshed.

const CHAINS = [
  [232, 201, 143],
  [224, 138, 46],
  [194, 59, 34],
  [90, 15, 60],
];

const chainColour = (share) => {
  const at = Math.min(Math.max(share, 0), 1) * (CHAINS.length - 1);
  const low = Math.min(Math.floor(at), CHAINS.length - 2);
  const mixed = CHAINS[low].map((from, i) => Math.round(from + (at - low) * (CHAINS[low + 1][i] - from)));
  return `rgb(${mixed.join()})`;
};

// Makes a canvas as wide as its place and so high; returns a pen that draws in CSS pixels.
const penOf = (canvas, wide, high) => {
  const ratio = window.devicePixelRatio || 1;
  canvas.style.height = `${high}px`;
  canvas.width = Math.round(wide * ratio);
  canvas.height = Math.round(high * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, wide, high);
  return pen;
};

class SandPicture {
  constructor(canvas, colours) {
    this.canvas = canvas;
    this.colours = colours;
  }

  // Chooses what is seen from the first frame: box, rock and the discs of the beam.
  frameOf(first, body) {
    const { left, right } = body;
    const margin = 0.06 * (right - left);
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < first.body.length; i += 4) {
      const [x, y, radius] = first.body.subarray(i, i + 3);
      if (x < left - margin || x > right + margin) continue;
      low = Math.min(low, y - radius);
      high = Math.max(high, y + radius);
    }
    this.window = [left - margin, right + margin, low - margin, high + margin];
    this.box = body;
  }

  draw(frame, discs, largest) {
    const [left, right, bottom, top] = this.window;
    const wide = this.canvas.parentElement.clientWidth;
    const scale = Math.min(wide / (right - left), 560 / (top - bottom));
    const high = Math.round(scale * (top - bottom));
    const pen = penOf(this.canvas, wide, high);
    const offset = 0.5 * (wide - scale * (right - left));
    this.scale = scale;
    this.x = (x) => offset + scale * (x - left);
    this.y = (y) => scale * (top - y);
    pen.beginPath();
    pen.rect(offset, 0, scale * (right - left), high);
    pen.clip();
    for (let i = 0; i < discs; i += 1) this.disc(pen, frame.body, i, "#f4ecdc", "#d9c9a8");
    this.chains(pen, frame.contacts, largest);
    for (let i = discs + 1; 4 * i < frame.body.length; i += 1) this.disc(pen, frame.body, i, "#dfe6df", "#3d7d3f");
    this.walls(pen, frame, discs);
    this.rock(pen, frame.body, discs);
    this.lengthBar(pen, offset + scale * (right - left), right - left);
  }

  disc(pen, body, number, face, edge) {
    const [x, y, radius] = body.subarray(4 * number, 4 * number + 3);
    pen.beginPath();
    pen.arc(this.x(x), this.y(y), Math.max(this.scale * radius, 0.3), 0, 2 * Math.PI);
    pen.fillStyle = face;
    pen.fill();
    pen.strokeStyle = edge;
    pen.lineWidth = 0.6;
    pen.stroke();
  }

  chains(pen, contacts, largest) {
    pen.lineCap = "round";
    for (let i = 0; i < contacts.length; i += 5) {
      const share = contacts[i + 4] / largest;
      if (share < 0.01) continue;
      pen.beginPath();
      pen.moveTo(this.x(contacts[i]), this.y(contacts[i + 1]));
      pen.lineTo(this.x(contacts[i + 2]), this.y(contacts[i + 3]));
      pen.strokeStyle = chainColour(share);
      pen.lineWidth = 0.6 + 6 * share;
      pen.stroke();
    }
  }

  // The side walls, from the lowest disc of the sand upwards.
  walls(pen, frame, discs) {
    let base = Infinity;
    for (let i = 0; i < discs; i += 1) base = Math.min(base, frame.body[4 * i + 1] - frame.body[4 * i + 2]);
    pen.strokeStyle = this.colours.grey;
    pen.lineWidth = 1;
    pen.beginPath();
    for (const face of [this.box.left, this.box.right]) {
      pen.moveTo(this.x(face), this.y(base));
      pen.lineTo(this.x(face), 0);
    }
    if (!this.box.beam) {
      pen.moveTo(this.x(this.box.left), this.y(base));
      pen.lineTo(this.x(this.box.right), this.y(base));
    }
    pen.stroke();
  }

  rock(pen, body, number) {
    this.disc(pen, body, number, "#6b6b6b", this.colours.ink);
    const [x, y, radius, angle] = body.subarray(4 * number, 4 * number + 4);
    pen.beginPath();
    pen.moveTo(this.x(x), this.y(y));
    pen.lineTo(this.x(x + radius * Math.sin(angle)), this.y(y - radius * Math.cos(angle)));
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 1;
    pen.stroke();
  }

  lengthBar(pen, edge, width) {
    const length = [10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].find((l) => l <= 0.25 * width) || 0.25 * width;
    const [end, start] = [edge - 12, edge - 12 - this.scale * length];
    pen.strokeStyle = this.colours.ink;
    pen.lineWidth = 1;
    pen.beginPath();
    for (const x of [start, end]) {
      pen.moveTo(x, 10);
      pen.lineTo(x, 18);
    }
    pen.moveTo(start, 14);
    pen.lineTo(end, 14);
    pen.stroke();
    pen.fillStyle = this.colours.ink;
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "top";
    pen.fillText(length < 1 ? `${Math.round(100 * length)} cm` : `${length} m`, 0.5 * (start + end), 20);
  }
}

// The largest of 1, 2, 5 times a power of ten that divides a length into about so many parts.
const stepOf = (length, parts) => {
  const power = 10 ** Math.floor(Math.log10(length / parts));
  return [1, 2, 5, 10].map((n) => n * power).find((step) => length / step <= parts) || 10 * power;
};

class CurvePicture {
  // curves: title, colour, place of the number in a row, factor to the unit of the axis
  constructor(canvas, colours, label, curves) {
    Object.assign(this, { canvas, colours, label, curves });
  }

  draw(rows, shown, end) {
    const wide = this.canvas.parentElement.clientWidth;
    const high = wide < 500 ? 200 : 230;
    const pen = penOf(this.canvas, wide, high);
    const value = (row, curve) => row[curve.place] * curve.factor;
    const all = rows.flatMap((row) => this.curves.map((curve) => value(row, curve)));
    const highest = Math.max(...all, 0) || 1;
    const lowest = Math.min(...all, 0) < -0.02 * highest ? Math.min(...all, 0) : 0;
    const edges = { left: 58, right: wide - 14, top: 14, bottom: high - 42 };
    const x = (time) => edges.left + ((edges.right - edges.left) * time) / end;
    const y = (number) => edges.bottom - ((edges.bottom - edges.top) * (number - lowest)) / (1.05 * (highest - lowest));
    this.axes(pen, edges, { x, y, end: 1e3 * end, lowest, highest });
    for (const curve of this.curves) {
      pen.beginPath();
      for (const row of rows.slice(0, shown)) pen.lineTo(x(row[0]), y(value(row, curve)));
      pen.strokeStyle = curve.colour;
      pen.lineWidth = 1.8;
      pen.stroke();
    }
    const now = rows[Math.max(shown - 1, 0)];
    if (now) this.instant(pen, x(now[0]), edges);
  }

  instant(pen, at, edges) {
    pen.setLineDash([1, 2]);
    pen.strokeStyle = this.colours.ink;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(at, edges.top);
    pen.lineTo(at, edges.bottom);
    pen.stroke();
    pen.setLineDash([]);
  }

  axes(pen, edges, { x, y, end, lowest, highest }) {
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = this.colours.ink;
    pen.lineWidth = 0.5;
    pen.strokeStyle = this.colours.faint;
    const line = (...ends) => {
      pen.beginPath();
      pen.moveTo(ends[0], ends[1]);
      pen.lineTo(ends[2], ends[3]);
      pen.stroke();
    };
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const across = stepOf(end, edges.right - edges.left < 450 ? 4 : 8);
    for (let time = 0; time <= end * 1.0001; time += across) {
      line(x(time / 1e3), edges.top, x(time / 1e3), edges.bottom);
      pen.fillText(String(Number(time.toPrecision(6))), x(time / 1e3), edges.bottom + 5);
    }
    pen.fillText("time (ms)", 0.5 * (edges.left + edges.right), edges.bottom + 22);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const up = stepOf(highest - lowest, 5);
    for (let n = Math.ceil(lowest / up); n * up <= highest * 1.0001; n += 1) {
      line(edges.left, y(n * up), edges.right, y(n * up));
      pen.fillText(String(Number((n * up).toPrecision(6))), edges.left - 6, y(n * up));
    }
    pen.save();
    pen.translate(14, 0.5 * (edges.top + edges.bottom));
    pen.rotate(-0.5 * Math.PI);
    pen.textAlign = "center";
    pen.fillText(this.label, 0, 0);
    pen.restore();
    pen.strokeStyle = this.colours.grey;
    pen.lineWidth = 0.7;
    line(edges.left, edges.top, edges.left, edges.bottom);
    line(edges.left, edges.bottom, edges.right, edges.bottom);
  }
}
