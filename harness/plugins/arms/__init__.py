"""How well arms follow, how hard they work, and how far they keep from things."""
