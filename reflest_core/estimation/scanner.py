"""The live path in one object: frames in, keyframes out, estimates on demand.

The ROS node and ``reflest replay`` both drive this class, so that they agree bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.fused_frame import FusedFrame
from reflest_core.fusion.keyframe import KeyframePolicy
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.fusion.scan import Scan


@dataclass(frozen=True)
class KeyframeSnapshot:
    """The surface as it stood when the keyframe was fused."""

    stamp_ns: int
    frame_id: str
    surface: ObservedSurface


@dataclass(frozen=True)
class ScannedFrame:
    """What one frame did, and the snapshot to estimate from if it was a keyframe."""

    fused: FusedFrame
    keyframe: KeyframeSnapshot | None


class Scanner:
    """Fuses frames and estimates the material of what they show.

    :meth:`estimate` only reads its snapshot: it may run in one other thread while frames go on.
    """

    def __init__(self, settings: ReflestSettings) -> None:
        """Load the weights and allocate the scan; :class:`ReflestError` says what is wrong."""
        self.settings = settings
        self.estimator = Estimator(settings.estimation)
        self.scan = Scan(settings.fusion, settings.region)
        self.keyframes = KeyframePolicy(settings.keyframe)

    def fuse(self, frame: Frame) -> ScannedFrame:
        """Fuse one frame; raises :class:`FrameRefused` and leaves the scan as it was."""
        fused = self.scan.fuse(frame)
        if not self.keyframes.is_keyframe(frame.stamp_ns, frame.T_world_camera):
            return ScannedFrame(fused, None)
        return ScannedFrame(fused, self.snapshot(frame.stamp_ns, frame.frame_id))

    def snapshot(self, stamp_ns: int, frame_id: str) -> KeyframeSnapshot:
        """A frozen copy of the scan to estimate from."""
        return KeyframeSnapshot(stamp_ns, frame_id, self.scan.snapshot())

    def estimate(self, snapshot: KeyframeSnapshot) -> BrdfEstimate:
        """Estimate from a snapshot; raises :class:`NoEstimate` with the reason."""
        return self.estimator.estimate(snapshot.surface, snapshot.stamp_ns, snapshot.frame_id)

    def reset(self) -> None:
        """Forget everything that was scanned."""
        self.scan.reset()
        self.keyframes.reset()

    def save(self, path: Path) -> None:
        """Write volume, store and views to one file."""
        self.scan.save(path)

    def load(self, path: Path) -> None:
        """Go on from a file that :meth:`save` wrote; the scan stays as it was if that fails."""
        self.scan = Scan.load(path)
        self.keyframes.reset()
