"""The planners of OMPL."""
