"""Pictures of recorded states."""
