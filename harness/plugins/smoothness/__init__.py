"""How smooth and how direct motions are."""
