// Rods in space: what is chosen, in the form and in the address; the chain that the library computed, turned and drawn.
(() => {
  const data = JSON.parse(document.getElementById("rods-data").textContent);
  const form = document.getElementById("rods-form");
  const place = document.getElementById("rods-plot");
  const field = (name) => form.elements.namedItem(name);
  const blue = "#0072b2";
  const modes = data.rods[0].omega.length;
  const amplitude = 0.13;
  const standard = { rod: data.rods.at(-1).name, rule: "gregory", segments: "20", mode: "1", turn: "-58", tilt: "22" };
  const allowed = {
    rod: data.rods.map((rod) => rod.name), rule: data.rules, segments: data.segments.map(String),
    mode: Array.from({ length: modes + 1 }, (_, i) => String(i)),
    turn: Array.from({ length: 361 }, (_, i) => String(i - 180)),
    tilt: Array.from({ length: 181 }, (_, i) => String(i - 90)),
  };
  const { number, percent, node } = pageNumbers;

  const sum = (a, b, factor = 1) => a.map((value, i) => value + factor * b[i]);

  const shown = (chain, shape) => chain.nodes.map((p, i) => sum(p, shape[i], amplitude));

  // A point of space on the picture, to the right and down, seen from aside and above.
  function seen(state) {
    const [round, up] = [state.turn, state.tilt].map((degrees) => (Number(degrees) * Math.PI) / 180);
    const right = [-Math.sin(round), Math.cos(round), 0];
    const above = [-Math.sin(up) * Math.cos(round), -Math.sin(up) * Math.sin(round), Math.cos(up)];
    const along = (p, way) => p.reduce((total, value, i) => total + value * way[i], 0);
    return (p) => [along(p, right), -along(p, above)];
  }

  function draw(state) {
    const rod = data.rods.find(({ name }) => name === state.rod);
    const chain = rod.chains[data.rules.indexOf(state.rule)][data.segments.indexOf(Number(state.segments))];
    const mode = Number(state.mode);
    const exists = mode > 0 && chain.errors[mode - 1] !== null;
    const moved = exists ? shown(chain, chain.shapes[mode - 1]) : chain.nodes;
    // One scale for all modes of a rod, and while it turns: all that may be drawn is seen.
    const spread = rod.chains.flat().flatMap((each) => [each.nodes, ...each.shapes.map((shape) => shown(each, shape))]).flat();
    const bounds = [0, 1, 2].map((k) => [Math.min, Math.max].map((most) => most(...spread.map((p) => p[k]))));
    bounds[2][0] -= 0.05;
    const ground = bounds[2][0];
    const middle = bounds.map(([low, high]) => (low + high) / 2);
    const width = Math.min(760, Math.max(280, place.clientWidth || 640));
    const height = Math.round(Math.min(440, 0.7 * width));
    const tilt = (Number(state.tilt) * Math.PI) / 180;
    const around = spread.flatMap((p) => [p, [p[0], p[1], ground]]).map((p) => sum(p, middle, -1));
    const across = around.map(([x, y]) => Math.hypot(x, y));
    const tall = around.map(([, , z], i) => across[i] * Math.abs(Math.sin(tilt)) + Math.abs(z) * Math.cos(tilt));
    const scale = Math.min(width / (2 * Math.max(...across) + 0.1), height / (2 * Math.max(...tall) + 0.1));
    const turned = seen(state);
    const at = (p) => turned(sum(p, middle, -1)).map((value, i) => value * scale + [width, height][i] / 2);
    const row = (points) => points.map((p) => at(p).map((value) => value.toFixed(1)).join(",")).join(" ");

    place.replaceChildren();
    const svg = node(place, "svg", {
      viewBox: `0 0 ${width} ${height}`, role: "img", "font-family": "DejaVu Sans, Verdana, sans-serif", "font-size": 12,
      "aria-label": document.getElementById("rods-state").textContent,
    });
    const line = (points, attributes) =>
      node(svg, "polyline", { points: row(points), fill: "none", "stroke-linejoin": "round", ...attributes });
    line(moved.map(([x, y]) => [x, y, ground]), { stroke: "#e3e3e3", "stroke-width": 5, "stroke-linecap": "round" });
    const corner = sum(chain.nodes[0], [0, 0, 0]);
    ["x", "y", "z"].forEach((name, k) => {
      const tip = sum(corner, [0, 1, 2].map((i) => (i === k ? 0.17 : 0)));
      const [from, to, beyond] = [corner, tip, sum(tip, sum(tip, corner, -1), 0.25)].map(at);
      node(svg, "line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], stroke: "#888888" });
      node(svg, "text", { x: beyond[0], y: beyond[1] + 4, "text-anchor": "middle", fill: "#5c5c5c" }, name);
    });
    if (exists) line(chain.nodes, { stroke: "#9a9a9a", "stroke-width": 1.2 });
    (chain.wide || []).forEach((way, j) => {
      const whole = exists ? sum(way, chain.turns[mode - 1][j], amplitude) : way;
      const half = whole.map((value) => (0.045 * value) / Math.hypot(...whole));
      const middleOf = moved[chain.hinges[j]];
      line([sum(middleOf, half, -1), sum(middleOf, half)], { stroke: "#9a9a9a", "stroke-width": 1.6 });
    });
    line(moved, { stroke: blue, "stroke-width": 2.6 });
    const [x, y] = at(chain.nodes[0]);
    node(svg, "rect", { x: x - 5, y: y - 5, width: 10, height: 10, fill: "#1a1a1a" });
    for (const j of chain.hinges) {
      const [cx, cy] = at(moved[j]);
      node(svg, "circle", { cx: cx.toFixed(1), cy: cy.toFixed(1), r: 3.2, fill: "#ffffff", stroke: blue, "stroke-width": 1.4 });
    }
  }

  function table(state) {
    const rod = data.rods.find(({ name }) => name === state.rod);
    const place = data.segments.indexOf(Number(state.segments));
    const cell = (tag, text, scope, word) => {
      const made = document.createElement(tag);
      made.textContent = text;
      if (scope) made.scope = scope;
      if (word) made.className = "word";
      return made;
    };
    document.querySelector("#rods-errors caption").textContent =
      `Frequency errors in percent, ${state.rod}, N = ${state.segments}; ω of the exact rod in √(EI/ρAL⁴)`;
    const heads = ["mode", "ω", ...data.rules].map((text) => cell("th", text, "col"));
    document.querySelector("#rods-errors thead tr").replaceChildren(...heads);
    const rows = rod.omega.map((omega, i) => {
      const made = document.createElement("tr");
      if (String(i + 1) === state.mode) made.setAttribute("aria-current", "true");
      const errors = rod.chains.map((chains) => cell("td", percent(chains[place].errors[i])));
      made.append(cell("th", String(i + 1), "row"), cell("td", number(omega, 6)), ...errors);
      return made;
    });
    document.querySelector("#rods-errors tbody").replaceChildren(...rows);
  }

  function render(state) {
    const shape = state.mode === "0" ? "at rest" : `mode ${state.mode}`;
    document.getElementById("rods-state").textContent = `${state.rod}, rule ${state.rule}, N = ${state.segments}, ${shape}`;
    draw(state);
    table(state);
  }

  // In the address: #rods?rod=…&rule=gregory… What is not allowed is left out.
  function fromAddress() {
    const given = new URLSearchParams(location.hash.split("?")[1] || "");
    const kept = Object.keys(standard).filter((key) => allowed[key].includes(given.get(key) ?? " "));
    return { ...standard, ...Object.fromEntries(kept.map((key) => [key, given.get(key)])) };
  }

  let current = standard;

  function intoForm(state) {
    for (const [key, value] of Object.entries(state)) field(key).value = value;
    current = state;
    render(state);
  }

  function fromForm() {
    current = Object.fromEntries(Object.keys(standard).map((key) => [key, field(key).value]));
    history.replaceState(null, "", `#rods?${new URLSearchParams(current)}`);
    render(current);
  }

  for (const name of ["rod", "rule", "segments", "mode"]) {
    const word = (value) => (name === "mode" && value === "0" ? "at rest" : value);
    field(name).replaceChildren(...allowed[name].map((value) => new Option(word(value), value)));
  }
  let held = null;
  const around = (degrees) => ((((Math.round(degrees) + 180) % 360) + 360) % 360) - 180;
  place.addEventListener("pointerdown", (event) => {
    held = { x: event.clientX, y: event.clientY, turn: Number(current.turn), tilt: Number(current.tilt) };
    place.setPointerCapture(event.pointerId);
  });
  place.addEventListener("pointermove", (event) => {
    if (!held) return;
    field("turn").value = around(held.turn - 0.5 * (event.clientX - held.x));
    field("tilt").value = Math.max(-90, Math.min(90, Math.round(held.tilt + 0.5 * (event.clientY - held.y))));
    fromForm();
  });
  for (const end of ["pointerup", "pointercancel"]) place.addEventListener(end, () => { held = null; });
  form.addEventListener("input", fromForm);
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { if (location.hash.startsWith("#rods?")) intoForm(fromAddress()); });
  addEventListener("resize", () => render(current));
  intoForm(location.hash.startsWith("#rods?") ? fromAddress() : standard);
  if (location.hash.startsWith("#rods?")) document.getElementById("rods").scrollIntoView();
})();
