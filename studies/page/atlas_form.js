// What is chosen in the atlas: the form, the page's address, and what is wrong with a number that was typed.
const atlasForm = (data, chains, render) => {
  const form = document.getElementById("atlas-form");
  const field = (name) => form.elements.namedItem(name);
  const motions = Object.keys(data.motions);
  const standard = {
    motion: "bending", left: "clamped", right: "free", rule: "mitiguy", beside: "gregory", segments: "10", modes: "3",
    tolerance: "0.01", length: "", EI: "", rhoA: "", GJ: "", rhoIp: "", massLeft: "", inertiaLeft: "", massRight: "", inertiaRight: "",
  };
  const numbers = {
    length: "L in m", EI: "EI in N m²", rhoA: "ρA in kg/m", GJ: "GJ in N m²", rhoIp: "ρIₚ in kg m",
    massLeft: "The mass at the left end", inertiaLeft: "The rotary inertia at the left end",
    massRight: "The mass at the right end", inertiaRight: "The rotary inertia at the right end",
  };
  const [lightest, heaviest] = [1e-9, 1e6];
  const ofBody = (key) => key.startsWith("mass") || key.startsWith("inertia");
  const choices = (motion) => ({
    motion: motions, left: chains.ends(motion), right: chains.ends(motion), rule: chains.rules, beside: ["", ...chains.rules],
    segments: Array.from({ length: data.segments }, (_, i) => String(i + 1)),
    modes: Array.from({ length: data.modes }, (_, i) => String(i + 1)),
    tolerance: data.tolerances.map(String),
  });
  const tolerance = (value) => `${+(100 * value).toPrecision(3)} %`;

  function fill(name, values, word = (value) => value) {
    field(name).replaceChildren(...values.map((value) => new Option(word(value), value)));
  }

  // What is wrong with one value, in words, or "".
  function wrong(key, value, motion) {
    if (key in numbers) {
      if (value === "") return "";
      const size = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(value) ? Number(value) : NaN;
      if (ofBody(key)) return size >= 0 && size < 1e30 ? "" : `${numbers[key]} must be a number from 0 on, got ${value}.`;
      return size >= 1e-30 && size <= 1e30 ? "" : `${numbers[key]} must be a number greater than 0, got ${value}.`;
    }
    if (choices(motion)[key].includes(value)) return "";
    if (key === "segments") return `Segments N must be a whole number from 1 to ${data.segments}, got ${value || "none"}.`;
    return `${key} must be one of ${choices(motion)[key].join(", ")}, got ${value}.`;
  }

  // Bodies so light or heavy that numbers of this page could not be right: [key, what is wrong].
  function outside(state) {
    const found = chains.bodies(state);
    for (const [side, Side] of [["left", "Left"], ["right", "Right"]]) {
      for (const kind of ["mass", "inertia"]) {
        const size = found[side][kind];
        if (size && !(size >= lightest && size <= heaviest)) {
          return [`${kind}${Side}`, `${numbers[kind + Side]} must be 0, or from 10⁻⁹ to 10⁶ times the beam's own, got ${size.toPrecision(3)} times that.`];
        }
      }
    }
    return null;
  }

  // In the address: #atlas?left=clamped&right=free… What is not allowed is left out.
  function fromAddress() {
    const given = new URLSearchParams(location.hash.split("?")[1] || "");
    const motion = motions.includes(given.get("motion")) ? given.get("motion") : standard.motion;
    const kept = Object.keys(standard).filter((key) => given.has(key) && !wrong(key, given.get(key), motion));
    const state = { ...inMotion(standard, motion), ...Object.fromEntries(kept.map((key) => [key, given.get(key)])) };
    for (let bad = outside(state); bad; bad = outside(state)) state[bad[0]] = "";
    return state;
  }

  const toAddress = (state) =>
    new URLSearchParams(Object.entries(state).filter(([key, value]) => !(key in numbers) || value !== ""));

  // The ends as another motion has them: a clamp is a fixed end, and what twist does not know is free.
  function inMotion(state, motion) {
    const able = chains.ends(motion);
    const other = (word) => (able.includes(word) ? word : able.at(["clamped", "fixed"].includes(word) ? 0 : -1));
    return { ...state, motion, left: other(state.left), right: other(state.right) };
  }

  let current = standard;

  // Only fields that count for the chosen motion and ends are shown, with their units.
  function showFields(state) {
    const able = (name, yes) => { field(name).closest("div").hidden = !yes; };
    for (const [motion, keys] of Object.entries(chains.needs)) {
      for (const key of keys.slice(1)) able(key, motion === state.motion);
    }
    const [bending, si] = [state.motion === "bending", chains.scales(state) !== null];
    for (const [end, Side] of [["left", "Left"], ["right", "Right"]]) {
      able(`mass${Side}`, bending && state[end] === "free");
      able(`inertia${Side}`, state[end] === "free");
      const units = si ? ["kg", "kg m²"] : ["ρAL", bending ? "ρAL³" : "ρIₚL"];
      for (const [kind, unit] of [["mass", units[0]], ["inertia", units[1]]]) {
        document.querySelector(`label[for=pick-${kind}${Side}]`).textContent =
          `${kind === "mass" ? "Mass" : "Rotary inertia"}, ${end} end, ${unit}`;
      }
    }
    document.getElementById("atlas-bodies").hidden = ![state.left, state.right].includes("free");
  }

  function tell(problem, key) {
    for (const name of Object.keys(standard)) field(name).setAttribute("aria-invalid", String(name === key));
    document.getElementById("atlas-problem").textContent = problem && `${problem} Below stands the last valid choice.`;
  }

  function show(state) {
    const some = chains.needs[state.motion].filter((key) => state[key]);
    const missing = chains.needs[state.motion].filter((key) => !state[key]).map((key) => numbers[key]);
    document.getElementById("atlas-units").textContent = some.length && missing.length
      ? `For SI units give ${missing.join(" and ")} too; until then all is in multiples.` : "";
    showFields(state);
    current = state;
    render(state);
  }

  function intoForm(state) {
    fill("left", chains.ends(state.motion));
    fill("right", chains.ends(state.motion));
    for (const [key, value] of Object.entries(state)) field(key).value = value;
    tell("", "");
    show(state);
  }

  function fromForm() {
    let state = Object.fromEntries(Object.keys(standard).map((key) => [key, field(key).value.trim()]));
    const changed = state.motion !== current.motion;
    if (changed) state = inMotion(state, state.motion);
    const bad = Object.keys(state).find((key) => wrong(key, state[key], state.motion));
    const [key, problem] = bad ? [bad, wrong(bad, state[bad], state.motion)] : outside(state) || ["", ""];
    tell(problem, key);
    if (problem) return;
    history.replaceState(null, "", `#atlas?${toAddress(state)}`);
    if (changed) intoForm(state);
    else show(state);
  }

  const able = choices(standard.motion);
  fill("motion", motions);
  fill("rule", chains.rules);
  fill("beside", able.beside, (value) => value || "none");
  fill("modes", able.modes);
  fill("tolerance", able.tolerance, (value) => tolerance(Number(value)));
  form.addEventListener("input", fromForm);
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { if (location.hash.startsWith("#atlas?")) intoForm(fromAddress()); });
  addEventListener("resize", () => render(current));
  intoForm(fromAddress());
  if (location.hash.startsWith("#atlas?")) document.getElementById("atlas").scrollIntoView();
};
