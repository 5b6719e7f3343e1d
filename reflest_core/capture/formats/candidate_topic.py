# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded topic that may play a role."""

from __future__ import annotations

from dataclasses import dataclass

TRANSPORTS = ("/compressedDepth", "/compressed")
"""What image_transport appends to a topic's name for its compressed forms; the better first."""


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


def without_copies(topics: list[CandidateTopic]) -> list[CandidateTopic]:
    """Leave out the compressed copies of images that are there raw, or compressed better."""
    names = {topic.name for topic in topics}

    def is_copy(name: str) -> bool:
        for rank, transport in enumerate(TRANSPORTS):
            base = name.removesuffix(transport)
            if base != name:
                return any(base + better in names for better in ("", *TRANSPORTS[:rank]))
        return False

    return [topic for topic in topics if not is_copy(topic.name)]
