"""What tests draw from: ends for chains that are written to files, in SI units, and rules by name."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from beammodes.chains.rules import RULES
from beammodes.problem.ends import End

#: Frozen, so that random tests draw what they drew when another rule is registered. Tests over every rule are
#: parametrized by `RULES` instead.
RULES_DRAWN = (
    "mitiguy",
    "double_wall",
    "naive",
    "gregory",
    "gregory2",
    "hencky",
    "half_stub",
    "half_stub_corrected",
    "rigid_stub",
    "rigid_stub_corrected",
)
#: Every rule that lays out chains of any N. One whose springs inside repeat a pattern does for some N only:
#: tests/test_patterns.py holds each to its law and the solved chain.
EVERY_N = [name for name, rule in RULES.items() if rule.has_equal_springs]
STIFFNESS = st.sampled_from([0.0, math.inf]) | st.floats(1.0, 1e4)
ENDS = st.builds(
    End,
    STIFFNESS,
    STIFFNESS,
    st.just(0.0) | st.floats(0.05, 1.0),
    st.just(0.0) | st.floats(0.001, 0.1),
    st.sampled_from([-0.1, 0.0, 0.05]),
)
