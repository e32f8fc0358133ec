# Short names for those who have make; the README's commands need none.
PYTHON ?= python3

.PHONY: demo test lint nightly bench docs site pictures

demo: .venv/.installed
	.venv/bin/harness run scenarios/lessons/03_ur_sixteen_steps.scenario.yaml

test: .venv/.installed
	.venv/bin/python -m pytest -n auto

lint: .venv/.installed
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/pyright --pythonpath .venv/bin/python
	.venv/bin/lint-imports

nightly:
	.ci/nightly

bench: .venv/.installed
	.venv/bin/python -m pytest -m benchmark -s

docs: .venv/.installed
	.venv/bin/python -m docs.generate
	.venv/bin/python -m tests.adversarial.table

site: .venv/.installed
	.venv/bin/python -m sphinx -q -W --keep-going -b html -c docs . build/site

# Longer: runs the scenes and lessons that the pictures show.
pictures: .venv/.installed
	.venv/bin/python -m docs.generators.expectation_pictures
	.venv/bin/python -m docs.generators.gallery

.venv/.installed: pyproject.toml
	$(PYTHON) -m venv .venv
	.venv/bin/pip install -q -e '.[dev]'
	touch $@
