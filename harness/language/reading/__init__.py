"""From a file to a checked scenario: includes, parameters, short forms, overrides, mistakes."""
