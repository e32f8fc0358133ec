"""One case from its file to its report: compiled, executed, observed, judged and written."""
