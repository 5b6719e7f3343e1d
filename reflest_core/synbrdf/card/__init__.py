"""The data card's figures and pictures, made from a generated set."""
