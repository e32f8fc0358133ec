"""Formulas over recorded signals: the parser, the meaning, the text."""
