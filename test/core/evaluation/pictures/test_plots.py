# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Plots and pictures of an evaluation show its records' numbers."""

import cv2
import numpy as np

from reflest_core.brdf import srgb
from reflest_core.evaluation import parts
from reflest_core.evaluation.pictures.rendered_shapes import SIZE
from test.core.evaluation.results import FIGURES, read


def test_plots_show_the_records_numbers(out):
    record = read(out, "views")
    for axes, split in zip(FIGURES["views"].axes, record["scenes"], strict=True):
        drawn = {line.get_label(): line.get_ydata() for line in axes.lines[:-1]}
        for curve in record["curves"]:
            if curve["split"] == split:
                assert list(drawn[curve["network"]]) == curve["rmse"]
    for axes, of in zip(
        FIGURES["calibration"].axes, read(out, "calibration")["splits"].values(), strict=True
    ):
        for column, line in enumerate(axes.lines[1:]):
            np.testing.assert_array_equal(line.get_ydata(), np.array(of["observed"])[:, column])
            np.testing.assert_array_equal(line.get_xdata(), of["levels"])
    rows = read(out, "table-2")["rows"]
    titles = list(dict.fromkeys(row["title"] for row in rows))
    (axes,) = FIGURES["variants"].axes
    assert [label.get_text() for label in axes.get_yticklabels()] == titles
    by_label = dict(zip(("validation", "unseen"), axes.containers, strict=True))
    for split, container in by_label.items():
        assert list(container.lines[0].get_xdata()) == [
            row["accuracy"]["ward"]["overall"] for row in rows if row["split"] == split
        ]


def test_the_scatter_plot_shows_the_best_networks_estimates(out):
    rows = [row for row in read(out, "table-2")["rows"] if row["split"] == "validation"]
    best = min(rows, key=lambda row: row["accuracy"]["ward"]["overall"])["variant"]
    figure = FIGURES["scatter"]
    assert figure.get_suptitle() == best
    made = read(out, "estimates")["unseen"]
    alpha = figure.axes[-1].collections[0].get_offsets()
    np.testing.assert_array_equal(alpha[:, 0], np.array(made["truths"])[:, 4])
    np.testing.assert_array_equal(alpha[:, 1], np.array(made["networks"][best]["ward"])[:, 4])


def test_the_contact_sheet_shows_truth_and_estimates_in_their_rows(out):
    (axes,) = FIGURES["contact-sheet"].axes
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["truth", *read(out, "estimates")["validation"]["networks"]]
    sheet = np.asarray(axes.images[0].get_array())
    made, validation = read(out, "perception"), read(out, "estimates")["validation"]
    assert sheet.shape == (SIZE * len(labels), 2 * SIZE * made["materials"], 3)
    # Diffuse spheres are nearly proportional to rho_d: rows follow their own material's colour.
    drawn = np.random.default_rng(parts.RENDERED_SEED).permutation(len(validation["truths"]))[:3]
    wards = [validation["truths"], *(of["ward"] for of in validation["networks"].values())]
    for row, ward in enumerate(wards):
        for column, index in enumerate(drawn):
            block = sheet[
                SIZE * row : SIZE * (row + 1), 2 * SIZE * column : 2 * SIZE * column + SIZE
            ]
            middle = srgb.decode(block[SIZE // 3 : -SIZE // 3, SIZE // 3 : -SIZE // 3])
            shown = middle.reshape(-1, 3)
            # Under one light pictures of two materials are equal only where the materials are.
            truth_block = sheet[:SIZE, 2 * SIZE * column : 2 * SIZE * column + SIZE]
            is_same = np.allclose(ward[index], validation["truths"][index], atol=1e-6)
            assert np.allclose(block, truth_block) == is_same
            assert shown.min() >= 0.0
            assert shown.max() > 0.0
    assert (
        cv2.imread(str(out / "contact-sheet.png")).shape[1]
        > cv2.imread(str(out / "contact-sheet.png")).shape[0] / 10
    )


def test_pictures_of_failures_show_view_light_truth_and_estimate(out):
    found = read(out, "failures")["failures"]
    for number, failure in enumerate(found, start=1):
        panels = FIGURES[f"failures/{number:02d}"].axes
        titles = ["a view", "light (dim: not seen)", "truth", "estimate"]
        assert [panel.get_title() for panel in panels] == titles
        view, light, truth, estimate = (np.asarray(panel.images[0].get_array()) for panel in panels)
        assert view.shape == (36, 48, 3)
        assert light.shape == (96, 192, 3)
        brighter = np.array(failure["truth"][:3]).mean() > np.array(failure["estimate"][:3]).mean()
        if abs(np.mean(failure["truth"][:3]) - np.mean(failure["estimate"][:3])) > 0.1:
            assert (truth.mean() > estimate.mean()) == brighter
