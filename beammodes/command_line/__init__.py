"""The command line: what each command answers, and how answers and help look."""
