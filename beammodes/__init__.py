"""Chains of rigid segments and rotational springs that stand for flexible beams."""

__version__ = "0.1.0"
