# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the code has no better place to say; the page fails to be written where one is missing."""

from __future__ import annotations

from reflest_core.capture.refusal import RefusalCause

OUTPUTS = {
    "/reflectance/brdf": (
        "The material in the region of interest, or else the one in the middle of the view, at "
        "each keyframe and on request; its fields are below."
    ),
    "/reflectance/preview": (
        "A sphere of the estimated material under a fixed light, `rgb8`, sRGB; stamp and frame are "
        "the estimate's. Black after a reset."
    ),
    "/reflectance/voxels": (
        "The observed surface in the world frame, metres: `x y z` (`FLOAT64` where the scan began "
        "over 100 m from the world's origin), `rgb` (see `voxels.colour`), "
        "`normal_x normal_y normal_z`, `views` (observations of the voxel). Without points after a "
        "reset."
    ),
    "/reflectance/environment": (
        "The light around the object in the world frame, equirectangular, `32FC3`: red, green, "
        "blue in linear sRGB, 1 at the camera's white in the first frame. Row 0 looks along +z, "
        "the middle column along +x, the column a quarter of the width to its left along +y. Seen "
        "where the coverage says so, completed elsewhere; black after a reset. RViz and Foxglove "
        "do not show float colours: look at its preview."
    ),
    "/reflectance/environment/coverage": (
        "Of each of its pixels, `mono8`: 255 seen, 127 seen but known only as a lower bound (the "
        "camera's white was passed), 0 not seen: completed."
    ),
    "/reflectance/environment/preview": (
        "The same light to look at, `rgb8`, sRGB, as the camera exposed it; what was not seen is "
        "dim."
    ),
    "/reflectance/markers": (
        "In the world frame: the values and how far to trust them as text (namespace `values`), "
        "the cameras of the keyframes, newest brightest (`keyframes`), the region of interest "
        "(`region`) or else circles at the work radius, outside of which nothing is scanned "
        "(`work_radius`)."
    ),
    "/reflectance/materials": (
        "Every material of the scan in falling order of area, under one light; see "
        "`materials.when`. Empty after a reset. Its fields are below."
    ),
    "/reflectance/material_cloud": (
        "The observed surface in the world frame, metres: `x y z` (as in `reflectance/voxels`), "
        "`normal_x normal_y normal_z`, `rho_d_r rho_d_g rho_d_b` of each voxel (linear sRGB), "
        "`rho_s`, `alpha`, a standard deviation of each (`..._stddev`), `normal_stddev` (of the "
        "normal about each tangent axis, radians, judged by its neighbours), `material_id` (0: of "
        "no material), and `rgb`, the colour of the material's label; `observed_rgb`, the mean "
        "colour that the views saw (0x00RRGGBB)."
    ),
    "/reflectance/material_markers": (
        "A text at each material: id, `rho_s`, `alpha` and status, in the colour of its label."
    ),
    "/reflectance/overlay": (
        "The labels of the materials drawn over the last image, `rgb8`. Dark: without depth, or "
        "outside of the region of interest or the work radius, and not scanned. Black after a "
        "reset."
    ),
    "/diagnostics": "One status each `input.diagnostics_period`; its keys are below.",
}
"""Published topics, by their full names."""

