// The atlas: what is chosen, answered in words, tables and curves, in SI units where the beam's numbers are given.
(() => {
  const data = JSON.parse(document.getElementById("atlas-data").textContent);
  const chains = atlasChains(data);
  const show = (id, text) => { document.getElementById(id).textContent = text; };
  const units = {
    bending: { spring: "EI/ℓ", step: "h = C L² √(ρA/EI)", omega: "√(EI/ρAL⁴)", mass: "ρAL", inertia: "ρAL³" },
    twist: { spring: "GJ/ℓ", step: "h = C L √(ρIₚ/GJ)", omega: "√(GJ/ρIₚL²)", inertia: "ρIₚL" },
  };
  const { number, percent, superscript } = pageNumbers;
  const tolerance = (value) => `${+(100 * value).toPrecision(3)} %`;

  const found = (state, rule) => chains.record(state, rule);

  function springs(record, segments, scale) {
    const text = record.springs(segments);
    if (!text) return "none: no hinge has a spring";
    if (!scale || text.startsWith("none")) return text;
    const size = (part) => number(chains.values(part)[0] * scale.spring * segments, 6);
    return text.split(", ").map((part) => (part.includes("×") ? `${part.split("×")[0]}×\u00a0${size(part)}` : size(part))).join(", ");
  }

  function named(state) {
    const carried = chains.bodies(state);
    const scale = chains.scales(state);
    const unit = scale ? { mass: "kg", inertia: "kg m²" } : units[state.motion];
    const body = (sizes, end) => {
      const parts = ["mass", "inertia"].filter((kind) => sizes[kind])
        .map((kind) => `${number(sizes[kind] * (scale ? scale[kind] : 1), 3)} ${unit[kind]}`);
      return parts.length ? `, at the ${end} end ${parts.join(" and ")}` : "";
    };
    const pair = `${state.left}-${state.right}${state.motion === "bending" ? "" : ` in ${state.motion}`}`;
    return `${pair}${body(carried.left, "left")}${body(carried.right, "right")}`;
  }

  function render(state) {
    const record = found(state, state.rule);
    const segments = Number(state.segments);
    const modes = Number(state.modes);
    const omega = record.omega[segments - 1];
    const wanted = chains.needed(record, state);
    const scale = chains.scales(state);
    const first = modes === 1 ? "first frequency" : `first ${modes} frequencies`;
    const title = `${named(state)}, rule ${state.rule}, N = ${segments}`;
    const unit = units[state.motion];
    show("atlas-state", title);
    show("atlas-springs-label", `Springs, in ${scale ? "N m/rad" : unit.spring}, from the left`);
    show("atlas-step-label", scale
      ? "Longest stable step of Runge-Kutta, 2√2/ω of the highest mode, in s"
      : `Longest stable step of Runge-Kutta, C = 2√2/ω of the highest mode in ${unit.step}`);
    show("atlas-springs", springs(record, segments, scale));
    const none = chains.hasChain(record, segments) ? "any: the chain has no elastic mode" : "no chain has this N";
    const highest = scale && omega ? `${number(omega / (2 * Math.PI * scale.time))} Hz` : omega && `ω = ${number(omega)} ${unit.omega}`;
    show("atlas-step", omega
      ? `${number((data.limit / omega) * (scale ? scale.time : 1))}${scale ? " s" : ""}   (highest ${highest})` : none);
    show("atlas-needed-label", `Segments needed for ${tolerance(Number(state.tolerance))} in the ${first}`);
    show("atlas-wanted", wanted.count ? String(wanted.count) : `more than ${wanted.most}`);
    const { summary, usedBy } = data.rules[chains.rules.indexOf(state.rule)];
    const order = record.order ? ` Order ${record.order} between these ends.` : "";
    show("atlas-rule", `${state.motion === "bending" ? "" : "In bending: "}${summary} Used by: ${usedBy}.${order}`);
    show("atlas-where", chains.isComputed(state)
      ? `Computed in this browser, for N up to ${data.segments}: the chain's frequencies from its mass matrix and springs, the beam's from its determinant. A body with rotary inertia stands behind a hinge of its own.`
      : "Looked up: errors, springs, steps and N were computed by the library; the beam's frequencies are computed in this browser.");
    errors(record, state, scale);
    everyRule(state, first, scale);
    const lines = [];
    for (const [rule, dashed] of [[state.beside, true], [state.rule, false]]) {
      if (!rule || (dashed && rule === state.rule)) continue;
      for (let mode = 1; mode <= modes; mode += 1) lines.push({ errors: found(state, rule).error, mode, dashed });
    }
    atlasPlot.draw(document.getElementById("atlas-plot"), {
      lines, segments, last: data.segments, tolerance: Number(state.tolerance),
      description: `Errors of the ${first} against N from 1 to ${data.segments}: ${title}. The table below has those at N.`,
    });
  }

  function row(cells, current) {
    const made = document.createElement("tr");
    if (current) made.setAttribute("aria-current", "true");
    cells.forEach((text, i) => {
      const cell = document.createElement(i ? "td" : "th");
      if (!i) cell.scope = "row";
      cell.textContent = text;
      made.appendChild(cell);
    });
    return made;
  }

  // No more digits than rounding leaves.
  function sized(error, rounding) {
    if (!rounding) return percent(error);
    const digits = Math.floor(Math.log10(Math.abs(error) / rounding));
    return digits < 1 ? `within 10${superscript(Math.ceil(Math.log10(rounding)) + 3)}` : percent(error, Math.min(4, digits));
  }

  function errors(record, state, scale) {
    const [segments, modes] = [Number(state.segments), Number(state.modes)];
    const unit = scale ? "Hz" : "ω";
    show("atlas-omega", scale ? "" : `; ω in ${units[state.motion].omega}`);
    const size = (omega) => number(scale ? omega / (2 * Math.PI * scale.time) : omega, 6);
    const exact = chains.exact(state);
    const rows = [];
    for (let mode = 1; mode <= modes; mode += 1) {
      const error = record.error[segments - 1][mode - 1];
      const missing = chains.hasChain(record, segments) ? "no such mode" : "no such chain";
      rows.push(row(error === null
        ? [String(mode), missing, "–", size(exact[mode - 1]), "–"]
        : [String(mode), sized(error, record.rounding && record.rounding[segments - 1][mode - 1]), law(record, segments, mode),
          size(exact[mode - 1]), size(exact[mode - 1] * (1 + error))]));
    }
    document.querySelector("#atlas-errors tbody").replaceChildren(...rows);
    show("atlas-beam-head", `beam, ${unit}`);
    show("atlas-chain-head", `chain, ${unit}`);
  }

  // No law before it tells the error: a rule of order 4 may have the other sign there. None is known here with bodies.
  function law(record, segments, mode) {
    if (!record.law) return "–";
    const coefficient = record.law[mode - 1];
    const from = record.lawFrom[mode - 1];
    if (coefficient === null || from === null) return "–";
    if (segments < from) return `from N = ${from}`;
    return percent(coefficient / segments ** record.lawOrder[mode - 1]);
  }

  // What has to be computed comes a rule at a time, so that the page stays at hand.
  let waiting = 0;
  function everyRule(state, first, scale) {
    const fill = (rule) => {
      const record = found(state, rule);
      const { count, most } = chains.needed(record, state);
      const text = count && count <= data.segments ? springs(record, count, scale) : `not kept over N = ${data.segments}`;
      return listed([rule, count ? String(count) : `over ${most}`, text], rule === state.rule);
    };
    const listed = (cells, current) => {
      const made = row(cells, current);
      made.children[0].className = made.children[2].className = "word";
      return made;
    };
    const later = chains.isComputed(state);
    const rows = chains.rules.map((rule) => (later ? listed([rule, "…", "…"], rule === state.rule) : fill(rule)));
    document.querySelector("#atlas-rules tbody").replaceChildren(...rows);
    show("atlas-rules-springs", `springs at that N, ${scale ? "N m/rad" : units[state.motion].spring}, from the left`);
    const caption = `All rules, ${named(state)}${state.motion === "bending" ? " in bending" : ""}: N for ${tolerance(Number(state.tolerance))} in the ${first}`;
    document.querySelector("#atlas-rules caption").textContent = caption;
    clearTimeout(waiting);
    const next = (i) => {
      rows[i].replaceWith(fill(chains.rules[i]));
      if (i + 1 < rows.length) waiting = setTimeout(next, 0, i + 1);
    };
    if (later) waiting = setTimeout(next, 0, 0);
  }

  atlasForm(data, chains, render);
})();
