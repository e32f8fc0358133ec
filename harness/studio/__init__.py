"""The studio: a robot cell in a browser, whose actions grow into a scenario."""
