"""How the outcome of runs depends on what varies in them."""
