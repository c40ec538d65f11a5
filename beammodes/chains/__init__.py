"""Chains of rigid pieces and springs, and the rules that make them."""
