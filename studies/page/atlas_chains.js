// What the atlas knows of a chain: looked up where the library has computed it, computed here where ends have bodies.
const atlasChains = (data) => {
  const rules = data.rules.map((rule) => rule.name);
  const ends = (motion) => data.motions[motion].ends;
  const mostModes = data.modes;
  const number = (text) => Number(text || 0);

  // What numbers of a beam in SI units make of multiples, null while they are not all given.
  const needs = { bending: ["length", "EI", "rhoA"], twist: ["length", "GJ", "rhoIp"] };
  function scales(state) {
    const given = needs[state.motion].map((key) => number(state[key]));
    if (given.some((value) => !value)) return null;
    const [length, stiffness, density] = given;
    const bending = state.motion === "bending";
    const time = (bending ? length ** 2 : length) * Math.sqrt(density / stiffness);
    return { spring: stiffness / length, time, mass: density * length, inertia: density * length ** (bending ? 3 : 1) };
  }

  // Bodies in multiples of the beam's own; those of ends that are not free, and masses in twist, count for nothing.
  function bodies(state) {
    const unit = scales(state) || { mass: 1, inertia: 1 };
    const body = (end, Side) => (state[end] !== "free" ? { mass: 0, inertia: 0 } : {
      mass: state.motion === "bending" ? number(state[`mass${Side}`]) / unit.mass : 0,
      inertia: number(state[`inertia${Side}`]) / unit.inertia,
    });
    return { left: body("left", "Left"), right: body("right", "Right") };
  }

  const heavy = ({ left, right }) => [left, right].some((body) => body.mass || body.inertia);

  function stored(motion, left, right, rule) {
    const { pairs, chains } = data.motions[motion];
    const listed = pairs.indexOf(`${left}-${right}`);
    const turned = listed < 0;
    const pair = turned ? pairs.indexOf(`${right}-${left}`) : listed;
    const record = data.records[chains[pair][rules.indexOf(rule)]];
    return { ...record, springs: (segments) => {
      const text = data.springs[record.springs[segments - 1]];
      return turned && !text.startsWith("none") ? text.split(", ").reverse().join(", ") : text;
    } };
  }

  const values = (text) => (!text || text.startsWith("none") ? [] : text.split(", ").flatMap((part) => {
    const [times, fraction] = part.includes("×") ? part.split("×") : [1, part];
    const [above, below = 1] = fraction.split("/").map(Number);
    return Array(Number(times)).fill(above / below);
  }));

  // The word in bending whose springs stand at an end: by what the beam feels there.
  const word = (state, end, body) => {
    if (state[end] === "free") return body.inertia ? "clamped" : "free";
    return state.motion === "twist" ? "guided" : state[end];
  };

  const kept = new Map();
  const once = (key, make) => {
    const name = JSON.stringify(key);
    if (!kept.has(name)) kept.set(name, make());
    return kept.get(name);
  };

  // ω of the exact beam, in its own unit.
  function exact(state) {
    const carried = bodies(state);
    const { motion, left, right } = state;
    return once([motion, left, right, carried], () => exactBeam.frequencies(motion, left, right, carried, mostModes));
  }

  function computed(state, rule) {
    const given = bodies(state);
    return once([state.motion, state.left, state.right, given, rule], () => compute(state, rule, given));
  }

  function compute(state, rule, given) {
    const words = ["left", "right"].map((end) => word(state, end, given[end]));
    const { springs } = stored("bending", ...words, rule);
    const { stub, rotaryInertia } = data.rules[rules.indexOf(rule)];
    // The end that holds most stands on the left: none is held on the right of it.
    const turn = state.right !== "free";
    const [left, carried, wall] = turn
      ? [state.right, { left: given.right, right: given.left }, [...words].reverse()]
      : [state.left, given, words];
    const judged = exact(state);
    const found = { error: [], omega: [], rounding: [], springs, law: null };
    for (let segments = 1; segments <= data.segments; segments += 1) {
      const inside = Array(stub === 0.5 ? segments - 1 : segments).fill(1);
      const ofNoLength = (at) => (wall[at] === "clamped" || wall[at] === "guided" ? [0] : []);
      const lengths = stub === 0.5 ? [0.5, ...inside, 0.5] : stub ? inside : [...ofNoLength(0), ...inside, ...ofNoLength(1)];
      const row = values(springs(segments));
      if (turn) row.reverse();
      const fits = row.length === lengths.length - 1;
      const chain = { motion: state.motion, left, rotaryInertia, segments, lengths, springs: row, bodies: carried };
      const { omega, highest, rounding } = fits ? chainModes.solve(chain, mostModes) : { omega: [], highest: 0, rounding: [] };
      found.error.push(judged.map((value, i) => (i < omega.length ? omega[i] / value - 1 : null)));
      found.omega.push(highest);
      found.rounding.push(rounding);
    }
    return found;
  }

  const isComputed = (state) => heavy(bodies(state));
  const record = (state, rule) => (isComputed(state) ? computed(state, rule) : stored(state.motion, state.left, state.right, rule));
  const hasChain = (of, segments) => !(of.springs(segments) || "").startsWith("none: the");

  // N from which on the first modes stay within the tolerance, 0 if none is found; and how far it was looked.
  function needed(of, state) {
    const modes = Number(state.modes);
    if (of.needed) return { count: of.needed[modes - 1][data.tolerances.indexOf(Number(state.tolerance))], most: data.longest };
    let count = 0;
    for (let segments = data.segments; segments > 0; segments -= 1) {
      if (!hasChain(of, segments)) continue;
      const row = of.error[segments - 1].slice(0, modes);
      if (row.some((error) => error === null || Math.abs(error) > Number(state.tolerance))) break;
      count = segments;
    }
    return { count, most: data.segments };
  }

  return { rules, ends, needs, scales, bodies, exact, isComputed, record, needed, values, hasChain };
};
