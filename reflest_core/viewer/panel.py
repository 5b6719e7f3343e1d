# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The controls of one visitor's page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from reflest_core.viewer.colour_modes import ColourMode
from reflest_core.viewer.lights import Light
from reflest_core.viewer.source import FORMATS

HELP = (
    "Click on the surface to see its material. Drag to turn, right drag to move, wheel to zoom. "
    "Keys: <b>1</b> to <b>9</b> and <b>0</b> choose what is shown, <b>J</b> and <b>L</b> turn the "
    "light, <b>N</b> shows where to look next, <b>C</b> the cameras, <b>F</b> the whole scan."
)
WAITING = "Click on the surface to see what it is made of."
WIDTH = 320
"""Pixels of a panel."""
SMALLEST_RADIUS, LARGEST_RADIUS = 0.01, 1.0
"""Of a region, metres."""

Handler = Callable[[], None]


class Panel:
    """Widgets by name; values are read from them, and handlers are called in viser's threads.

    Attributes:
        mode: what the colours mean.
        legend: explains them.
        light: to show the materials in.
        turn: of the light, degrees.
        stops: exposure.
        sky: whether the light is drawn around.
        card: about the material under the click.
        radius: of a region, metres.
        arrows: whether to show where to look next.
        suggestions: these in words.
        cameras: whether to draw them.
        keyframe: up to which the scan is shown.
        moment: says which that is.
        progress: a sentence.
        bar: of the work.
        format: to export.
    """

    def __init__(self, gui: Any, has_file: bool) -> None:
        """Build the panel.

        Args:
            gui: viser's ``GuiApi`` of a client.
            has_file: whether there is a light from a file.
        """
        self._gui = gui
        self.progress = gui.add_html("")
        self.bar = gui.add_progress_bar(0.0)
        self.mode = gui.add_dropdown("Show", [mode.value for mode in ColourMode])
        self.legend = gui.add_html("")
        lights = [light.value for light in Light if has_file or light is not Light.FILE]
        with gui.add_folder("Light"):
            self.light = gui.add_dropdown("Light", lights)
            self.turn = gui.add_slider("Turn", 0, 360, 5, 0, hint="degrees about the vertical")
            self.stops = gui.add_slider("Exposure", -4.0, 4.0, 0.25, 0.0, hint="stops")
            self.sky = gui.add_checkbox("Surroundings", False, hint="draw the light around")
        with gui.add_folder("Cameras"):
            self.cameras = gui.add_checkbox("Draw them", False)
            self.keyframe = gui.add_slider("Keyframe", 0, 1, 1, 1, visible=False)
            self.moment = gui.add_html("")
        with gui.add_folder("Scan"):
            self.format = gui.add_dropdown("Format", list(FORMATS))
            self.export = gui.add_button("Export")
            self.save = gui.add_button("Save the scan")
            self.reset = gui.add_button("Begin again", color="red")
        gui.add_html(text(HELP))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        beside = gui.add_panel()
        with beside.add_tab("Material"):
            self.card = gui.add_html(text(WAITING))
            with gui.add_folder("What to do next"):
                self.arrows = gui.add_checkbox("Where to look", False, hint="arrows, best first")
                self.suggestions = gui.add_html("", visible=False)
                self.radius = gui.add_slider(
                    "Radius (m)", SMALLEST_RADIUS, LARGEST_RADIUS, 0.005, 0.1, hint="of a region"
                )
                self.region = gui.add_button(
                    "Scan only here",
                    disabled=True,
                    hint="region of interest: a sphere around the click",
                )
        beside.dock_left()
        beside.set_width(WIDTH)

    def on_change(self, widgets: Sequence[Any], handler: Handler) -> None:
        """Call a handler after a visitor changed one of some widgets.

        Args:
            widgets: of this panel.
            handler: takes nothing.
        """
        for widget in widgets:
            widget.on_update(lambda _: handler())

    def on_key(self, label: str, key: str, handler: Handler) -> None:
        """Call a handler by key or from the command palette.

        Args:
            label: in the palette.
            key: a letter or digit.
            handler: takes nothing.
        """
        command = self._gui.add_command(label, hotkey=key)
        command.on_trigger(lambda _: handler())

    @property
    def colour_mode(self) -> ColourMode:
        """The chosen mode."""
        return ColourMode(self.mode.value)

    @property
    def chosen_light(self) -> Light:
        """The chosen light."""
        return Light(self.light.value)

    def set_choices(self, modes: Sequence[ColourMode], lights: Sequence[Light]) -> None:
        """Offer what a scan has values for, and keep what is chosen where it is among that.

        Args:
            modes: at least one.
            lights: at least one.
        """
        for widget, choices in ((self.mode, modes), (self.light, lights)):
            names = tuple(choice.value for choice in choices)
            if tuple(widget.options) != names:
                chosen = widget.value
                widget.options = names
                widget.value = chosen if chosen in names else names[0]

    def set_keyframes(self, count: int) -> None:
        """Set the slider's range; at its end all of the scan is shown.

        Args:
            count: keyframes.
        """
        was_at_end = self.keyframe.value >= self.keyframe.max
        self.keyframe.max = max(count, 1)
        self.keyframe.visible = count > 0
        if was_at_end:
            self.keyframe.value = max(count, 1)

    @property
    def chosen_keyframe(self) -> int | None:
        """Index of the chosen keyframe; None for all of the scan."""
        value = int(self.keyframe.value)
        return None if not self.keyframe.visible or value >= self.keyframe.max else value


def text(content: str) -> str:
    """A paragraph with the panel's margins.

    Args:
        content: HTML.
    """
    return f"<div style='padding:.1em .85em;font-size:.87em;line-height:1.45'>{content}</div>"
