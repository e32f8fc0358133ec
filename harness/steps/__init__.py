"""The built-in steps: one module for each verb, holding the class of that step.

`harness.core.registry` finds the modules by their names and registers each class as it registers
one of another package, so that a new step is a new file here.
"""
