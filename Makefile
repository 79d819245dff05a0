# The front door: every job is a target. `make` alone lists them.

# make mutate takes no scene unless one is given.
SCENE_CHOSEN := $(findstring command line,$(origin SCENE))
# What a board is asked for takes another than the default, which has no serial line.
ON_BOARD := $(if $(filter-out undefined,$(origin SCENE)),"$$SCENE",digit-board)
SCENE ?= digit
RIG ?= digit
SEED ?= 1
PYTHON ?= python3
VENV ?= .venv
SITE ?= build/site

# What a user may give. Recipes read it from the environment, as "$$SCENE", and never as text that
# make puts in: so no character of it is special, neither to make, which would expand a $ on the
# way, nor to the shell. Only whether it is given may be asked of make: $(if $(BLOCK),...).
GIVEN := ALL BAUD BESIDE BLOCK BOARD CLUSTER CSV DEVICE FRAMES FULL HARDWARE LABELS LINKS MACHINE NETLIST ONLY OUTPUT OUTPUTS PORT PYTHON \
	RECORD RIG SCENE SEED SIM SITE TABLE TESTS TO VENV WAVES WHOLE
literal = $(if $(value $(1)),$(eval override $(1) := $$(value $(1)))$(eval export $(1)))
$(foreach name,$(GIVEN),$(call literal,$(name)))

RUN := "$$VENV/bin/python"
# A target by a name of its own: the path of the environment may hold what is special in one of make's.
READY := ready

.PHONY: help demo test machines sim vhdl verilog scene check train recalibrate predict network image monitor record load bench listing activations figures sensors lean synth bitstream peers prove mutate coverage report docs pages lint clean tools browser ready

help:
	@echo "make demo    [SCENE=] [FULL=1]            a scene end to end: simulate, export, table of errors"
	@echo "make test    [TESTS=tests/test_x.py] [ALL=1] [MACHINE=name]"
	@echo "                                          the tests, or some; ALL=1 every constant; MACHINE= as elsewhere"
	@echo "make machines [ONLY=name] [TESTS=] [WHOLE=1] [ALL=1]"
	@echo "                                          the tests that other machines may change, as on each; WHOLE=1 all"
	@echo "make sim     [BLOCK=] [SIM=ghdl|icarus] [SCENE=] [SEED=] [WAVES=1] [FRAMES=]"
	@echo "                                          one bench, or every bench of the scene"
	@echo "             NETLIST=virtex-2|series-7|ecp5|ice40|unknown [RECORD=1]"
	@echo "                                          on the cells of a family (1: of each), or on registers that are"
	@echo "                                          unknown until they are written; RECORD=1 records it of every block"
	@echo "make vhdl    [SCENE=]                     export to build/<scene>/vhdl"
	@echo "make verilog [SCENE=]                     export to build/<scene>/verilog"
	@echo "make scene   CSV=readings.csv OUTPUTS=a,b [TO=my-rig.toml] [HARDWARE=scene]"
	@echo "                                          a scene for your own readings, and what they show; HARDWARE= whose board read them"
	@echo "make check   [SCENE=]                     what can be wrong with a scene, in seconds"
	@echo "make train   [SCENE=] [CLUSTER=]          train the scene's networks, write them beside it"
	@echo "make recalibrate [SCENE=] [CSV=placements.csv] [TO=folder]"
	@echo "                                          gain and offset of each sensor from known placements; without any,"
	@echo "                                          those that tell most"
	@echo "make predict CSV=new.csv TO=out.csv [SCENE=]"
	@echo "                                          the hardware's outputs for new readings, and which are unlike any"
	@echo "make network TO=file.onnx [SCENE=] [OUTPUT=]"
	@echo "                                          write a network of the scene as .npz, .mat or .onnx"
	@echo "make image   [SCENE=] [HARDWARE=scene]    what makes an engine that can be reloaded run the scene"
	@echo "make monitor PORT=/dev/ttyUSB0, twin or sim [SCENE=] [HARDWARE=scene] [TO=all.csv] [BAUD=]"
	@echo "                                          what a board sends, in the browser; twin, sim: a simulated board"
	@echo "make record  PORT=/dev/ttyUSB0 TO=readings.csv [SCENE=] [LABELS=placements.csv] [FRAMES=]"
	@echo "                                          readings of known placements from a board, as make scene takes them"
	@echo "make load    PORT=/dev/ttyUSB0 [SCENE=] [HARDWARE=scene]"
	@echo "                                          the scene's image to a board, until it runs there"
	@echo "make bench   [SCENE=] [FRAMES=]           speed and memory of the bit-true twin"
	@echo "make listing [SCENE=]                     the program of an engine, step by step"
	@echo "make activations                          errors of every activation against tanh, and their plots"
	@echo "make figures [TABLE=] [SEED=] [RECORD=1]  measured figures beside the thesis', in build/figures"
	@echo "make sensors [RIG=my-beam.toml]           where gauges on a beam should sit, with picture and table"
	@echo "make lean    [SCENE=] [BESIDE=other] [RECORD=1]"
	@echo "                                          what a scene leaves out, and what that saves; RECORD=1 keeps it beside the scene"
	@echo "make synth   [SCENE=] [RECORD=1]          cells of every block, clock, both beside the thesis; budget"
	@echo "make bitstream BOARD=ulx3s [SCENE=] [DEVICE=] [RECORD=1]"
	@echo "                                          a file to program a board with; what it takes of its device"
	@echo "make peers   [SEED=]                      other projects' hardware for the same weights, beside ours"
	@echo "make prove   [BLOCK=] [RECORD=1]          what is proved of every block, and that broken copies refute it"
	@echo "make mutate  [BLOCK=] [SCENE=] [ALL=1] [RECORD=1]"
	@echo "                                          how many random faults of a block its bench finds; ALL=1 those recorded too"
	@echo "make coverage [BLOCK=] [RECORD=1]         what each bench meets of the borders and states of its block"
	@echo "make report  [SCENE=] [FULL=1]            errors, what noise does, what was verified, pictures: one HTML file"
	@echo "                                          FULL=1: the errors and costs of every approximation too"
	@echo "make docs    [LINKS=1]                    the documentation as a site; LINKS=1 follows links to others"
	@echo "make pages                                what is generated in the documentation"
	@echo "make lint                                 ruff and mypy"
	@echo "make clean                                remove build and .venv"
	@echo
	@echo "SCENE is a name ($(basename $(notdir $(filter-out %.provenance.toml,$(wildcard golden/scenes/*/*.toml)))))"
	@printf 'or a path to a .toml file; now %s\n' "$$SCENE"

