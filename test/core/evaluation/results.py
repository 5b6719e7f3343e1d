# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reading the results of an evaluation: its records, the tables of its page, its figures."""

import json

FIGURES = {}
"""Every figure that the evaluation saved, by file name without suffix."""


def read(out, name):
    """A record of the results in ``out``."""
    return json.loads((out / f"{name}.json").read_text())


def rows_of(out, heading, first_column):
    """Rows of the tables in the page's section ``heading``, each a list of (column, cell).

    Only tables whose first column has that name; cells are text, as they stand on the page.
    """
    page = (out / "index.md").read_text()
    section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows, header = [], None
    for line in section.splitlines():
        if not line.startswith("|"):
            header = None
            continue
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if header is None:
            header = cells
        elif header[0] == first_column and not line.startswith("|---"):
            rows.append(list(zip(header, cells, strict=True)))
    return rows


def three(values):
    """As the page writes numbers."""
    return [f"{value:.3f}" for value in values]
