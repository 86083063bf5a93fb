# Each target first sets up the environment that it needs.

# The Python that makes the environment: 3.11 if it is installed.
PYTHON ?= $(shell python3.11 -c "" 2>/dev/null && echo python3.11 || echo python3)

VENV := .venv
READY := $(VENV)/ready
PYTEST := $(VENV)/bin/python -m pytest -n 3 --maxschedchunk 1
RUN := runs/walk
RESULTS := runs/results
# The studies of `groundwalk transfer` that have a page in docs/results.
STUDIES := toy cliff inverted-pendulum half-cheetah nao-falls
# Sets of cases with concealed physics that have a page in docs/results, and how they are drawn.
# Their seeds are the beginnings of the hashes of the commits at which the diagnosis was frozen
# (64b0843 and b835a28), so that nobody chose them; a changed diagnosis takes another one.
SETS := concealed concealed-2 concealed-real concealed-identical
SEED_2 := 3090522760
DRAWN_concealed := --cases 200 --seed 6598788
DRAWN_concealed-2 := --set 2 --cases 400 --seed $(SEED_2)
DRAWN_concealed-real := --real $(DATA) --cases 180 --seed $(SEED_2)
DRAWN_concealed-identical := --set 4 --cases 60 --seed $(SEED_2)
BASELINES_concealed := sparse bic ebic sysid
BASELINES_concealed-2 := $(BASELINES_concealed)
# Hidden physics of the real NAO in results-diagnosed-gait, which its model lacks.
SLOW_KNEES := speed_limit@LKneePitch:speed=2.5 speed_limit@RKneePitch:speed=2.5
# Folder of recordings of real robots, which are not part of the repository: docs/diagnosis.md
# names their sources. To use another folder: make results-diagnosis DATA=FOLDER.
DATA := data
REAL := so101 emps go2

.PHONY: help env walk test slow-tests journeys lint results results-walk results-pictures results-nao \
	$(STUDIES:%=results-%) \
	results-terrain-stress results-humanoids results-diagnosed-gait \
	results-diagnosis $(REAL:%=results-diagnosis-%) $(SETS:%=results-%) bench

help:
	@echo "make walk     tune a gait in simulation and try it in both worlds (into runs/)"
	@echo "make test     run the tests that take seconds (below eight minutes on two cores)"
	@echo "make slow-tests  run the others: whole diagnoses, searches and studies"
	@echo "make journeys run what the pages tell people to type (a quarter of an hour on two cores)"
	@echo "make lint     check style, types and imports"
	@echo "make results  write docs/results again (many hours; one page: make results-NAME)"
	@echo "make bench    measure speed"
	@echo "make env      only set up the environment (in $(VENV))"

env: $(READY)

walk: $(READY)
	$(VENV)/bin/groundwalk optimize-gait --out \
		$(if $(wildcard $(RUN)),$(RUN)-$(shell date +%Y-%m-%d-%H%M%S),$(RUN))

test: $(READY)
	$(PYTEST) --ignore tests/journeys -m "not slow"

# Whole diagnoses, searches and studies: what takes more than a few seconds.
slow-tests: $(READY)
	$(PYTEST) --ignore tests/journeys -m slow

# What the pages tell people to type, each page from its top in one folder.
journeys: $(READY)
	$(PYTEST) tests/journeys

lint: $(READY)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports --no-logo

# `results` writes every number and picture of docs/results from new runs; each `results-NAME`
# writes one part of them.
results: results-walk results-pictures results-nao $(STUDIES:%=results-%) results-terrain-stress \
	results-humanoids results-diagnosed-gait results-diagnosis \
	$(filter-out $(if $(wildcard $(DATA)),,%-real),$(SETS:%=results-%))

results-walk: $(READY)
	rm -rf $(RESULTS)/walk
	$(VENV)/bin/groundwalk optimize-gait --seed 1 --out $(RESULTS)/walk
	mkdir -p docs/results/walk
	cp $(addprefix $(RESULTS)/walk/,result.md result.json walk.png search.png) docs/results/walk

# The pictures of the README: one walk with the gait of docs/results/walk.
results-pictures: $(READY)
	rm -rf $(RESULTS)/pictures $(RESULTS)/gait
	mkdir -p $(RESULTS)/gait docs/results/pictures
	cp docs/results/walk/result.json $(RESULTS)/gait/tuned.json
	$(VENV)/bin/groundwalk evaluate $(RESULTS)/gait/tuned.json --trials 1 --seed 1 \
		--out $(RESULTS)/pictures
	$(VENV)/bin/groundwalk render $(RESULTS)/pictures --width 310 --height 310 \
		--out $(RESULTS)/pictures/walk.gif
	$(VENV)/bin/groundwalk render $(RESULTS)/pictures --only real --balance \
		--duration 2 --frames 4 --width 300 --height 300 --out $(RESULTS)/pictures/fall.png
	cp $(addprefix $(RESULTS)/pictures/,walk.gif fall.png) docs/results/pictures

$(STUDIES:%=results-%): results-%: $(READY)
	rm -rf $(RESULTS)/$*
	$(VENV)/bin/groundwalk transfer $* --seed 1 --out $(RESULTS)/$*
	mkdir -p docs/results
	cp $(RESULTS)/$*/result.md docs/results/transfer_$(subst -,_,$*).md
	cp $(RESULTS)/$*/result.json docs/results/transfer_$(subst -,_,$*).json
	find $(RESULTS)/$* -maxdepth 1 -name 'transfer_*.png' -exec cp {} docs/results ';'