demo: $(READY) tools
	@$(RUN) -m tb.demo "$$SCENE" $(if $(filter-out 0,$(FULL)),--full)

test: $(READY) tools browser
	@$(RUN) $(if $(MACHINE),tests/machines.py "$$MACHINE" --show --whole,tests/chosen.py) \
		--tests="$$TESTS" $(if $(filter-out 0,$(ALL)),--all)

machines: $(READY) tools browser
	@$(RUN) tests/machines.py "$$ONLY" --tests="$$TESTS" $(if $(filter-out 0,$(WHOLE)),--whole) $(if $(filter-out 0,$(ALL)),--all)

sim: $(READY)
	@$(RUN) -m tb.sim "$$SCENE" --seed="$$SEED" \
		$(if $(BLOCK),--block="$$BLOCK") $(if $(FRAMES),--frames="$$FRAMES") $(if $(SIM),--sim="$$SIM") \
		$(if $(NETLIST),--netlist="$$NETLIST") $(if $(filter-out 0,$(WAVES)),--waves) \
		$(if $(filter-out 0,$(RECORD)),--record)

vhdl verilog: $(READY)
	@$(RUN) -m hdl.export "$$SCENE" $@

scene: $(READY)
	@$(RUN) -m golden.rig.write_scene "$$CSV" "$$OUTPUTS" $(if $(TO),--to="$$TO") $(if $(HARDWARE),--hardware="$$HARDWARE")

check: $(READY)
	@$(RUN) -m tb.check "$$SCENE"

train: $(READY)
	@$(RUN) -m golden.training "$$SCENE" $(if $(CLUSTER),--cluster="$$CLUSTER")

recalibrate: $(READY)
	@$(RUN) -m golden.recalibration "$$SCENE" "$$CSV" "$$TO"

predict: $(READY)
	@$(RUN) -m golden.rig.predict "$$SCENE" "$$CSV" "$$TO"

network: $(READY)
	@$(RUN) -m golden.network_files.convert "$$SCENE" "$$TO" $(if $(OUTPUT),--output="$$OUTPUT")

image: $(READY)
	@$(RUN) -m golden.scene.write_image "$$SCENE" $(if $(HARDWARE),--hardware="$$HARDWARE")

monitor: $(READY)
	@$(RUN) -m tb.monitor $(ON_BOARD) "$$PORT" $(if $(HARDWARE),--hardware="$$HARDWARE") $(if $(TO),--to="$$TO") $(if $(BAUD),--baud="$$BAUD")

record: $(READY)
	@$(RUN) -m tb.monitor.record $(ON_BOARD) "$$PORT" "$$TO" \
		$(if $(LABELS),--labels="$$LABELS") $(if $(FRAMES),--frames="$$FRAMES") $(if $(BAUD),--baud="$$BAUD")

