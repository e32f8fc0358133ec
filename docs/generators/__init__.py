"""Generators of reference pages, samples and pictures: one module for each kind."""
