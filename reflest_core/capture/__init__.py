"""Frames from topics, bags and folders: messages matched in time, decoded and checked."""
