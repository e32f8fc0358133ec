"""The plug-ins of this distribution: what only some users start, one package for each."""
