"""Statistics of planners on the motions of scenarios, as MoveIt's benchmark suite gives them."""
