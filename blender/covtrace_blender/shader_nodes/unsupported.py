"""The error of a node that has no value here."""


class Unsupported(Exception):
    """A node that cannot be evaluated, with the reason."""

    def __init__(self, node, reason):
        super().__init__(f"node '{node.name}': {reason}")
        self.node, self.reason = node, reason


class NeedsBody(Unsupported):
    """A node that asks for what hangs on the place on a body, where only a UV map is known."""
