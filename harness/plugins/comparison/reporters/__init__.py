"""The reporter `green`."""
