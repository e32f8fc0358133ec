"""Why a planning request failed, stage by stage."""
