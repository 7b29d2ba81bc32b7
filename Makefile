# The README's commands. Each sets up `.venv` by itself, the first time it is needed.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := .venv/bin
READY := .venv/.ready

.PHONY: demo test lint format bench docs lock clean

demo: $(READY)  ## the paper's running example: three sentences, a command, a knife passed by the blade
	@$(BIN)/hilt demo

test: $(READY)  ## the whole test suite
	@$(BIN)/pytest -n auto --dist loadfile

lint: $(READY)  ## format, lint and types, as the gate checks them
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .
	@$(BIN)/pyright

format: $(READY)  ## put the code into shape
	@$(BIN)/ruff format .
	@$(BIN)/ruff check --fix .

bench: $(READY)  ## speed, beside named peers where there are any
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[bench]"
	@$(BIN)/pytest benchmarks --benchmark-only

docs: $(READY)  ## write the page of commands anew
	@$(BIN)/python -m hilt.agent.cli.reference > docs/commands.md

lock: $(READY)  ## renew requirements.lock from pyproject.toml
	@$(BIN)/pip install --quiet uv
	@$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.10 --extra all --extra dev \
		--no-emit-index-url --no-header pyproject.toml -o requirements.lock

clean:  ## remove what was built, but no knowledge base
	rm -rf .venv build dist out *.egg-info

$(READY): requirements.lock pyproject.toml
	@echo "Setting up .venv with $(PYTHON) (about a minute the first time) ..."
	@$(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@
