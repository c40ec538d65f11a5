// The exact uniform beam between two ends, each with a body where it is free: its frequencies by its determinant.
const exactBeam = (() => {
  // An end is a list of bodies in multiples of the beam's own, 0 where it is free, Infinity where it is held:
  // [mass, rotary inertia] in bending, [inertia] in twist. The determinant is linear in each of them, and its
  // coefficients are the determinants between plain ends, here over cosh β.
  const plainBending = (b) => {
    const cos = Math.cos(b), sin = Math.sin(b);
    const cosh = Math.cosh(Math.min(b, 700)), tanh = Math.tanh(b);
    // Differences that vanish with β: by their series where that is short.
    const series = (factor, power) => {
      let term = factor, total = 0;
      for (let k = 1; k <= power; k += 1) term *= b / k;
      for (let k = power; Math.abs(term) > 1e-20 * Math.abs(total); k += 4) {
        total += term;
        term *= (-4 * b ** 4) / ((k + 1) * (k + 2) * (k + 3) * (k + 4));
      }
      return total / cosh;
    };
    const small = b < 2;
    const less = small ? series(4, 4) : 1 / cosh - cos;
    const more = 1 / cosh + cos;
    const apart = small ? series(-4, 3) : cos * tanh - sin;
    const both = cos * tanh + sin;
    // Ends are numbered by what is held, deflection 1 and rotation 2: free, pinned, guided, clamped.
    return [
      [less / 2, -apart / 2, both / 2, more / 2],
      [-apart / 2, sin * tanh, cos, apart / 2],
      [both / 2, cos, -sin * tanh, -both / 2],
      [more / 2, apart / 2, -both / 2, less / 2],
    ];
  };
  const plainTwist = (b) => [[Math.sin(b), Math.cos(b)], [Math.cos(b), -Math.sin(b)]];

  // How much of each plain end is in an end with these bodies.
  const weights = (bodies, powers) => {
    let found = [1];
    bodies.forEach((body, i) => {
      const [without, held] = body === Infinity ? [0, 1] : [1, body * powers[i]];
      found = [...found.map((value) => value * without), ...found.map((value) => value * held)];
    });
    return found;
  };

  function determinant(b, left, right) {
    const bending = left.length === 2;
    const plain = bending ? plainBending(b) : plainTwist(b);
    const [from, to] = [left, right].map((bodies) => weights(bodies, bending ? [b, b ** 3] : [b]));
    return plain.reduce((total, row, i) => total + from[i] * row.reduce((sum, value, j) => sum + value * to[j], 0), 0);
  }

  function between(low, high, left, right) {
    const sign = Math.sign(determinant(high, left, right));
    for (let [a, b] = [low, high]; ;) {
      const middle = (a + b) / 2;
      if (middle <= a || middle >= b) return middle;
      if (Math.sign(determinant(middle, left, right)) === sign) b = middle;
      else a = middle;
    }
  }

  // Between plain ends there is one root at most in each half of π, near a multiple of π/4; before them stand
  // as many zeros as there are motions that bend or twist nothing.
  function plainRoots(left, right, count) {
    const [deflection, rotation] = [0, 1].map((i) => [left, right].filter((bodies) => bodies[i] === Infinity).length);
    const rigid = left.length === 2 ? 2 : 1;
    const found = Array(rotation ? Number(!deflection) : Math.max(0, rigid - deflection)).fill(0);
    for (let low = Math.PI / 8; found.length < count; low += Math.PI / 2) {
      const [a, b] = [low, low + Math.PI / 2].map((edge) => Math.sign(determinant(edge, left, right)));
      if (a !== b) found.push(between(low, low + Math.PI / 2, left, right));
    }
    return found;
  }

  // β of the first frequencies, those of rigid motions, 0, among them. With a heavier body every frequency falls,
  // as far as the one before it with that body held: between these lies one root.
  function roots(left, right, count) {
    const at = [left, right].findIndex((bodies) => bodies.some((body) => body > 0 && body < Infinity));
    if (at < 0) return plainRoots(left, right, count);
    const place = [left, right][at].findIndex((body) => body > 0 && body < Infinity);
    const having = (body) => {
      const ends = [[...left], [...right]];
      ends[at][place] = body;
      return roots(...ends, count);
    };
    const [above, below] = [having(0), having(Infinity)];
    return above.map((high, i) => (high === 0 ? 0 : between(i ? below[i - 1] : 0, high, left, right)));
  }

  const held = (word) => ({ free: [0, 0], pinned: [Infinity, 0], guided: [0, Infinity], clamped: [Infinity, Infinity] })[word];

  // ω of the first elastic modes, in √(EI/ρAL⁴) or, in twist, √(GJ/ρIₚL²).
  function frequencies(motion, left, right, bodies, count) {
    const end = (word, body) => {
      if (motion === "twist") return [word === "fixed" ? Infinity : body.inertia];
      return held(word).map((number, i) => number || (word === "free" ? [body.mass, body.inertia][i] : 0));
    };
    const found = roots(end(left, bodies.left), end(right, bodies.right), count + 2).filter((b) => b > 0);
    return found.slice(0, count).map((b) => (motion === "twist" ? b : b * b));
  }

  return { frequencies };
})();
