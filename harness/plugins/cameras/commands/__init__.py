"""The command `film`."""
