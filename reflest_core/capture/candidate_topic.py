# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded topic that may play a role."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CandidateTopic:
    """A recorded topic; ``encoding`` is that of its first image, "" for other types."""

    name: str
    message_type: str
    encoding: str = ""

    def __str__(self) -> str:
        """Name, type and encoding, for sentences."""
        kind = self.message_type.split("/")[-1]
        return f"{self.name} ({kind}{', ' + self.encoding if self.encoding else ''})"
