"""One scenario: the only place that joins engine, adapters, assertions and reports."""
