#!/usr/bin/env bash
# Gradescope runs this once, when it builds the image of the assignment.
# AUTOGRADER and INSTALLED are for a trial on another machine; see README.md.
set -euo pipefail
autograder="${AUTOGRADER:-/autograder}" installed="${INSTALLED:-/opt}"
if ! command -v uv; then
  apt-get update && apt-get install -y --no-install-recommends python3-pip
  pip3 install --break-system-packages uv || pip3 install uv
fi
export UV_PYTHON_INSTALL_DIR="$installed/python" # programs of students run as users who can read it
uv venv --python "${UV_PYTHON:-3.12}" "$installed/harness"
wheels=("$autograder"/source/*.whl)
if [ -f "${wheels[0]}" ]; then wheel="${wheels[0]}"; else wheel="armharness==@VERSION@"; fi
uv pip install --python "$installed/harness/bin/python" "$wheel"
