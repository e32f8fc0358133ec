"""MoveIt's PlanningScene and MotionPlanRequest messages, written as YAML."""
