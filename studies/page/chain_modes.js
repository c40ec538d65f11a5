// A chain of rigid pieces with bodies at free ends: its frequencies, from its mass matrix and its springs.
const chainModes = (() => {
  // Householder's reflections take a symmetric matrix to three diagonals: [diagonal, beside it].
  function tridiagonal(a) {
    const n = a.length;
    const beside = [];
    for (let k = 0; k < n - 2; k += 1) {
      const v = a.map((row, i) => (i > k ? row[k] : 0));
      const size = Math.hypot(...v);
      beside.push(v[k + 1] > 0 ? -size : size);
      if (size === 0) continue;
      v[k + 1] -= beside[k];
      const square = v.reduce((total, value) => total + value * value, 0);
      const p = a.map((row) => (2 * row.reduce((total, value, j) => total + value * v[j], 0)) / square);
      const share = v.reduce((total, value, i) => total + value * p[i], 0) / square;
      for (let i = k + 1; i < n; i += 1) {
        for (let j = k + 1; j < n; j += 1) a[i][j] -= v[i] * (p[j] - share * v[j]) + (p[i] - share * v[i]) * v[j];
      }
    }
    if (n > 1) beside.push(a[n - 1][n - 2]);
    return [a.map((row, i) => row[i]), beside];
  }

  // The largest eigenvalues, and the smallest, by counting how many lie above a number (Sturm).
  function eigenvalues(matrix, count) {
    const [d, e] = tridiagonal(matrix);
    const bound = Math.max(...d.map((value, i) => Math.abs(value) + Math.abs(e[i] || 0) + Math.abs(e[i - 1] || 0)));
    const above = (x) => {
      let [q, found] = [1, 0];
      for (let i = 0; i < d.length; i += 1) {
        q = d[i] - x - (i ? (e[i - 1] * e[i - 1]) / (q || 1e-300) : 0);
        if (q > 0) found += 1;
      }
      return found;
    };
    const nth = (n) => {
      let [low, high] = [0, bound];
      for (;;) {
        const middle = (low + high) / 2;
        if (middle <= low || middle >= high) return middle;
        if (above(middle) >= n) low = middle;
        else high = middle;
      }
    };
    const largest = Array.from({ length: Math.min(count, d.length) }, (_, i) => nth(i + 1));
    return { largest, smallest: nth(d.length) };
  }

  // Rows of √mass times velocity, one column for each motion that no spring hinders and one for each hinge.
  function momenta(chain) {
    const { motion, left, rotaryInertia, segments, bodies } = chain;
    const pieces = chain.lengths.map((length) => length / segments);
    const hinges = [];
    let x = 0;
    const parts = [{ x: 0, after: 0, ...bodies.left }];
    pieces.forEach((length, i) => {
      parts.push({ x: x + length / 2, after: i, mass: length, inertia: motion === "twist" ? length : rotaryInertia * length ** 3 });
      x += length;
      if (i < pieces.length - 1) hinges.push(x);
    });
    parts.push({ x, after: hinges.length, ...bodies.right });
    const springs = chain.springs.map((spring) => spring * segments);
    const rows = [];
    const add = (weight, rigid, ofHinge, part) => {
      if (!weight) return;
      const size = Math.sqrt(weight);
      rows.push([...rigid.map((value) => value * size),
        ...hinges.map((at, j) => (j < part.after ? (size * ofHinge(at)) / Math.sqrt(springs[j]) : 0))]);
    };
    const able = { free: [0, 1], pinned: [1], guided: [0], clamped: [] }[left];
    for (const part of parts) {
      if (motion === "twist") add(part.inertia, left === "free" ? [1] : [], () => 1, part);
      else {
        add(part.mass, able.map((k) => [1, part.x][k]), (at) => part.x - at, part);
        add(part.inertia, able.map((k) => [0, 1][k]), () => 1, part);
      }
    }
    const rigid = motion === "twist" ? Number(left === "free") : able.length;
    return { rows, rigid, hinges: hinges.length };
  }

  // ω of the first modes and of the highest, in the beam's own unit, and how far rounding may have moved each,
  // relatively. Eigenvalues are 1/ω²: so the low frequencies are those that rounding moves least.
  function solve(chain, count) {
    const { rows, rigid, hinges } = momenta(chain);
    if (!hinges) return { omega: [], highest: 0, rounding: [] };
    // Free of momentum: what is left beside the motions that no spring hinders.
    for (let k = 0; k < rigid; k += 1) {
      const square = rows.reduce((total, row) => total + row[k] * row[k], 0);
      for (let j = k + 1; j < rigid + hinges; j += 1) {
        const share = rows.reduce((total, row) => total + row[k] * row[j], 0) / square;
        for (const row of rows) row[j] -= share * row[k];
      }
    }
    const matrix = Array.from({ length: hinges }, () => new Float64Array(hinges));
    for (const row of rows) {
      for (let i = 0; i < hinges; i += 1) {
        for (let j = 0; j <= i; j += 1) matrix[i][j] += row[rigid + i] * row[rigid + j];
      }
    }
    for (let i = 0; i < hinges; i += 1) for (let j = 0; j < i; j += 1) matrix[j][i] = matrix[i][j];
    const { largest, smallest } = eigenvalues(matrix, count);
    return {
      omega: largest.map((value) => 1 / Math.sqrt(value)),
      highest: 1 / Math.sqrt(smallest),
      rounding: largest.map((value) => (1e-15 * largest[0]) / value),
    };
  }

  return { solve };
})();
