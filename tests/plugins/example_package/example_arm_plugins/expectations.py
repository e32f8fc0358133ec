"""An expectation about the height of the tool."""

from harness.expectations import Length, Margin, Predicate, Window


class TcpHeight(Predicate):
    """The TCP is at least this high above the world's origin."""

    at_least: Length

    def signal(self, window: Window) -> Margin:
        """Height above the bound."""
        return window.tcp_position[:, 2] - self.at_least
