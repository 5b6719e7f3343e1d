"""The node's name, under which its services and diagnostics are found."""

NODE_NAME = "reflest_estimator"
