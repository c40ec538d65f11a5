"""Ends drawn by Hypothesis for chains that are written to files: what stands in them, in SI units."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from beammodes.problem.supports import End

STIFFNESS = st.sampled_from([0.0, math.inf]) | st.floats(1.0, 1e4)
ENDS = st.builds(
    End,
    STIFFNESS,
    STIFFNESS,
    st.just(0.0) | st.floats(0.05, 1.0),
    st.just(0.0) | st.floats(0.001, 0.1),
    st.sampled_from([-0.1, 0.0, 0.05]),
)