DIAGNOSTICS = {
    "messages ROLE": "Messages received on the topic of that role.",
    "rate ROLE (Hz)": "Messages each second, over the last 5 s.",
    "incompatible QoS ROLE": "Present where publishers cannot be heard: both policies and the fix.",
    "matched ratio": "Frames for each colour image so far; nan without images.",
    "frames matched": "Colour images that found depth, calibration and pose.",
    "frames fused": "Frames that went into the scan.",
    "frames redundant": "Those of them that showed nothing new, so that nothing was done.",
    "frames of light alone": "Those of them that looked away from the object, at its light.",
    "queue": "Messages and jobs that wait for fusion.",
    "keyframes": "Frames at which an estimate was due.",
    "keyframes skipped": "Keyframes that a newer one replaced before their estimate was begun.",
    "discarded keyframes": "Keyframes and estimates dropped because a new scan had begun.",
    "discarded messages": "Messages that waited when a new scan began.",
    "keyframes without an estimate": "Keyframes at which the scan held too little.",
    "last reason for no estimate": "Why; empty where there was none.",
    "estimates": "Estimates published.",
    "last estimate's age (s)": "Since its publication; nan before the first.",
    "last estimate's latency (s)": "From its image's arrival, or the request, to its publication.",
    "material maps": "Maps published on /reflectance/materials.",
    "materials": "Materials of the last one.",
    "last material map's duration (s)": "From request to publication; nan before the first.",
    "last reason for no materials": "Why the last map could not be made; empty where it could.",
    "segments": "Of the last map.",
    "light's condition": (
        "Condition number of the last map's joint light, its unknowns scaled; large where it is "
        "poorly determined, nan for one material."
    ),
    "time of segmentation (s)": "Of the last map, the joint light included; nan for a region.",
    "time of light (s)": "The rest of the last map's light.",
    "time of materials (s)": "All networks, gloss and albedos of the last map.",
    "time of fusion (s)": "Of the last frame.",
    "depth agreement": (
        "Share of a keyframe's depth that meets the next one's under the given poses; nan before "
        "the second."
    ),
    "colour agreement": (
        "Median correlation of colour detail from frame to frame where depth meets, -1 to 1; nan "
        "where nothing has texture."
    ),
    "edge agreement": (
        "Mean correlation of the edges of colours with those of depth, 0.1 to 0.6 where they lie "
        "on each other; nan until 10 frames have edges."
    ),
    "warning of colours": "Where colours may not be registered to depth, with what to check.",
    "pose jumps": "Jumps of the tracker since the scan began; see `fusion.on_jump`.",
    "voxels": "Surface voxels in the store.",
    "observations": "Observations in the store.",
    "views": "Views in the store.",
    "store (MB)": "Reserved by volume, store and views.",
    "store budget (MB)": "`fusion.memory_budget_mb`.",
    "store in use": "Share of the store that is taken, 0 to 1; at 1 old voxels give way.",
    "exposure drift (stops)": (
        "By how much the newest third of the views is brighter than the oldest; nan where unknown."
    ),
    "exposure correction (stops)": (
        "By how much the last frame's colours are brightened to be at the first one's exposure, as "
        "far as the background shows it; 0 with a locked exposure."
    ),
    "light seen": "Share of all directions in which the light around the object was seen, 0 to 1.",
    "autosave's age (s)": "Since the last one; present with autosave.",
    "autosave's duration (s)": "Of the last one; present with autosave.",
    "autosave's failure": "Why the last one failed; present with autosave, empty where it did not.",
    "refused CAUSE": "Frames and messages refused for that cause; present where there were any.",
}
"""Keys of the status. ROLE: an input of the table above. CAUSE: one of the causes below."""

CONDITIONAL = (
    "incompatible QoS ROLE",
    "refused CAUSE",
    "autosave's age (s)",
    "autosave's duration (s)",
    "autosave's failure",
)
"""Keys that a node without trouble does not show."""

REFUSALS = {
    RefusalCause.ENCODING: "An encoding or compression that is not supported.",
    RefusalCause.SIZE: "Image sizes that do not fit one another or their calibration.",
    RefusalCause.TRUNCATED: "Fewer bytes than height, step and encoding ask for.",
    RefusalCause.CAMERA_INFO_MISSING: "A colour image, but no calibration.",
    RefusalCause.CAMERA_INFO_INVALID: "A calibration that is no pinhole camera's, or unsupported.",
    RefusalCause.POSE_INVALID: "A pose that is not finite or not a rotation.",
    RefusalCause.POSE_MISSING: "No pose at the image's stamp.",
    RefusalCause.DEPTH_MISSING: "No depth image at the colour image's stamp.",
    RefusalCause.DEPTH_EMPTY: "No valid pixel of depth, though the object may be in sight.",
    RefusalCause.MASK_MISSING: "No mask at the colour image's stamp.",
    RefusalCause.FRAME_MISMATCH: "Frames that contradict one another.",
    RefusalCause.TRANSFORM_MISSING: "No transform between two frames at the stamp.",
    RefusalCause.TRANSFORM_INVALID: "A transform that is not finite or not a rotation.",
    RefusalCause.STAMP_INVALID: "A stamp that is no time.",
    RefusalCause.TIME_BACKWARDS: "A message or frame before one that was used already.",
    RefusalCause.CLOCK_JUMP: "The clock went back; what waited was dropped.",
    RefusalCause.NO_OVERLAP: "Nothing of the image is the object, though it may be in sight.",
    RefusalCause.QUEUE_FULL: "Fusion was slower than the input.",
    RefusalCause.MESSAGE_LOST: "A message is missing between two of a topic with one publisher.",
    RefusalCause.INTERNAL_ERROR: "An error in reflest itself; please report it.",
}


def diagnostic_pattern(key: str, roles: list[str]) -> str:
    """The key of :data:`DIAGNOSTICS` that a live key stands for.

    Args:
        key: of a diagnostic.
        roles: names of the streams.
    """
    if key.startswith("refused "):
        return "refused CAUSE"
    for role in sorted(roles, key=len, reverse=True):
        if f" {role}" in key:
            return key.replace(f" {role}", " ROLE", 1)
    return key
