"""What finds paths by the name of a planner."""
