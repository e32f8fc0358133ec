"""MoveIt's operations on the planning scene: objects that come and go, are attached, may touch."""
