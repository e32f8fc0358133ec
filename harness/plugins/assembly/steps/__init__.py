"""Steps of several arms, one module for each."""
