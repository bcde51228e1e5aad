# `make demo` and `make test` on a fresh clone need Python 3.11 or newer, nothing else.

PYTHON ?= python3
BIN := .venv/bin
# the commands that tests and the demo start are compiled once, whatever the environment says
export PYTHONDONTWRITEBYTECODE :=
# tells every minute that a command is still at work
TOLD := sh -c 'while for second in $$(seq 60); do sleep 1 && kill -0 $$$$ || exit; done > /dev/null; do \
	echo "   ... at work"; done 2> /dev/null & "$$@"; status=$$?; kill $$! 2> /dev/null; exit $$status' told
# modules are compiled when they are first imported: most of what is installed never is
PIP := $(TOLD) $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt -e
# a C compiler as a package, only where this machine has none
HAS_COMPILER := $(shell command -v cc || command -v gcc || command -v clang)
NEEDED := $(if $(HAS_COMPILER),plot,plot compiler)
COMMA := ,
DEMO := collision_m4 drive_m1 building_m2
CORES := -n auto --dist loadfile

.PHONY: install demo test lint generated published examples bench docs wheel prove misra targets fuzz mutants check-all

# what running and plotting need; `make test` and `make lint` add what they need
install: .venv/.installed

.venv/.installed: pyproject.toml constraints.txt
	@echo '== Python packages into .venv, for running and plotting: half a minute'
	@$(TOLD) $(PYTHON) -m venv --clear .venv
	@$(PIP) '.[$(subst $() ,$(COMMA),$(NEEDED))]'
	@touch $@

.venv/.test .venv/.lint .venv/.check .venv/.docs: .venv/.%: .venv/.installed
	@echo '== Python packages into .venv, for `make $*`'
	@$(PIP) '.[$*]'
	@touch $@

# all that is compared of a scene is kept as text; what `generate` chose, pieces in C, is one of its rows
demo: install
	@echo '== The three examples of the paper, each program against direct integration; C and NumPy: half a minute'
	@mkdir -p build/demo
	@set -e; for scene in $(DEMO); do \
		to=build/demo/$$scene; \
		$(BIN)/wavesym generate $$scene -o $$to --language all > build/demo/log 2>&1 || { cat build/demo/log; exit 1; }; \
		$(TOLD) $(BIN)/wavesym verify $$scene -o $$to/verify.txt || { grep FAIL $$to/verify.txt; exit 1; }; \
		awk -F '  +' -v scene=$$scene '/ PASS$$/ { passed++ } $$2 == "pieces, C" { error = $$4; bound = $$(NF - 1) } \
			END { printf "   %-13s %d comparisons passed; the C errs by %s, proved below %s\n", scene, passed, error, bound }' \
			$$to/verify.txt; \
	done
	@echo '== Its figures 6, 7 and 8, with what it says of them judged: half a minute'
	@$(TOLD) $(BIN)/wavesym plot --published -o build/demo > /dev/null
	@echo '== Done. In build/demo are now'
	@echo '   figures.html              to look at first: figures 6, 7 and 8 of the paper, beside what it says of them'
	@echo '   NAME/ for each example    C, NumPy, a self-test, a manifest, and verify.txt: all that was compared'
	@echo '== What to do next'
	@echo '   $(BIN)/wavesym init frame > mine.toml          a scene of your own to start from, with comments'
	@echo '   $(BIN)/wavesym report mine.toml -o mine.html   one page: histories, extremes, frequencies'
	@echo '   $(BIN)/wavesym generate mine.toml              its C'
	@echo '   docs/guide.md                                     all else, step by step'

test: .venv/.test
	$(BIN)/python -m pytest $(CORES)

lint: .venv/.lint
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy --strict wavesym tools

# what is kept in generated/, written anew; the tests compare it with what would be made now
generated: install
	rm -rf generated
	@set -e; for scene in $(DEMO); do \
		$(BIN)/wavesym generate $$scene -o generated/$$scene --language all; \
		$(BIN)/wavesym tables $$scene -o generated/$$scene/tables.csv; \
	done
	$(BIN)/wavesym verify --published --format markdown > generated/errata.md

# docs/published.md: what others printed, beside what is computed
published: install
	$(BIN)/python -m tools.published_numbers

# the pictures of examples/, drawn anew by the commands of their pages
examples: install
	@set -e; PATH="$(CURDIR)/$(BIN):$$PATH"; for page in examples/*/README.md; do \
		( cd $$(dirname $$page) && grep '^wavesym plot' README.md | $(TOLD) sh -e ); \
	done

check-all: lint .venv/.test .venv/.check
	$(BIN)/python -m pytest $(CORES) --run-slow

# speed, as ratios within one run, and the charts of the same scenes
bench: export OMP_NUM_THREADS := 1
bench: install
	$(BIN)/python -m tools.bench bench
	@set -e; for scene in b d c l r; do \
		$(BIN)/wavesym chart bench/$$scene.toml -o bench/$$scene.svg --csv bench/$$scene.csv; \
	done
	$(BIN)/python -m tools.front_page

# the site, into build/site: open build/site/index.html
docs: .venv/.docs
	$(BIN)/python -m tools.site
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# what `pip install` takes, into dist
wheel: install
	$(BIN)/python -m pip wheel --disable-pip-version-check --quiet --no-deps -w dist .

# what a prover, a checker of rules and other machines say of generated C, into its tables; skipped where they are not;
# the prover looks at the programs that the variable PROGRAMS names, or at all
prove: install
	@$(TOLD) $(BIN)/python -m tools.portable $@ docs/portability.md $(PROGRAMS)

misra: install
	@$(TOLD) $(BIN)/python -m tools.portable $@ docs/portability.md

targets: .venv/.check
	@$(TOLD) $(BIN)/python -m tools.portable $@ docs/portability.md

# generated C under a fuzzer and sanitizers, so many seconds each program, two at a time; skipped where there is none
SECONDS ?= 10
fuzz: install
	@$(TOLD) $(BIN)/python -m tools.portable $@ docs/portability.md $(SECONDS)

# which mistakes in the proofs of the bounds the tests would miss: 300 of them, within 45 minutes on 2 cores
mutants: .venv/.test
	$(BIN)/python -m tests.mutation.run --write build/mutants.md
