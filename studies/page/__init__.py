"""The report regenerated as one page, `figures/report.html`, opened from disk; its parts and its text."""
