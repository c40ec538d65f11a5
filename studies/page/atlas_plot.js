// The curves of the atlas: sizes of errors against N, both logarithmic, as an SVG of the width at hand.
const atlasPlot = (() => {
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"];
  const { node, superscript } = pageNumbers;

  // Errors of one mode as points [N, e]; a gap where the chain has no such mode.
  const points = (errors, mode) =>
    errors.map((row, i) => [i + 1, row[mode - 1]]).filter(([, e]) => e !== null && e !== 0);

  const label = (power) => (power >= -4 ? `${+(10 ** (power + 2)).toPrecision(1)} %` : `10${superscript(power + 2)} %`);

  function draw(place, view) {
    const width = Math.min(900, Math.max(300, place.clientWidth || 720));
    const height = Math.round(Math.min(440, Math.max(300, 0.6 * width)));
    const box = { left: 58, right: width - 66, top: 12, bottom: height - 42 };
    const lines = view.lines.map((line) => ({ ...line, points: points(line.errors, line.mode) }));
    const sizes = lines.flatMap((line) => line.points.map(([, e]) => Math.abs(e)));
    const high = Math.max(0, Math.ceil(Math.log10(Math.max(view.tolerance, ...sizes, 1e-9))));
    const low = Math.max(-11, Math.floor(Math.log10(Math.min(view.tolerance, ...sizes, 1))));
    const x = (n) => box.left + ((box.right - box.left) * Math.log(n)) / Math.log(view.last);
    const y = (size) =>
      box.top + ((box.bottom - box.top) * (high - Math.log10(size))) / Math.max(1, high - low);

    place.replaceChildren();
    const svg = node(place, "svg", {
      viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": view.description,
      "font-family": "DejaVu Sans, Verdana, sans-serif", "font-size": 12,
    });
    for (let power = low; power <= high; power += Math.ceil((high - low) / 8)) {
      node(svg, "line", { x1: box.left, x2: box.right, y1: y(10 ** power), y2: y(10 ** power), stroke: "#dddddd" });
      node(svg, "text", { x: box.left - 7, y: y(10 ** power) + 4, "text-anchor": "end", fill: "#1a1a1a" }, label(power));
    }
    for (const n of [1, 2, 5, 10, 20, 50]) {
      node(svg, "line", { x1: x(n), x2: x(n), y1: box.top, y2: box.bottom, stroke: "#dddddd" });
      node(svg, "text", { x: x(n), y: box.bottom + 17, "text-anchor": "middle", fill: "#1a1a1a" }, n);
    }
    const middle = (box.left + box.right) / 2;
    node(svg, "text", { x: middle, y: height - 6, "text-anchor": "middle", fill: "#1a1a1a" }, "number of segments N");
    node(svg, "line", {
      x1: box.left, x2: box.right, y1: y(view.tolerance), y2: y(view.tolerance), stroke: "#555555", "stroke-dasharray": "4 3",
    });
    node(svg, "line", {
      x1: x(view.segments), x2: x(view.segments), y1: box.top, y2: box.bottom, stroke: "#0072b2", "stroke-opacity": 0.35, "stroke-width": 5,
    });
    const clip = `atlas-clip-${width}`;
    node(node(node(svg, "defs", {}), "clipPath", { id: clip }), "rect", {
      x: box.left - 5, y: box.top - 5, width: box.right - box.left + 10, height: box.bottom - box.top + 10,
    });
    const area = node(svg, "g", { "clip-path": `url(#${clip})` });
    for (const line of lines) curve(area, line, x, y);
    names(svg, lines.filter((line) => !line.dashed && line.points.length), box, y);
  }

  function curve(svg, line, x, y) {
    const colour = colours[line.mode - 1];
    const path = line.points.map(([n, e]) => `${x(n).toFixed(1)},${y(Math.abs(e)).toFixed(1)}`).join(" ");
    node(svg, "polyline", {
      points: path, fill: "none", stroke: colour, "stroke-width": line.dashed ? 1.2 : 1.8,
      ...(line.dashed ? { "stroke-dasharray": "5 4" } : {}),
    });
    if (line.dashed) return;
    for (const [n, e] of line.points) {
      node(svg, "circle", {
        cx: x(n).toFixed(1), cy: y(Math.abs(e)).toFixed(1), r: 2.6, stroke: colour, fill: e < 0 ? colour : "#ffffff",
      });
    }
  }

  // Names stand at the right ends of their lines, one line of text apart at least.
  function names(svg, lines, box, y) {
    const places = lines
      .map((line) => ({ line, at: y(Math.abs(line.points.at(-1)[1])) }))
      .sort((a, b) => a.at - b.at);
    places.forEach((place, i) => {
      if (i > 0) place.at = Math.max(place.at, places[i - 1].at + 14);
    });
    const beyond = places.length ? Math.max(0, places.at(-1).at - box.bottom) : 0;
    for (const { line, at } of places) {
      node(svg, "text", { x: box.right + 8, y: at - beyond + 4, fill: colours[line.mode - 1] }, `mode ${line.mode}`);
    }
  }

  return { draw };
})();
