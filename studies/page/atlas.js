// The atlas: what is chosen, in the form and in the address; what the library computed for it, looked up.
(() => {
  const data = JSON.parse(document.getElementById("atlas-data").textContent);
  const form = document.getElementById("atlas-form");
  const field = (name) => form.elements.namedItem(name);
  const show = (id, text) => { document.getElementById(id).textContent = text; };
  const motions = Object.keys(data.motions);
  const endsOf = (motion) => data.motions[motion].ends;
  const units = {
    bending: { spring: "EI/ℓ", step: "h = C L² √(ρA/EI)", omega: "√(EI/ρAL⁴)" },
    twist: { spring: "GJ/ℓ", step: "h = C L √(ρIₚ/GJ)", omega: "√(GJ/ρIₚL²)" },
  };
  const rules = data.rules.map((rule) => rule.name);
  const standard = {
    motion: "bending", left: "clamped", right: "free", rule: "mitiguy", beside: "gregory", segments: "10", modes: "3",
    tolerance: "0.01",
  };
  const allowed = (motion) => ({
    motion: motions, left: endsOf(motion), right: endsOf(motion), rule: rules, beside: ["", ...rules],
    segments: Array.from({ length: data.segments }, (_, i) => String(i + 1)),
    modes: Array.from({ length: data.modes }, (_, i) => String(i + 1)),
    tolerance: data.tolerances.map(String),
  });

  const { number, percent } = pageNumbers;
  const tolerance = (value) => `${+(100 * value).toPrecision(3)} %`;

  function fill(name, values, word = (value) => value) {
    field(name).replaceChildren(...values.map((value) => new Option(word(value), value)));
  }

  // The record of a rule on the chosen ends; whether the library lists the pair the other way round.
  function lookUp(state, rule) {
    const { pairs, chains } = data.motions[state.motion];
    const listed = pairs.indexOf(`${state.left}-${state.right}`);
    const turned = listed < 0;
    const pair = turned ? pairs.indexOf(`${state.right}-${state.left}`) : listed;
    return { record: data.records[chains[pair][rules.indexOf(rule)]], turned };
  }

  function springs({ record, turned }, segments) {
    const text = data.springs[record.springs[segments - 1]];
    if (!text) return "none: no hinge has a spring";
    return turned ? text.split(", ").reverse().join(", ") : text;
  }

  const needed = (record, state) =>
    record.needed[Number(state.modes) - 1][data.tolerances.indexOf(Number(state.tolerance))];

  function render(state) {
    const found = lookUp(state, state.rule);
    const { record } = found;
    const segments = Number(state.segments);
    const modes = Number(state.modes);
    const omega = record.omega[segments - 1];
    const wanted = needed(record, state);
    const first = modes === 1 ? "first frequency" : `first ${modes} frequencies`;
    const pair = `${state.left}-${state.right}${state.motion === "bending" ? "" : ` in ${state.motion}`}`;
    const title = `${pair}, rule ${state.rule}, N = ${segments}`;
    const unit = units[state.motion];
    show("atlas-state", title);
    show("atlas-springs-label", `Springs, in ${unit.spring}, from the left`);
    show("atlas-step-label", `Longest stable step of Runge-Kutta, C = 2√2/ω of the highest mode in ${unit.step}`);
    show("atlas-springs", springs(found, segments));
    show("atlas-step", omega
      ? `${number(data.limit / omega)}   (highest ω = ${number(omega)} ${unit.omega})`
      : "any: the chain has no elastic mode");
    show("atlas-needed-label", `Segments needed for ${tolerance(Number(state.tolerance))} in the ${first}`);
    show("atlas-wanted", wanted ? String(wanted) : `more than ${data.longest}`);
    const { summary, usedBy } = data.rules[rules.indexOf(state.rule)];
    show("atlas-rule", `${state.motion === "bending" ? "" : "In bending: "}${summary} Used by: ${usedBy}. Order ${record.order} between these ends.`);
    errors(record, segments, modes);
    everyRule(state, first);
    const lines = [];
    for (const [rule, dashed] of [[state.beside, true], [state.rule, false]]) {
      if (!rule || (dashed && rule === state.rule)) continue;
      for (let mode = 1; mode <= modes; mode += 1) lines.push({ errors: lookUp(state, rule).record.error, mode, dashed });
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

  function errors(record, segments, modes) {
    const rows = [];
    for (let mode = 1; mode <= modes; mode += 1) {
      const error = record.error[segments - 1][mode - 1];
      rows.push(row([String(mode), percent(error), error === null ? "–" : law(record, segments, mode)]));
    }
    document.querySelector("#atlas-errors tbody").replaceChildren(...rows);
  }

  // No law before it tells the error: a rule of order 4 may have the other sign there.
  function law(record, segments, mode) {
    const coefficient = record.law[mode - 1];
    const from = record.lawFrom[mode - 1];
    if (coefficient === null || from === null) return "–";
    if (segments < from) return `from N = ${from}`;
    return percent(coefficient / segments ** record.lawOrder[mode - 1]);
  }

  function everyRule(state, first) {
    const rows = rules.map((rule) => {
      const found = lookUp(state, rule);
      const count = needed(found.record, state);
      const text = count && count <= data.segments ? springs(found, count) : `not kept over N = ${data.segments}`;
      const made = row([rule, count ? String(count) : `over ${data.longest}`, text], rule === state.rule);
      made.children[0].className = made.children[2].className = "word";
      return made;
    });
    document.querySelector("#atlas-rules tbody").replaceChildren(...rows);
    const caption = `All rules, ${state.left}-${state.right} in ${state.motion}: N for ${tolerance(Number(state.tolerance))} in the ${first}`;
    document.querySelector("#atlas-rules caption").textContent = caption;
  }

  // In the address: #atlas?left=clamped&right=free… What is not allowed is left out.
  function fromAddress() {
    const given = new URLSearchParams(location.hash.split("?")[1] || "");
    const motion = motions.includes(given.get("motion")) ? given.get("motion") : standard.motion;
    const able = allowed(motion);
    const kept = Object.keys(standard).filter((key) => able[key].includes(given.get(key) ?? " "));
    return { ...inMotion(standard, motion), ...Object.fromEntries(kept.map((key) => [key, given.get(key)])) };
  }

  // The ends as another motion has them: a clamp is a fixed end, and what twist does not know is free.
  function inMotion(state, motion) {
    const other = (word) => (endsOf(motion).includes(word) ? word : endsOf(motion).at(["clamped", "fixed"].includes(word) ? 0 : -1));
    return { ...state, motion, left: other(state.left), right: other(state.right) };
  }

  let current = standard;

  function intoForm(state) {
    fill("left", endsOf(state.motion));
    fill("right", endsOf(state.motion));
    for (const [key, value] of Object.entries(state)) field(key).value = value;
    current = state;
    render(state);
  }

  function fromForm() {
    let state = Object.fromEntries(Object.keys(standard).map((key) => [key, field(key).value]));
    if (state.motion !== current.motion) state = inMotion(state, state.motion);
    const able = allowed(state.motion);
    const bad = Object.keys(state).find((key) => !able[key].includes(state[key]));
    field("segments").setAttribute("aria-invalid", bad === "segments" ? "true" : "false");
    if (bad) return;
    history.replaceState(null, "", `#atlas?${new URLSearchParams(state)}`);
    if (state.motion !== current.motion) {
      intoForm(state);
      return;
    }
    current = state;
    render(state);
  }

  const able = allowed(standard.motion);
  fill("motion", motions);
  fill("rule", rules);
  fill("beside", able.beside, (value) => value || "none");
  fill("modes", able.modes);
  fill("tolerance", able.tolerance, (value) => tolerance(Number(value)));
  form.addEventListener("input", fromForm);
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { if (location.hash.startsWith("#atlas?")) intoForm(fromAddress()); });
  addEventListener("resize", () => render(current));
  intoForm(fromAddress());
  if (location.hash.startsWith("#atlas?")) document.getElementById("atlas").scrollIntoView();
})();
