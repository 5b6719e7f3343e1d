"""Clocks, memory, fresh processes and what is known about the machine."""
