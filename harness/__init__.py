"""armharness: a declarative scenario runner and test harness for robot arms."""

__version__ = "0.1.0"
