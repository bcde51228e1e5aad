# `make demo` and `make test` on a fresh clone need Python 3.11 or newer, nothing else.

PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed
DEMO := collision_m4 drive_m1 building_m2
CORES := -n auto --dist loadfile

.PHONY: install demo test lint generated bench mutants peers check-all

install: $(INSTALLED)

$(INSTALLED): pyproject.toml constraints.txt
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,lint,plot]'
	@touch $@

# other packages as rows of `wavesym chart`
peers: install
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[peers]'

demo: install
	@echo '== The three examples of the paper, against direct integration'
	$(BIN)/wavesym verify $(DEMO)
	@echo '== C and NumPy for each of them, into build/demo'
	@set -e; for scene in $(DEMO); do \
		echo "$(BIN)/wavesym generate $$scene -o build/demo/$$scene --language all"; \
		$(BIN)/wavesym generate $$scene -o build/demo/$$scene --language all; \
	done
	@echo '== Figs. 6, 7 and 8 of the paper, with what it says of them marked and judged'
	$(BIN)/wavesym plot --published -o build/demo

test: install
	$(BIN)/python -m pytest $(CORES)

lint: install
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy --strict wavesym

# what is kept in generated/, written anew; the tests compare it with what would be made now
generated: install
	rm -rf generated
	@set -e; for scene in $(DEMO); do \
		$(BIN)/wavesym generate $$scene -o generated/$$scene --language all; \
		$(BIN)/wavesym tables $$scene -o generated/$$scene/tables.csv; \
	done
	$(BIN)/wavesym verify --published --format markdown > generated/errata.md

check-all: lint
	$(BIN)/python -m pytest $(CORES) --run-slow

# speed, as ratios within one run, and the charts of the same scenes
bench: install
	$(BIN)/python -m wavesym.lab.bench bench
	@set -e; for scene in b d c; do \
		$(BIN)/wavesym chart bench/$$scene.toml -o bench/$$scene.svg --csv bench/$$scene.csv; \
	done

# which mistakes in the proofs of the bounds the tests would miss: 300 of them, within 45 minutes on 2 cores
mutants: install
	$(BIN)/python -m tests.mutation.run --write build/mutants.md
