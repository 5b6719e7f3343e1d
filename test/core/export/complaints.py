# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the validators of USD object to in a stage."""

import re

from pxr import UsdValidation


def complaints(stage):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 10
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    messages = [error.GetMessage() for error in errors]
    # The wheel of USD has no MaterialX plug-in; MaterialX itself checks these nodes below.
    return [one for one in messages if not re.search(r"'ND_\w+' .* not found in sdrRegistry", one)]
