"""Search for conditions under which a scenario fails, and the smallest change that does."""
