"""The built-in joint controllers: one module for each, named after the controller."""
