# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which files the services of the node may read and write."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from reflest_core.errors import ReflestError
from reflest_core.whole_file import check_writable
from reflest_ros.settings import NODE_NAME, FileSettings


class FileAccessError(ReflestError):
    """A service was asked for a file that it may not use."""


class FileAccess:
    """Keeps the services' paths below one folder.

    Anyone on the network can call a service; without this, anyone could overwrite every file that
    the node's user can write.

    Attributes:
        root: The folder, absolute and without links.
    """

    def __init__(self, settings: FileSettings, node_name: str = NODE_NAME) -> None:
        """Choose the folder.

        Args:
            settings: ``files.root`` and ``files.allow_write``.
            node_name: Names the default folder, below ``ROS_HOME`` or ``~/.ros``.
        """
        root = settings.root or str(ros_home() / "reflest" / node_name)
        try:
            self.root = Path(root).expanduser().resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise FileAccessError(f"files.root = {root!r} cannot be used: {error}") from None
        self._may_write = settings.allow_write

    def to_read(self, text: str) -> Path:
        """The existing regular file that a request names.

        Args:
            text: Absolute, or relative to the root.

        Returns:
            Its path without links.

        Raises:
            FileAccessError: The path is not a regular file below the root.
        """
        path = self._below_root(text)
        if path.exists() and not path.is_file():
            raise FileAccessError(f"{path} is not a regular file: name a file")
        return path

    def to_write(self, text: str) -> Path:
        """The file that a request asks to write; the root is made where it does not exist.

        Args:
            text: Absolute, or relative to the root.

        Returns:
            Its path without links.

        Raises:
            FileAccessError: Writing is turned off, or the path is not one of a regular file below
                the root.
            OutputError: The file's folder does not exist or is read-only.
        """
        if not self._may_write:
            raise FileAccessError("writing is turned off: files.allow_write is false")
        path = self._below_root(text)
        try:
            if path.is_relative_to(self.root) and not self.root.exists():
                self.root.mkdir(mode=0o700, parents=True)
            mode = os.lstat(path).st_mode
        except FileNotFoundError:
            check_writable(path)
            return path
        except OSError as error:
            raise FileAccessError(f"{path} cannot be written: {error.strerror}") from None
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
            raise FileAccessError(f"{path} is {kind}: name a file")
        check_writable(path)
        return path

    def _below_root(self, text: str) -> Path:
        if not text:
            raise FileAccessError(f"the request's path is empty: name a file below {self.root}")
        shown = text if len(text) <= 200 else f"{text[:200]}..."
        if "\0" in text:
            raise FileAccessError(f"the path {shown!r} holds a null character")
        given = self.root / text
        if ".." in given.parts:
            raise FileAccessError(f"the path {shown!r} holds '..': name a file below {self.root}")
        try:
            path = given.resolve()
        except (OSError, RuntimeError) as error:
            raise FileAccessError(f"the path {shown!r} cannot be used: {error}") from None
        if not path.is_relative_to(self.root) or path == self.root:
            raise FileAccessError(
                f"the path {shown!r} is not below {self.root}: name a file there, or start "
                "the node with another files.root"
            )
        return path


def ros_home() -> Path:
    """Where ROS keeps a user's files: ``ROS_HOME``, or ``~/.ros``.

    Returns:
        A folder that may not exist.
    """
    given = os.environ.get("ROS_HOME")
    return Path(given) if given else Path(os.path.expanduser("~")) / ".ros"
