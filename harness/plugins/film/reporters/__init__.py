"""The reporter `film`."""
