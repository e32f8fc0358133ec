"""Types that depend on no other package: poses, shapes, trajectories, errors."""
