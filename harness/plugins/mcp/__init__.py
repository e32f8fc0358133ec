"""A server of the Model Context Protocol for the scenarios of one folder."""

EXTRAS = {"mcp": "mcp"}  # packages that it needs, and the extra that has each
