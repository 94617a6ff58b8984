# make report     set everything up, solve the quick campaign, write its pages into .footprint/pages/quick
# make standard   the same for the standard campaign (70 minutes on two cores), and all of reports/pages
# make docs       build the documentation into .footprint/site; make dist: wheel and sdist, checked, into dist
# make test       set everything up, run the tests one waits for; make slow: the others
PYTHON ?= python3
VENV   ?= .venv
STORE  ?= .footprint/store
# of the quick campaign: every page says when and where it was solved, so the committed ones (reports/pages/quick) are
# made anew on purpose, by PAGES=reports/pages
PAGES  ?= .footprint/pages
SITE   ?= .footprint/site
BIN    := $(VENV)/bin
ADVICE := studies/analysis/advice
READY  := $(VENV)/.ready
JOBS   ?= 2
ENGINE ?= local:$(JOBS)
# one BLAS thread per process: the matrices are small, and JOBS processes share the cores
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
# what is compiled is kept: to rewrite the assertions of all tests anew takes each worker six seconds
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report standard advice test slow lint check bench docs dist clean

report: $(READY)
	$(BIN)/footprint run quick --store $(STORE) --engine $(ENGINE)
	$(BIN)/footprint analyse quick --store $(STORE)
	$(BIN)/footprint report --store $(STORE) --campaign quick --out $(PAGES)/quick

standard: $(READY)
	$(BIN)/footprint run standard --store $(STORE) --engine $(ENGINE)
	$(BIN)/footprint run fuzz --seeds 0:2000 --store $(STORE) --engine $(ENGINE) || test $$? -eq 1  # its findings are on the page
	$(BIN)/footprint analyse standard --store $(STORE)
	$(BIN)/footprint report --store $(STORE) --campaign standard

# what `footprint advise` answers from where there is no store: the tables of a standard campaign
advice:
	cp $(foreach name,advice_cells advice_questions held_out_summary,$(STORE)/tables/$(name).csv) $(ADVICE)

test: $(READY)
	$(BIN)/pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder -m "not slow"

slow: $(READY)
	$(BIN)/pytest -n $(JOBS) --dist loadfile -m slow

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# everything: lint, types, all tests, and a fresh quick campaign against the committed baseline and pages
check: lint test slow
	$(BIN)/footprint run quick --store $(STORE) --engine $(ENGINE)
	$(BIN)/footprint analyse quick --store $(STORE)
	$(BIN)/footprint check --store $(STORE)
	$(BIN)/footprint report --store $(STORE) --campaign quick --check

bench: $(READY)
	$(BIN)/footprint bench

# offline once its extra is installed; strict: a dead link or a name without its place fails (not under --quiet)
docs: $(VENV)/.docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --config-file .github/mkdocs.yml --site-dir $(abspath $(SITE))

dist: $(READY)
	rm -rf dist
	$(BIN)/python -m hatchling build -d dist
	DIST=dist $(BIN)/pytest -q tests/test_wheel.py

$(VENV)/.docs: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[docs]'
	touch $@

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "footprint needs Python 3.11 or newer: make PYTHON=/path/to/python3.11"; exit 2; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) .footprint .mypy_cache .pytest_cache .ruff_cache
