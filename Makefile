# The front door: every job is a target. `make` alone lists them.

PYTHON ?= python3
VENV ?= .venv
SITE ?= build/site

# What a user gives. Recipes read it from the environment, as "$$SCENE", and never as text that make
# puts in: so no character of it is special, neither to make, which would expand a $ on the way, nor
# to the shell. Only whether it is given may be asked of make: $(if $(value BLOCK),...).
COMMAND_LINE := $(foreach name,$(.VARIABLES),$(if $(filter command,$(origin $(name))),$(name)))
# An outer make passes on variables of its own, which need not be known here.
export NAMED := $(if $(filter 0,$(MAKELEVEL)),$(COMMAND_LINE))
export GOALS := $(MAKECMDGOALS)
export PYTHON VENV SITE
$(foreach name,$(COMMAND_LINE),$(eval override $(name) := $$(value $(name)))$(eval export $(name)))

comma := ,
# With DRY=1 a command checks what it is given and says what it would do; make's own commands too.
DRY_RUN := $(filter-out 0,$(value DRY))
# $(1): what a recipe would do; $(2): how.
own = @$(if $(DRY_RUN),echo "DRY=1: nothing done; would $(1)",$(2))

# $(1): several commands. A signal that make passes on reaches only the shell of a recipe, so what takes its place ends them.
ends = exec $(RUN) -m tactus.cli.commands shell '$(subst ','\'',$(1))'

# $(1): a variable that names a folder which is removed; $(2): a file by which it is known.
mine = if [ -e "$$$(1)" ] && ! [ -e "$$$(1)/$(2)" ]; then \
	echo "error: $(1)=$$$(1): is there already, and has no $(2), so it may be yours" >&2; exit 2; fi
# Where a recipe is one call, exec lets a signal that make passes on reach it, and not a shell before it.
RUN := "$$VENV/bin/python"
# A target by a name of its own: the path of the environment may hold what is special in one of make's.
READY := ready

# The commands whose module tactus/core/commands.toml names, and which pass to it what they are given.
CALLED := $(shell awk -F'[][]' '/^\[/ {name = $$2} /^module/ {print name}' tactus/core/commands.toml)

.PHONY: $(CALLED) named help test study docs pages lint clean tools browser ready

help docs pages lint clean tools browser ready: named

# The table of commands is TOML, which Python 3.10 cannot read: where an environment is ready, it reads it.
reader = if [ -e "$$VENV/.ready" ] && [ -x $(RUN) ]; then exec $(RUN) -m tactus.cli.commands $@; fi
right_python = "$$PYTHON" -c "import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))" || \
	{ echo "error: $$PYTHON is $$("$$PYTHON" -V), expected Python 3.11 to 3.13; set PYTHON=" >&2; exit 2; }

# A variable that no target here takes is most likely misspelt, and must not be ignored.
named:
	@$(reader); ! command -v "$$PYTHON" >/dev/null || { $(right_python); exec "$$PYTHON" -m tactus.cli.commands named; }

.DEFAULT:
	@echo "error: make $$GOALS: no such target; make lists them" >&2; exit 2

# What is wanted, and of whom, is said once, in tactus/core/commands.toml, which needs no environment for this.
help:
	@$(reader); exec "$$PYTHON" -m tactus.cli.commands help

demo report mutate certify: $(if $(DRY_RUN),,tools)

$(CALLED): $(READY)
	@exec $(RUN) -m tactus.cli.commands $@

study: $(READY)
	@exec $(RUN) -m studies "$$NAME" $(if $(filter-out 0,$(value RECORD)),--record)

test: $(READY) $(if $(DRY_RUN),,tools browser)
	@exec $(RUN) tests/chosen.py $(if $(value BLOCK),--block="$$BLOCK") $(if $(filter-out 0,$(value PAGES)),--pages) \
		--tests="$$TESTS" $(if $(filter-out 0,$(value ALL)),--all)

# Built anew, so that no page is left that is gone from the source, and renamed when it is whole.
SPHINX = $(RUN) -m sphinx -q -W --keep-going -d "$$SITE.doctrees" docs

docs: $(READY)
	$(call own,build $$SITE,$(call ends,set -e; \
		$(call mine,SITE,index.html); \
		rm -rf -- "$$SITE.new" "$$SITE.doctrees"; \
		$(SPHINX) "$$SITE.new"; \
		$(if $(filter-out 0,$(value LINKS)),$(SPHINX) -b linkcheck "$$SITE.links";) \
		rm -rf -- "$$SITE" "$$SITE.doctrees" "$$SITE.links"; \
		mv -- "$$SITE.new" "$$SITE"; \
		printf 'wrote %s/index.html\n' "$$SITE"))

# What stands between markers in the pages: ports and clocks that the twins publish, recorded cells.
pages: $(READY)
	$(call own,write what is generated in the documentation,$(call ends,set -e; \
		$(RUN) -m tactus.report.page.lists))

lint: $(READY)
	$(call own,run ruff$(comma) import-linter and mypy,$(call ends,$(RUN) -m ruff check . && $(RUN) -m ruff format --check . && \
		"$$VENV/bin/lint-imports" --no-cache --no-logo && $(RUN) -m mypy))

clean:
	$(call own,remove build and $$VENV,$(call mine,VENV,pyvenv.cfg); rm -rf build "$$VENV")

# Simulators and what Debian's own Python lacks. As root, or where sudo asks no password, they are
# installed; elsewhere the command to run is printed.
tools:
	@missing=; \
	command -v ghdl >/dev/null || missing="$$missing ghdl-llvm"; \
	command -v iverilog >/dev/null || missing="$$missing iverilog"; \
	$(call install,$$missing)

# The report's test looks at it in a browser.
browser:
	@missing=; \
	command -v chromium >/dev/null || missing="$$missing chromium"; \
	$(call install,$$missing)

# For x86-64 every package comes compiled; elsewhere pip compiles cocotb.
is_ready = if [ -e "$$VENV/.ready" ] && ! [ pyproject.toml -nt "$$VENV/.ready" ]; then exit 0; fi; set -e
ready:
	@$(is_ready); \
	missing=; \
	command -v "$$PYTHON" >/dev/null || missing="$$missing python3"; \
	"$$PYTHON" -c "import ensurepip" 2>/dev/null || missing="$$missing python3-venv"; \
	test "$$(uname -m)" = x86_64 || command -v g++ >/dev/null || missing="$$missing g++ python3-dev"; \
	{ $(call install,$$missing); } || exit 2; \
	$(right_python); \
	exec "$$PYTHON" -m tactus.cli.set_up "$$VENV"
	@$(is_ready); \
	missing=; \
	test -n "$$($(RUN) -m find_libpython)" || \
		missing="libpython$$($(RUN) -c 'import sys; print("%d.%d" % sys.version_info[:2])')"; \
	{ $(call install,$$missing); } || exit 2; \
	touch "$$VENV/.ready"

# $(1): packages, maybe none.
define install
if [ -n "$(1)" ]; then \
	if [ "$$(id -u)" = 0 ]; then as=; elif sudo -n true 2>/dev/null; then as="sudo -n"; else \
		echo "error: not installed:$(1); run: sudo apt-get install$(1)" >&2; exit 2; fi; \
	command -v apt-get >/dev/null || \
		{ echo "error: not installed:$(1); install with your system's package manager" >&2; exit 2; }; \
	echo "installing$(1)"; \
	$$as apt-get update -q && \
	$$as env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $(1); \
fi
endef