load: $(READY)
	@$(RUN) -m tb.monitor.load $(ON_BOARD) "$$PORT" $(if $(HARDWARE),--hardware="$$HARDWARE") $(if $(BAUD),--baud="$$BAUD")

bench: $(READY)
	@$(RUN) -m tb.report.measure.benchmark "$$SCENE" $(if $(FRAMES),--frames="$$FRAMES")

listing: $(READY)
	@$(RUN) -m golden.engine "$$SCENE"

activations: $(READY)
	@$(RUN) -m tb.report.measure.activation_errors

figures: $(READY)
	@$(RUN) -m tb.report.measure $(if $(TABLE),"$$TABLE") --seed="$$SEED" $(if $(filter-out 0,$(RECORD)),--record)

sensors: $(READY)
	@$(RUN) -m tb.report.measure.gauges "$$RIG"

lean: $(READY)
	@$(RUN) -m hdl.synth.lean "$$SCENE" --beside="$$BESIDE" $(if $(filter-out 0,$(RECORD)),--record)

synth: $(READY)
	@$(RUN) -m hdl.synth "$$SCENE" $(if $(filter-out 0,$(RECORD)),--record)

bitstream: $(READY)
	@$(RUN) -m hdl.boards "$$SCENE" "$$BOARD" $(if $(DEVICE),--device="$$DEVICE") $(if $(filter-out 0,$(RECORD)),--record)

peers: $(READY) tools
	@$(RUN) -m tb.peers --seed="$$SEED"

prove: $(READY)
	@$(RUN) -m tb.sign_off.prove $(if $(BLOCK),--block="$$BLOCK") $(if $(filter-out 0,$(RECORD)),--record)

mutate: $(READY) tools
	@$(RUN) -m tb.sign_off.mutate $(if $(BLOCK),--block="$$BLOCK") $(if $(SCENE_CHOSEN),--scene="$$SCENE") $(if $(filter-out 0,$(ALL)),--all) \
		$(if $(filter-out 0,$(RECORD)),--record)

coverage: $(READY)
	@$(RUN) -m tb.sign_off.coverage $(if $(BLOCK),--block="$$BLOCK") $(if $(filter-out 0,$(RECORD)),--record)

report: $(READY) tools
	@$(RUN) -m tb.report "$$SCENE" $(if $(filter-out 0,$(FULL)),--full)

# Built anew, so that no page is left that is gone from the source, and renamed when it is whole.
SPHINX = $(RUN) -m sphinx -q -W --keep-going -d "$$SITE.doctrees" docs

docs: $(READY)
	@rm -rf -- "$$SITE.new" "$$SITE.doctrees"
	@$(SPHINX) "$$SITE.new"
	@$(if $(filter-out 0,$(LINKS)),$(SPHINX) -b linkcheck "$$SITE.links")
	@rm -rf -- "$$SITE" "$$SITE.doctrees" "$$SITE.links" && mv -- "$$SITE.new" "$$SITE"
	@printf 'wrote %s/index.html\n' "$$SITE"

# What stands between markers in the pages: ports and clocks that the twins publish, recorded cells.
pages: $(READY)
	@$(RUN) -m tb.report.page.blocks && $(RUN) -m tb.report.page.datasheets && $(RUN) -m tb.report.page.boards && $(RUN) -m tb.report.page.lists && $(RUN) -m tb.report.page.sign_off

lint: $(READY)
	@$(RUN) -m ruff check . && $(RUN) -m ruff format --check . && $(RUN) -m mypy

clean:
	rm -rf build "$$VENV"

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
ready:
	@if [ -e "$$VENV/.ready" ] && ! [ pyproject.toml -nt "$$VENV/.ready" ]; then exit 0; fi; \
	set -e; \
	missing=; \
	command -v "$$PYTHON" >/dev/null || missing="$$missing python3"; \
	"$$PYTHON" -c "import ensurepip" 2>/dev/null || missing="$$missing python3-venv"; \
	test "$$(uname -m)" = x86_64 || command -v g++ >/dev/null || missing="$$missing g++ python3-dev"; \
	{ $(call install,$$missing); } || exit 2; \
	"$$PYTHON" -c "import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))" || \
		{ echo "error: $$PYTHON is $$("$$PYTHON" -V), expected Python 3.11 to 3.13; set PYTHON=" >&2; exit 2; }; \
	printf 'setting up %s\n' "$$VENV"; \
	"$$PYTHON" -m venv -- "$$VENV"; \
	$(RUN) -m pip install --quiet --disable-pip-version-check -e ".[dev]"; \
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
	$$as apt-get update -qq && \
	$$as env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $(1) >/dev/null; \
fi
endef
