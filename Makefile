# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
# make demo, test, bench, lint and docs set up what they need in .venv, and nothing outside the checkout.
# TORCH_INDEX=https://download.pytorch.org/whl/cpu keeps PyPI's CUDA build of torch away.

PYTHON ?= python3.11
TORCH_INDEX ?=
VENV := .venv
BIN := $(VENV)/bin
# Most modules of what is installed are never imported: those that are get compiled then.
PIP_INSTALL = $(BIN)/python -m pip install --disable-pip-version-check --quiet --no-compile

# Set by the ROS wheels of another environment, they would load that environment's libraries here.
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH PYTHONPATH VIRTUAL_ENV
unexport AMENT_PREFIX_PATH CMAKE_PREFIX_PATH

RUN_REQUIREMENTS := reflest_core/requirements.txt requirements/ros.txt requirements/build.txt \
	requirements/demo.txt reflest_core/requirements-viewer.txt \
	reflest_core/requirements-asset.txt
TEST_REQUIREMENTS := reflest_core/requirements-synbrdf.txt reflest_core/requirements-cluster.txt \
	reflest_core/requirements-training.txt reflest_core/requirements-completion.txt \
	requirements/test.txt
# Every package with the hashes of its files. PyTorch is pinned by its version alone: its builds have
# different files, of which TORCH_INDEX chooses.
LOCK := requirements/lock
LOCKED_INSTALL = $(PIP_INSTALL) --require-hashes --no-deps -r
TORCH := reflest_core/requirements-training.txt
UV := uv==0.13.9
ALL_REQUIREMENTS := $(RUN_REQUIREMENTS) $(TEST_REQUIREMENTS) requirements/docs.txt
INTERFACES := CMakeLists.txt package.xml setup.py pyproject.toml $(wildcard msg/*.msg srv/*.srv)

.PHONY: web-tools demo test stress bench lint docs lock set-up clean
.DEFAULT_GOAL := demo

demo: $(VENV)/run.stamp $(VENV)/interfaces.stamp $(VENV)/kernels.stamp
	$(BIN)/python -m reflest_ros.demo

test: $(VENV)/test.stamp $(VENV)/interfaces.stamp $(VENV)/kernels.stamp
	$(BIN)/python -m pytest $(PYTEST_ARGS)

# The tests of random use in their long form; an hour or more. See docs/reliability.md.
stress: $(VENV)/test.stamp $(VENV)/interfaces.stamp $(VENV)/kernels.stamp
	REFLEST_STRESS=1 $(BIN)/python -m pytest --timeout 7200 test/ros/load/test_random_use.py \
		test/ros/load/test_hostile_requests.py test/ros/load/test_flat_memory.py test/ros/load/test_soak.py \
		test/core/fusion/test_hostile_scans.py test/core/test_fuzzed_bytes.py $(PYTEST_ARGS)

bench: $(VENV)/test.stamp $(VENV)/interfaces.stamp $(VENV)/kernels.stamp
	$(BIN)/python -m benchmarks $(BENCH_ARGS)

LINTED := reflest_core reflest_ros test benchmarks launch scripts setup.py

lint: $(VENV)/test.stamp $(VENV)/interfaces.stamp
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/ament_flake8 --config .ci/ament_flake8.ini $(LINTED)

docs: $(VENV)/test.stamp
	$(BIN)/sphinx-build --fail-on-warning --keep-going -q docs build/site

set-up: $(VENV)/test.stamp $(VENV)/interfaces.stamp $(VENV)/kernels.stamp

# What the tests of exported files run in Node; they are skipped without it. The tests that look at
# glTF in a browser need Chromium too (Debian's package chromium).
web-tools:
	npm ci --no-audit --no-fund --prefix test/web

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/run.stamp: $(LOCK)/run.txt | $(BIN)/python
	$(LOCKED_INSTALL) $(LOCK)/run.txt
	touch $@

$(VENV)/test.stamp: $(LOCK)/all.txt $(TORCH) | $(BIN)/python
	$(LOCKED_INSTALL) $(LOCK)/all.txt
	$(PIP_INSTALL) $(if $(TORCH_INDEX),--extra-index-url $(TORCH_INDEX)) "$$(grep '^torch==' $(TORCH))"
	touch $(VENV)/run.stamp $@

# After a change of requirements; then scripts/licence_table.py writes docs/reference/licences.md.
lock: | $(BIN)/python
	$(PIP_INSTALL) $(UV)
	$(BIN)/uv pip compile $(LOCKING) --no-emit-package torch -o $(LOCK)/all.txt $(ALL_REQUIREMENTS)
	$(BIN)/uv pip compile $(LOCKING) -c $(LOCK)/all.txt -o $(LOCK)/run.txt $(RUN_REQUIREMENTS)

LOCKING := --quiet --generate-hashes --no-annotate --python-version 3.11 --custom-compile-command "make lock"

$(VENV)/interfaces.stamp: $(INTERFACES) | $(VENV)/run.stamp
	$(PIP_INSTALL) --no-build-isolation --no-deps --editable .
	touch $@

# Numba keeps what it compiles beside the sources, and does not notice when a kernel changes that it
# compiled into another file's: half of it old, that one may never return.
LIVE_STAGES := light surface capture fusion inference segmentation models
LIVE_SOURCES := reflest_core/jit.py $(foreach stage,$(LIVE_STAGES),\
	$(wildcard reflest_core/$(stage)/*.py reflest_core/$(stage)/*/*.py))

$(VENV)/kernels.stamp: $(LIVE_SOURCES) | $(VENV)/interfaces.stamp
	find reflest_core -name '*.nb[ci]' -delete
	$(BIN)/python -m reflest_core.estimation.warm_up
	touch $@

clean:
	rm -rf $(VENV) build install log demo-output
