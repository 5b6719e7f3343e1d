"""How fast reflest is and what it costs: ``python -m benchmarks`` measures and writes the page."""
