"""Keys of a file that name files of other programs."""
