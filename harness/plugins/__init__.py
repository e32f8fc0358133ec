"""What only some users start: campaigns, formats, formulas, grading, iktest, ros and studio.

Each is a package that nothing else imports. Its folders `commands`, `expectations` and so on hold
its plug-ins of that kind.
"""
