# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One visitor's page: what was chosen on it, and a thread that draws it."""

from __future__ import annotations

import html
import logging
import threading
import time
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.viewer.angle_plot import angle_plot
from reflest_core.viewer.colour_modes import ColourMode, coloured, modes_of
from reflest_core.viewer.drawing import Drawing, scan_size
from reflest_core.viewer.lights import Light
from reflest_core.viewer.material_card import material_card, with_deviation
from reflest_core.viewer.next_views import Suggestion, next_views, unseen_light
from reflest_core.viewer.panel import WAITING, Panel, text
from reflest_core.viewer.shading import Shading, displayed
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.viewer.source import Outcome, ScanSource, SourceState

REST_S = 0.15
"""Highlights follow the camera when it has rested for so long."""
TURN = 15
"""Degrees by which a key turns the light."""
DISTANCE = 0.7
"""Of the camera that looks at the whole scan, in diagonals of its box."""
IN_THE_LIGHT = "Rendered by the Ward model in the chosen light."


class Page:
    """Draws for one client until it leaves."""

    def __init__(
        self, client: Any, source: ScanSource, light_of_file: NDArray[np.float32] | None
    ) -> None:
        """Build the page and begin to draw.

        Args:
            client: viser's ``ClientHandle``.
            source: of the scan.
            light_of_file: (H, 2 H, 3) equirectangular radiance, or None.
        """
        self._client, self._source, self._file = client, source, light_of_file
        self._panel = Panel(client.gui, light_of_file is not None)
        self._panel.reset.disabled = not source.can_rescan
        self._drawing = Drawing(client.scene)
        self._state = SourceState()
        self._shading: Shading | None = None
        self._clicked: NDArray[np.float64] | None = None
        self._vertex: int | None = None
        self._framed_from: NDArray[np.float64] | None = None
        self._wanted: set[str] = set()
        self._moved_at = 0.0
        self._changed = threading.Condition()
        self._is_open = True
        self._connect()
        self._thread = threading.Thread(target=self._draw_on, daemon=True)
        self._thread.start()

    def update(self) -> None:
        """Show the source's state, where it has changed."""
        if self._source.state() is not self._state:
            self._want("state")

    def close(self) -> None:
        """End drawing."""
        with self._changed:
            self._is_open = False
            self._changed.notify()

    def _connect(self) -> None:
        panel = self._panel
        panel.on_change([panel.mode, panel.light, panel.turn, panel.stops], self._light_changed)
        panel.on_change([panel.sky], lambda: self._want("sky"))
        panel.on_change([panel.arrows], lambda: self._want("arrows"))
        panel.on_change([panel.cameras], lambda: self._want("cameras"))
        panel.on_change([panel.keyframe], lambda: self._want("cameras", "colours"))
        panel.region.on_click(lambda _: self._ask(self._set_region))
        panel.reset.on_click(lambda _: self._ask(self._source.reset))
        panel.save.on_click(lambda _: self._ask(self._source.save))
        panel.export.on_click(lambda _: self._ask(self._export))
        for key, mode in zip("1234567890", ColourMode, strict=True):
            panel.on_key(f"Show: {mode.value}", key, partial(self._choose, mode))
        panel.on_key("Turn the light left", "J", lambda: self._turn_light(-TURN))
        panel.on_key("Turn the light right", "L", lambda: self._turn_light(TURN))
        panel.on_key("Where to look next", "N", lambda: self._toggle(panel.arrows))
        panel.on_key("Cameras", "C", lambda: self._toggle(panel.cameras))
        panel.on_key("Show the whole scan", "F", self._frame)
        self._client.scene.on_click()(self._click)
        self._client.camera.on_update(lambda _: self._camera_moved())

    def _light_changed(self) -> None:
        self._want("colours", "sky")

    def _want(self, *parts: str) -> None:
        with self._changed:
            self._wanted.update(parts)
            self._changed.notify()

    def _camera_moved(self) -> None:
        self._moved_at = time.monotonic()
        if self._panel.colour_mode is ColourMode.RENDERED:
            self._want("highlights")

    def _choose(self, mode: ColourMode) -> None:
        if mode.value in self._panel.mode.options:
            self._panel.mode.value = mode.value
            self._light_changed()

    def _turn_light(self, degrees: int) -> None:
        self._panel.turn.value = (self._panel.turn.value + degrees) % 360
        self._light_changed()

    def _toggle(self, widget: Any) -> None:
        widget.value = not widget.value
        self._want("arrows", "cameras")

    def _ask(self, wish: Any) -> None:
        """Do what was asked for and say what was done."""
        try:
            outcome: Outcome = wish()
        except ReflestError as error:
            self._client.add_notification("Not done", str(error), color="red")
            return
        for name, content in outcome.files.items():
            self._client.send_file_download(name, content)
        self._client.add_notification("Done", outcome.message, auto_close_seconds=8)

    def _set_region(self) -> Outcome:
        point, scan = self._clicked, self._state.scan
        if point is None or scan is None:
            return Outcome("click on the surface first")
        x, y, z = (point + scan.found.surface.origin).tolist()
        return self._source.set_region((x, y, z), float(self._panel.radius.value))

    def _export(self) -> Outcome:
        return self._source.export(self._panel.format.value)

    def _click(self, event: Any) -> None:
        scan = self._state.scan
        if scan is None:
            return
        hit = scan.vertex_under(np.array(event.ray_origin), np.array(event.ray_direction))
        self._vertex, self._clicked = (None, None) if hit is None else hit
        self._want("card", "arrows")

    def _draw_on(self) -> None:
        while True:
            with self._changed:
                while self._is_open and not self._wanted:
                    self._changed.wait()
                if not self._is_open:
                    return
                wanted, self._wanted = self._wanted, set()
            if "highlights" in wanted and "colours" not in wanted:
                resting = time.monotonic() - self._moved_at
                if resting < REST_S:
                    time.sleep(REST_S - resting)
                    self._want("highlights")
                    wanted.discard("highlights")
            try:
                self._draw(wanted)
            except ReflestError as error:
                self._client.add_notification("Not shown", str(error), color="red")
            except Exception:
                # The page goes on; what was wrong is not lost.
                logging.getLogger("reflest.viewer").exception("the page could not be drawn")

    def _draw(self, wanted: set[str]) -> None:
        if "state" in wanted:
            wanted |= self._take_state()
        scan, panel = self._state.scan, self._panel
        if scan is None or self._shading is None:
            return
        size = scan_size(scan)
        if wanted & {"colours", "highlights"}:
            self._draw_surface(scan, self._shading)
        if "sky" in wanted:
            light = self._light(self._shading) if panel.sky.value else None
            self._drawing.show_sky(light, scan, panel.stops.value)
        if "cameras" in wanted:
            keyframes = self._state.keyframes if panel.cameras.value else ()
            self._drawing.show_cameras(keyframes, panel.chosen_keyframe, size)
            if panel.cameras.value and not keyframes:
                self._drawing.show_eyes(scan, size)
        if "card" in wanted:
            self._drawing.show_marker(self._clicked, size)
            panel.region.disabled = self._clicked is None or not self._source.can_rescan
        if wanted & {"card", "cameras"}:
            self._write_card(scan, self._shading)
        if "arrows" in wanted:
            self._draw_arrows(scan, size)

    def _take_state(self) -> set[str]:
        """Show the progress; returns what has to be drawn again."""
        before, state = self._state, self._source.state()
        self._state, panel = state, self._panel
        panel.progress.content = text(
            f"<b>{html.escape(self._source.name)}</b><br>{html.escape(state.progress)}"
        )
        panel.bar.value = 100.0 * state.share
        panel.bar.visible = state.is_working
        panel.set_keyframes(len(state.keyframes))
        if state.scan is before.scan:
            return {"cameras"} if len(state.keyframes) != len(before.keyframes) else set()
        if state.scan is None:
            return set()
        self._shading = Shading(state.scan)
        file = () if self._file is None else (Light.FILE,)
        panel.set_choices(modes_of(state.scan), (*self._shading.lights, *file))
        if self._clicked is not None:
            distances = np.linalg.norm(state.scan.vertices - self._clicked, axis=1)
            self._vertex = int(distances.argmin())
        if self._is_camera_ours():
            self._frame()
        return {"colours", "cameras", "card", "arrows", "sky"}

    def _is_camera_ours(self) -> bool:
        """Whether the visitor has not moved the camera yet."""
        ours = self._framed_from
        return ours is None or bool(np.allclose(self._client.camera.position, ours, atol=1e-3))

    def _frame(self) -> None:
        """Look at the whole scan, from where the cameras were."""
        scan = self._state.scan
        if scan is None:
            return
        centre = scan.vertices.mean(axis=0, dtype=np.float64)
        up = np.array(scan.up) / np.linalg.norm(scan.up)
        eyes = [one.T_world_camera[:3, 3] for one in self._state.keyframes]
        if not eyes:
            surface = scan.found.surface
            eyes = list(surface.view_centres[surface.is_observing])
        towards = np.asarray(eyes[len(eyes) // 2], np.float64) - centre if eyes else np.zeros(3)
        towards -= (towards @ up) * up
        if np.linalg.norm(towards) < 1e-6:
            towards = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
        towards = towards / np.linalg.norm(towards) + 0.75 * up
        camera = self._client.camera
        self._framed_from = centre + DISTANCE * scan_size(scan) * towards / np.linalg.norm(towards)
        camera.position = self._framed_from
        camera.look_at = centre

    def _light(self, shading: Shading) -> Any:
        panel = self._panel
        file = self._file if panel.chosen_light is Light.FILE else None
        return shading.light(panel.chosen_light, float(panel.turn.value), file)

    def _draw_surface(self, scan: ShownScan, shading: Shading) -> None:
        panel, mode = self._panel, self._panel.colour_mode
        if mode is ColourMode.RENDERED:
            light = self._light(shading)
            eye = np.asarray(self._client.camera.position)
            radiance = shading.diffuse(light) + shading.mirrored(light, eye)
            colours, legend = displayed(radiance, float(panel.stops.value)), IN_THE_LIGHT
        else:
            colouring = coloured(scan, mode)
            colours, legend = colouring.colours, colouring.legend
        is_shown, chosen = None, panel.chosen_keyframe
        if chosen is not None and chosen < len(self._state.keyframes):
            is_shown = scan.first_seen <= self._state.keyframes[chosen].stamp_ns
        self._drawing.show_surface(scan, colours, is_shown)
        panel.legend.content = text(legend)

    def _write_card(self, scan: ShownScan, shading: Shading) -> None:
        panel, content = self._panel, WAITING
        material = None if self._vertex is None else scan.material_at(self._vertex)
        if self._vertex is not None and material is not None:
            plot = angle_plot(shading, self._vertex)
            content = material_card(scan, material, self._vertex, plot)
        elif self._vertex is not None:
            content = (
                "No material here yet: the surface was seen too rarely, or its part is too small. "
                "Scan more of it."
            )
        panel.card.content = text(content)
        panel.moment.content = self._moment(None if material is None else material.id)

    def _moment(self, material_id: int | None) -> str:
        """What was known at the chosen keyframe."""
        chosen, keyframes = self._panel.chosen_keyframe, self._state.keyframes
        if chosen is None or chosen >= len(keyframes):
            return ""
        one = keyframes[chosen]
        words = f"Keyframe {chosen + 1} of {len(keyframes)}, {one.stamp_ns / 1e9:.2f} s"
        if one.found is not None and material_id is not None:
            then = one.found.material(material_id)
            if then is None:
                words += "; this material was not known yet"
            else:
                rho_s = with_deviation(then.estimate.rho_s, then.estimate.rho_s_stddev)
                alpha = with_deviation(then.estimate.alpha, then.estimate.alpha_stddev)
                words += f"<br>then: rho_s {rho_s}, alpha {alpha}"
        return text(words)

    def _draw_arrows(self, scan: ShownScan, size: float) -> None:
        panel, found = self._panel, list[Suggestion]()
        if panel.arrows.value:
            shown = scan.found.materials[0].id if scan.found.materials else None
            if self._vertex is not None:
                material = scan.material_at(self._vertex)
                shown = None if material is None else material.id
            found = [] if shown is None else next_views(scan, shown)
            around = unseen_light(scan)
            found += [around] if around is not None else []
        self._drawing.show_arrows(found, size)
        words = "".join(f"<li>{one.words}</li>" for one in found) or "<li>All was seen well.</li>"
        panel.suggestions.content = text(f"<ol style='margin:0;padding-left:1.4em'>{words}</ol>")
        panel.suggestions.visible = bool(panel.arrows.value)
