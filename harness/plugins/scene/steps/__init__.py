"""Steps that change the planning scene, one module for each."""
