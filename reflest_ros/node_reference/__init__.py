"""Writes ``docs/node.md`` from the code and from a node that runs."""
