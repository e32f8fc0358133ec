"""How arms follow what moves on belts."""
