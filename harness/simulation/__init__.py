"""Physics on MuJoCo."""
