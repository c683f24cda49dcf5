"use strict";
(() => {
  const trouble = (text) => {
    const place = document.getElementById("trouble");
    place.textContent = text;
    place.hidden = false;
  };

  const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

  const unpacked = async (name) => {
    const stream = new Blob([bytesOf(document.getElementById(name).textContent)]).stream();
    return new Response(stream.pipeThrough(new DecompressionStream("gzip"))).text();
  };

  const KINDS = { f4: Float32Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };

  const arraysOf = (film) => {
    const arrays = {};
    for (const [name, told] of Object.entries(film.arrays)) {
      arrays[name] = new KINDS[told.kind](bytesOf(told.data).buffer);
    }
    return arrays;
  };

  // ------------------------------------------------------------------ sand, frame by frame

  const CHAINS = [[232, 201, 143], [224, 138, 46], [194, 59, 34], [90, 15, 60]];

  const chainColour = (share) => {
    const place = Math.min(share, 1) * (CHAINS.length - 1);
    const first = Math.min(Math.floor(place), CHAINS.length - 2);
    const rest = place - first;
    const mixed = CHAINS[first].map((part, i) => Math.round(part + rest * (CHAINS[first + 1][i] - part)));
    return `rgb(${mixed.join(",")})`;
  };

  class Film {
    constructor(place, told) {
      this.told = told;
      this.arrays = arraysOf(told);
      this.canvas = place.querySelector("canvas");
      this.slider = place.querySelector("input");
      this.output = place.querySelector("output");
      this.button = place.querySelector("button");
      this.timer = 0;
      this.moved = () => {};
      const force = (told.largest_force / 1000).toPrecision(3);
      const scale = told.deflection_scale > 1 ? `, deflections of the beam's axis × ${told.deflection_scale}` : "";
      place.querySelector(".scale").textContent =
        `Lines are forces in the contacts, by width and colour; the strongest one has ${force} kN. To scale${scale}.`;
      this.slider.addEventListener("input", () => this.draw());
      this.button.addEventListener("click", () => (this.timer ? this.stop() : this.play()));
      new ResizeObserver(() => this.draw()).observe(this.canvas.parentElement);
    }

    play() {
      const slider = this.slider;
      if (Number(slider.value) >= Number(slider.max)) slider.value = 0;
      this.button.textContent = "stop";
      this.timer = setInterval(() => {
        if (Number(slider.value) >= Number(slider.max)) return this.stop();
        slider.value = Number(slider.value) + 1;
        return this.draw();
      }, 120);
      this.draw();
    }

    stop() {
      clearInterval(this.timer);
      this.timer = 0;
      this.button.textContent = "play";
    }

    prepare() {
      const [left, right, bottom, top] = this.told.window;
      const wide = this.canvas.parentElement.clientWidth;
      const scale = Math.min(wide / (right - left), 620 / (top - bottom));
      const ratio = window.devicePixelRatio || 1;
      const high = Math.round(scale * (top - bottom));
      this.canvas.style.height = `${high}px`;
      this.canvas.width = Math.round(wide * ratio);
      this.canvas.height = Math.round(high * ratio);
      const pen = this.canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.fillStyle = "#ffffff";
      pen.fillRect(0, 0, wide, high);
      const offset = 0.5 * (wide - scale * (right - left));
      this.scale = scale;
      this.x = (x) => offset + scale * (x - left);
      this.y = (y) => scale * (top - y);
      return pen;
    }

    disc(pen, x, y, radius, face, edge) {
      pen.beginPath();
      pen.arc(this.x(x), this.y(y), Math.max(this.scale * radius, 0.3), 0, 2 * Math.PI);
      pen.fillStyle = face;
      pen.fill();
      pen.strokeStyle = edge;
      pen.lineWidth = 0.6;
      pen.stroke();
    }

    draw() {
      const { told, arrays } = this;
      const frame = Number(this.slider.value);
      const pen = this.prepare();
      const along = (key, whole) => told[key][0] + ((told[key][1] - told[key][0]) * whole) / 65535;
      for (let i = 0; i < told.discs; i += 1) {
        const at = frame * told.discs + i;
        this.disc(pen, along("x", arrays.disc_x[at]), along("y", arrays.disc_y[at]), arrays.disc_radius[i], "#f4ecdc", "#d9c9a8");
      }
      this.chains(pen, frame, along);
      this.box(pen);
      for (let i = 0; i < told.beam; i += 1) {
        const at = frame * told.beam + i;
        this.disc(pen, arrays.beam_x[at], arrays.beam_y[at], arrays.beam_radius[i], "#dfe6df", "#3d7d3f");
      }
      this.axis(pen, frame);
      this.rock(pen, frame);
      this.lengthBar(pen);
      const time = Number(told.times[frame].toPrecision(6));
      this.output.textContent = `${time} ms: ${told.words[frame]} (${frame + 1} of ${told.frames})`;
      this.moved(told.times[frame]);
    }

    chains(pen, frame, along) {
      const { arrays } = this;
      pen.lineCap = "round";
      for (let i = arrays.contact_begins[frame]; i < arrays.contact_begins[frame + 1]; i += 1) {
        const share = arrays.contact_force[i] / 255;
        pen.beginPath();
        pen.moveTo(this.x(along("x", arrays.contact_x1[i])), this.y(along("y", arrays.contact_y1[i])));
        pen.lineTo(this.x(along("x", arrays.contact_x2[i])), this.y(along("y", arrays.contact_y2[i])));
        pen.strokeStyle = chainColour(share);
        pen.lineWidth = 0.6 + 6 * share;
        pen.stroke();
      }
    }

    box(pen) {
      const box = this.told.box;
      const top = box.top === null ? this.told.window[3] : box.top;
      pen.strokeStyle = "#767676";
      pen.lineWidth = 1;
      for (const [face, side] of [[box.left, -1], [box.right, 1]]) {
        if (box.top === null) {
          pen.beginPath();
          pen.moveTo(this.x(face), this.y(box.base));
          pen.lineTo(this.x(face), this.y(top));
          pen.stroke();
        } else {
          const width = this.scale * box.wall;
          pen.fillStyle = "#dfe6df";
          const start = side < 0 ? this.x(face) - width : this.x(face);
          pen.fillRect(start, this.y(top), width, this.scale * (top - box.base));
          pen.strokeRect(start, this.y(top), width, this.scale * (top - box.base));
        }
      }
      pen.beginPath();
      pen.moveTo(this.x(box.left), this.y(box.base));
      pen.lineTo(this.x(box.right), this.y(box.base));
      pen.stroke();
    }

    axis(pen, frame) {
      const { told, arrays } = this;
      if (!arrays.axis.length) return;
      pen.beginPath();
      for (let i = 0; i < told.beam; i += 1) {
        const at = frame * told.beam + i;
        const place = [this.x(arrays.beam_x[at]), this.y(arrays.axis[at])];
        if (i) pen.lineTo(...place);
        else pen.moveTo(...place);
      }
      pen.strokeStyle = "#1d4d1f";
      pen.lineWidth = 2;
      pen.stroke();
    }

    rock(pen, frame) {
      const { arrays } = this;
      const radius = arrays.rock_radius[0];
      const [x, y, angle] = [arrays.rock_x[frame], arrays.rock_y[frame], arrays.rock_angle[frame]];
      this.disc(pen, x, y, radius, "#6b6b6b", "#222222");
      pen.beginPath();
      pen.moveTo(this.x(x), this.y(y));
      pen.lineTo(this.x(x + radius * Math.sin(angle)), this.y(y - radius * Math.cos(angle)));
      pen.strokeStyle = "#ffffff";
      pen.lineWidth = 1;
      pen.stroke();
    }

    lengthBar(pen) {
      const [left, right] = this.told.window;
      const quarter = 0.25 * (right - left);
      const length = [10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].find((l) => l <= quarter) || quarter;
      const text = length < 1 ? `${Math.round(100 * length)} cm` : `${length} m`;
      const end = this.x(right) - 12;
      const start = end - this.scale * length;
      pen.strokeStyle = "#222222";
      pen.lineWidth = 1;
      pen.beginPath();
      for (const x of [start, end]) {
        pen.moveTo(x, 10);
        pen.lineTo(x, 18);
      }
      pen.moveTo(start, 14);
      pen.lineTo(end, 14);
      pen.stroke();
      pen.fillStyle = "#222222";
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "top";
      pen.fillText(text, 0.5 * (start + end), 20);
    }
  }

  // ------------------------------------------------------------------ charts

  const OPTIONS = {
    responsive: true,
    displaylogo: false,
    displayModeBar: true,
    modeBarButtons: [["zoom2d", "pan2d", "resetScale2d", "toImage"]],
  };
  const DASHES = { solid: "", dash: "5 3", dot: "1.5 2.5", dashdot: "6 2 1.5 2" };

  const isOverTime = (chart) => chart.layout.xaxis.title.text === "time (ms)";

  // Names below the chart, however long and many they are; a click hides a curve.
  const nameCurves = (place, chart) => {
    if (chart.data.length < 2) return;
    const legend = document.createElement("div");
    legend.className = "legend";
    chart.data.forEach((curve, number) => {
      const entry = document.createElement("button");
      entry.type = "button";
      entry.setAttribute("aria-pressed", "true");
      entry.append(swatch(curve), document.createTextNode(curve.meta));
      entry.addEventListener("click", () => {
        const shown = entry.getAttribute("aria-pressed") !== "true";
        entry.setAttribute("aria-pressed", String(shown));
        Plotly.restyle(place, { visible: shown }, [number]);
      });
      legend.append(entry);
    });
    place.after(legend);
  };

  const swatch = (curve) => {
    const space = "http://www.w3.org/2000/svg";
    const drawing = document.createElementNS(space, "svg");
    drawing.setAttribute("width", "26");
    drawing.setAttribute("height", "10");
    const line = document.createElementNS(space, "line");
    const width = curve.stackgroup ? "9" : "2";
    const told = { x1: "1", x2: "25", y1: "5", y2: "5", stroke: curve.line.color, "stroke-width": width };
    for (const [name, value] of Object.entries(told)) line.setAttribute(name, value);
    line.setAttribute("stroke-dasharray", DASHES[curve.line.dash] || "");
    drawing.append(line);
    return drawing;
  };

  const drawCharts = async (charts, films) => {
    const places = [...document.querySelectorAll("[data-chart]")];
    for (const place of places) {
      const chart = charts[Number(place.dataset.chart)];
      await Plotly.newPlot(place, chart.data, chart.layout, OPTIONS);
      nameCurves(place, chart);
    }
    const first = places.find((place) => isOverTime(charts[Number(place.dataset.chart)]));
    if (first && films.length) followFilm(first, films[0]);
  };

  // The instant of the film is a line in the first chart over time.
  const followFilm = (place, film) => {
    let waiting = null;
    film.moved = (time) => {
      if (waiting === null) {
        requestAnimationFrame(() => {
          const line = { type: "line", xref: "x", yref: "paper", x0: waiting, x1: waiting, y0: 0, y1: 1 };
          Plotly.relayout(place, { shapes: [{ ...line, line: { color: "#222222", width: 1, dash: "dot" } }] });
          waiting = null;
        });
      }
      waiting = time;
    };
    film.draw();
  };

  const start = async () => {
    if (typeof DecompressionStream === "undefined") {
      trouble("The figures need a browser of 2023 or later.");
      return;
    }
    const data = JSON.parse(await unpacked("data"));
    const films = [...document.querySelectorAll("[data-film]")].map(
      (place) => new Film(place, data.films[Number(place.dataset.film)]),
    );
    films.forEach((film) => film.draw());
    if (data.charts.length) {
      const script = document.createElement("script");
      script.textContent = await unpacked("library");
      document.head.append(script);
      await drawCharts(data.charts, films);
    }
    document.documentElement.dataset.ready = "yes";
  };

  start().catch((error) => {
    trouble(`The figures cannot be drawn: ${error.message}`);
    throw error;
  });
})();