# It takes two hours; if it was interrupted, the next call continues it.
results-nao: $(READY)
	$(VENV)/bin/groundwalk transfer nao --seed 1 \
		$(if $(wildcard $(RESULTS)/nao/config.json),--resume,--out) $(RESULTS)/nao
	mkdir -p docs/results
	cp $(RESULTS)/nao/result.md docs/results/nao.md
	cp $(RESULTS)/nao/result.json docs/results/nao.json
	cp $(RESULTS)/nao/transfer_nao.png docs/results

# It takes half an hour: recordings of a NAO with slow knees, their diagnosis, and gaits tuned
# in the diagnosed sim. The study's real world always has a latency, so that the recordings have
# it, too; its ground is flat, so that only the physics differs.
results-diagnosed-gait: $(READY)
	rm -rf $(RESULTS)/slow-knees $(RESULTS)/diagnosed-gait
	mkdir -p $(RESULTS)/slow-knees docs/results
	for motion in multisine chirp steps; do \
		$(VENV)/bin/groundwalk record --motion $$motion --duration 20 \
			--hidden command_latency:delay=0.036 $(SLOW_KNEES) \
			--out $(RESULTS)/slow-knees/$$motion.parquet || exit 1; \
	done
	$(VENV)/bin/groundwalk diagnose $(RESULTS)/slow-knees/*.parquet --robot nao \
		--out $(RESULTS)/slow-knees/found
	$(VENV)/bin/groundwalk transfer nao --terrain flat --hidden $(SLOW_KNEES) \
		--sim $(RESULTS)/slow-knees/found --seed 1 --out $(RESULTS)/diagnosed-gait
	sed s/transfer_nao.png/diagnosed_gait.png/ $(RESULTS)/diagnosed-gait/result.md \
		> docs/results/diagnosed_gait.md
	cp $(RESULTS)/diagnosed-gait/result.json docs/results/diagnosed_gait.json
	cp $(RESULTS)/diagnosed-gait/transfer_nao.png docs/results/diagnosed_gait.png

# If it was interrupted, the next call continues it.
results-terrain-stress: $(READY)
	$(VENV)/bin/groundwalk terrain-stress start docs/results/walk/result.json --seed 1 \
		$(if $(wildcard $(RESULTS)/terrain-stress/config.json),--resume,--out) \
		$(RESULTS)/terrain-stress
	mkdir -p docs/results
	cp $(RESULTS)/terrain-stress/result.md docs/results/terrain_stress.md
	cp $(RESULTS)/terrain-stress/result.json docs/results/terrain_stress.json
	cp $(RESULTS)/terrain-stress/terrain_stress*.png docs/results

# If it was interrupted, the next call continues it.
results-humanoids: $(READY)
	$(VENV)/bin/groundwalk humanoids --seed 1 \
		$(if $(wildcard $(RESULTS)/humanoids/config.json),--resume,--out) \
		$(RESULTS)/humanoids
	mkdir -p docs/results
	cp $(RESULTS)/humanoids/result.md docs/results/humanoids.md
	cp $(RESULTS)/humanoids/result.json docs/results/humanoids.json
	cp $(RESULTS)/humanoids/humanoids.png docs/results

results-diagnosis: $(REAL:%=results-diagnosis-%)

$(REAL:%=results-diagnosis-%): results-diagnosis-%: $(READY)
ifneq ($(wildcard $(DATA)),)
	rm -rf $(RESULTS)/diagnosis/$*
	$(VENV)/bin/groundwalk real-robots $* --data $(DATA) --out $(RESULTS)/diagnosis/$*
	mkdir -p docs/results
	cp $(RESULTS)/diagnosis/$*/result.md docs/results/diagnosis_$*.md
	cp $(RESULTS)/diagnosis/$*/diagnosis.json docs/results/diagnosis_$*.json
else
	@echo "skipped: there are no recordings of real robots in $(DATA)"
endif

# Set 1 takes more than two hours, set 2 a day; if it was interrupted, the next call continues it.
# A set of cases with a seed of your own tells more than these.
$(SETS:%=results-%): results-%: $(READY)
	$(VENV)/bin/groundwalk concealed make $(RESULTS)/$* $(DRAWN_$*)
	$(VENV)/bin/groundwalk concealed run $(RESULTS)/$*
	for baseline in $(BASELINES_$*); do \
		$(VENV)/bin/groundwalk concealed run $(RESULTS)/$* --by $$baseline || exit 1; \
	done
	$(VENV)/bin/groundwalk concealed score $(RESULTS)/$*
	mkdir -p docs/results
	sed s/score.png/$(subst -,_,$*).png/ $(RESULTS)/$*/score.md > docs/results/$(subst -,_,$*).md
	cp $(RESULTS)/$*/score.json docs/results/$(subst -,_,$*).json
	cp $(RESULTS)/$*/score.png docs/results/$(subst -,_,$*).png

bench: $(READY)
	$(VENV)/bin/python -m benchmarks

# $(READY) is an empty file; its date shows whether pyproject.toml or constraints.txt changed
# since the last installation. Without ensurepip (Debian packs it apart), pip installs pip.
$(READY): pyproject.toml constraints.txt
	@sh .ci/check-python $(PYTHON)
	@if $(PYTHON) -c "import ensurepip" 2>/dev/null; then \
		$(PYTHON) -m venv $(VENV); \
	else \
		$(PYTHON) -m venv --without-pip $(VENV) && \
		$(PYTHON) -m pip --python $(VENV)/bin/python install pip; \
	fi
	$(VENV)/bin/python -m pip install -c constraints.txt -e ".[dev]"
	@touch $@
