#!/usr/bin/env bash
# Gradescope runs this once, when it builds the image of the assignment.
set -euo pipefail
apt-get update && apt-get install -y --no-install-recommends python3-pip
pip3 install --break-system-packages uv || pip3 install uv
export UV_PYTHON_INSTALL_DIR=/opt/python # programs of students run as users who can read it
uv venv --python 3.12 /opt/harness
wheels=(/autograder/source/*.whl)
if [ -f "${wheels[0]}" ]; then wheel="${wheels[0]}"; else wheel="armharness==@VERSION@"; fi
uv pip install --python /opt/harness/bin/python "$wheel"
