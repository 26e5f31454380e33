# Every target makes the environment that it needs. PYTHON chooses the interpreter, VENV the environment's folder.
# OPENCV=4.8 makes an environment of its own with that version. OpenCV before 4.10 was built for NumPy 1.
PYTHON ?= python3
OPENCV ?=
VENV ?= $(if $(OPENCV),.venv-opencv-$(OPENCV),.venv)
# The environment that has all packages also serves what needs fewer.
ready = $(VENV)/ready-$(if $(wildcard $(VENV)/ready-full),full,$1)
OPENCV_PIN := $(if $(OPENCV),'opencv-contrib-python-headless==$(OPENCV).*') $(if $(filter 4.8 4.9,$(OPENCV)),'numpy<2')
BIN := $(VENV)/bin
PYTEST := $(BIN)/pytest -n auto --dist worksteal --durations=10
# The default tests, and the slow ones whose answer may differ with the version of OpenCV.
OF_OPENCV := -m 'opencv or not (slow or exhaustive)'
ROS2 ?=
SOAK_SECONDS ?= 600
SOAK_FAULTS := $(addprefix --scenario ,reboot old-schema malformed padded lossy)
FUZZ_SECONDS ?= 60
# Without the compiled modules, each program that a test starts compiles all of roverlink again.
unexport PYTHONDONTWRITEBYTECODE
# For each pip: most modules of the packages are never imported.
export PIP_COMPILE := no
RUNTIME_INTERFACES := roverlink.generator.emit.targets.python.runtime_interfaces
# Not in a new environment for each sdist and each wheel: `make test-dist` has pip build the sdists in new ones.
BUILD = $(BIN)/python -m build --no-isolation --outdir dist
# `make dist` compiles the native core for these, too, each with the cross compiler of Debian and Ubuntu.
CROSS := $(filter-out $(shell uname -m),aarch64)
# An editable install compiles the native core from these.
NATIVE := hatch_build.py native/flags $(wildcard native/include/roverlink/*.h native/src/* cpp/c/*)

.PHONY: help demo test test-all exhaustive test-vision test-ros2 test-aarch64 dist test-dist ros-package soak fuzz fuzz-native lint bench bench-vision bench-video mutation pictures generate docs docs-reference clean

help:  ## this list
	@sed -n 's/^\([a-z0-9-]*\):.*## /  make \1	/p' $(MAKEFILE_LIST)

demo: $(call ready,demo)  ## bridge all messages on loopback for 15 s, shown live
	$(BIN)/roverlink demo

test: $(call ready,$(if $(OPENCV),vision,dev))  ## the tests; OPENCV=4.8 with that version of OpenCV
	$(PYTEST) $(if $(OPENCV),$(OF_OPENCV))

test-all: $(VENV)/ready-full  ## the tests, the slow ones too, with all optional packages
	$(PYTEST) -m 'not exhaustive'

exhaustive: $(VENV)/ready-full  ## thousands of random histories, every change of the launch files, ROS 2 Kilted, an hour of datagrams; takes hours
	$(PYTEST) -m 'exhaustive or hypothesis' --hypothesis-profile exhaustive
	$(MAKE) test-ros2 ROS2=kilted
	$(MAKE) soak SOAK_SECONDS=3600

test-vision: $(call ready,vision)  ## the tests of the camera programs; OPENCV=4.8 with that version of OpenCV
	$(PYTEST) $(OF_OPENCV) rover/tests/vision rover/tests/programs/test_aruco_track.py rover/tests/programs/test_aruco_calibrate.py rover/tests/programs/test_objects_*.py rover/tests/programs/test_video.py

test-ros2:  ## the bridge against a real ROS 2 from PyPI, Jazzy and Kilted; ROS2=jazzy for one of them
	$(PYTHON) tests/ros2/run.py $(ROS2)

test-aarch64: dist  ## roverlink from its wheel on an aarch64 that QEMU emulates; needs root
	tests/aarch64/run.sh

dist: $(VENV)/ready-dist  ## build the sdists of the three products, and from them the wheels, in dist/; that of roverlink for aarch64, too
	rm -f dist/*.whl dist/*.tar.gz
	for product in . rover check_launch; do $(BUILD) $$product || exit 1; done
	@for machine in $(CROSS); do \
		if command -v $$machine-linux-gnu-g++ >/dev/null; then \
			CXX=$$machine-linux-gnu-g++ _PYTHON_HOST_PLATFORM=linux-$$machine $(BUILD) --wheel . || exit 1; \
		else echo "no wheel of roverlink for $$machine: install its compiler (apt-get install g++-$$machine-linux-gnu)"; fi; done

test-dist: dist  ## the wheel and the sdist in an empty environment and an empty folder: the three jobs of a user
	$(BIN)/python tests/distribution/smoke.py dist

ros-package: $(call ready,dev)  ## build generated/ros and rover/navigation with colcon and rosidl, which have to be installed, and use them
	$(BIN)/python tests/ros/build.py

soak: $(call ready,standard)  ## five minutes of datagrams for the sample rover, and five with all of the table switched on: each accounted for, in flat memory
	$(BIN)/roverlink simulate --bridge dds --rate 20000 --seconds $$(($(SOAK_SECONDS) / 2)) $(SOAK_FAULTS)
	$(BIN)/python tests/soak/full_project.py build/soak
	$(BIN)/roverlink simulate --project build/soak --bridge dds --rate 5000 --seconds $$(($(SOAK_SECONDS) / 2)) \
		$(SOAK_FAULTS) --scenario hostile

fuzz: $(VENV)/ready-fuzz  ## every parser of bytes from outside, a minute each
	for target in datagram trailing-zeros sample message native-payload native-message; do \
		$(BIN)/python tests/fuzz $$target -max_total_time=$(FUZZ_SECONDS) || exit 1; done

fuzz-native: $(call ready,dev)  ## both directions of the native core and its reception, each with two tables for a minute, with sanitizers; needs clang
	for door in to_cdr to_proto receive; do \
		$(BIN)/python tests/fuzz/native_core.py $$door -max_total_time=$(FUZZ_SECONDS) || exit 1; done

lint: $(VENV)/ready-full  ## ruff, black, mypy --strict, whether generated/ is what mapping.yaml says, and the numbers
	$(BIN)/ruff check .
	$(BIN)/ruff format --quiet --check --diff .
	$(BIN)/black --quiet --check --diff generated
	$(BIN)/mypy
	$(BIN)/python -m $(RUNTIME_INTERFACES) --check
	$(BIN)/roverlink generate --check
	$(BIN)/roverlink lint

bench: $(VENV)/ready-bench  ## speed, side by side with what one would otherwise do
	$(BIN)/python -m bench

bench-vision: $(VENV)/ready-bench-vision  ## marker poses and calibrations on rendered frames and photographs, beside OpenCV (OPENCV=4.8: that version)
	$(BIN)/python -m rover.bench.vision

bench-video: $(VENV)/ready-bench-video  ## video on loopback and on bad links, beside GStreamer, which has to be installed
	$(BIN)/python -m rover.bench.video

mutation: $(VENV)/ready-full  ## small faults in a sample of places: how many of them the tests notice
	$(BIN)/python -m bench.mutation

pictures: $(VENV)/ready-bench-vision  ## the pictures and the recording in rover/docs, and the pictures of docs/operations.md (with Chromium)
	$(BIN)/python -m rover.bench.vision.pictures
	$(BIN)/python -m rover.bench.vision.page_pictures
	$(BIN)/python -m bench.link_page_pictures

generate: $(call ready,standard)  ## compile mapping.yaml, and write the classes of runtime/interfaces
	$(BIN)/python -m $(RUNTIME_INTERFACES)
	$(BIN)/roverlink generate

docs: $(call ready,docs)  ## build the documentation site in build/site; fails on dead links
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "open build/site/index.html in a browser"

docs-reference: $(call ready,standard)  ## write the reference tables in docs/ from the code: keys, parameters, rules
	$(BIN)/python docs/site/committed_tables.py

clean:  ## remove what was made here, the environment included
	rm -rf $(VENV) .ros2 .aarch64 build/* dist/*.whl dist/*.tar.gz .mypy_cache .pytest_cache .ruff_cache .hypothesis

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "roverlink needs Python 3.10 or newer; try: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 2; }
	@echo "creating the environment $(VENV) with $(PYTHON)"
	@$(PYTHON) -m venv $(VENV) || \
		{ rm -rf $(VENV); echo "$(PYTHON) cannot make environments; on Debian and Ubuntu: apt-get install python3-venv"; exit 2; }

# What each environment needs, and its size on the disk in megabytes.
$(VENV)/ready-standard: PACKAGES = '.[standard]'
$(VENV)/ready-standard: SIZE = 200
$(VENV)/ready-demo: PACKAGES = '.[standard]' './rover[detect,video]'
$(VENV)/ready-demo: SIZE = 650
$(VENV)/ready-dev: PACKAGES = '.[dev]' './rover[vision]' ./check_launch
$(VENV)/ready-dev: SIZE = 550
$(VENV)/ready-full: PACKAGES = '.[full]' './rover[train,fusion,video]' ./check_launch
$(VENV)/ready-full: SIZE = 1700
$(VENV)/ready-vision: PACKAGES = '.[dev]' './rover[detect,video]' ./check_launch
$(VENV)/ready-vision: SIZE = 950
$(VENV)/ready-docs: PACKAGES = '.[docs]' ./rover ./check_launch
$(VENV)/ready-docs: SIZE = 200
$(VENV)/ready-fuzz: PACKAGES = '.[fuzz]'
$(VENV)/ready-fuzz: SIZE = 150
$(VENV)/ready-bench: PACKAGES = '.[bench]' ./rover
$(VENV)/ready-bench: SIZE = 450
$(VENV)/ready-bench-vision: PACKAGES = '.[bench]' './rover[detect]'
$(VENV)/ready-bench-vision: SIZE = 850
$(VENV)/ready-bench-video: PACKAGES = '.[bench]' './rover[video]'
$(VENV)/ready-bench-video: SIZE = 750

$(VENV)/ready-dist: | $(VENV)/bin/python
	@echo "installing build and hatchling in $(VENV)"
	@$(BIN)/python -m pip install --disable-pip-version-check build hatchling
	@touch $@

# Not --quiet: pip shows the progress of each download.
$(addprefix $(VENV)/,ready-standard ready-demo ready-dev ready-full ready-vision ready-docs ready-fuzz ready-bench ready-bench-vision ready-bench-video): pyproject.toml rover/pyproject.toml check_launch/pyproject.toml $(NATIVE) | $(VENV)/bin/python
	@echo "installing in $(VENV): about $(SIZE) MB on the disk; the first time, this can take minutes"
	@$(BIN)/python -m pip install --disable-pip-version-check $(addprefix --editable ,$(PACKAGES)) $(OPENCV_PIN)
	@touch $@
